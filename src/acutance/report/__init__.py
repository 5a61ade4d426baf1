"""Any result on paper: figures, tables, HTML pages, text, CSV and JSON.

Six functions take any result: a measurement of any kind, all edges of a target, or a list of
measurements of one target, which is compared (`compare` adds the truth):

- `draw` makes a figure (`figure.py`, drawings by kind in ``figures/``); of a measurement, `panels`
  and `panel_figure` make one of each drawing
- `tables` gives tables (``tables/``, by kind)
- `page` writes HTML (`page.py`, made of the sections of `html.py`), `notebook_html` a part of it
- `text` writes for a terminal, `csv` the MTF, `document` JSON (with its schema)

`labels.py` has what numbers, kinds and methods are called, `paper.py` colours, type and saving.
Bands of a scene, filters, studies, plans and budgets have outputs of their own (`bands.py`,
`restoration.py`, ``studies/``, `budget.py`).
"""

from acutance.report.bands import bands_document, bands_page, bands_tables, bands_text
from acutance.report.budget import (
    budget_document,
    budget_figure,
    budget_text,
    sensor_document,
)
from acutance.report.comparison import Comparison, compare
from acutance.report.csv import csv
from acutance.report.figure import draw, panel_figure, panels
from acutance.report.figures.panel import Panel
from acutance.report.figures.restoration import before_after_figure, restoration_figure
from acutance.report.html import Table
from acutance.report.json import document, json_text, measurement_schema
from acutance.report.notebook import notebook_html
from acutance.report.page import page, rejection_page
from acutance.report.paper import figure_bytes, save_figure
from acutance.report.restoration import (
    niirs_text,
    proof_text,
    restoration_page,
    restoration_text,
)
from acutance.report.studies.mirrors import mirror_plan_figure, mirror_plan_text
from acutance.report.studies.study import plan_text, study_figure, study_text
from acutance.report.tables.points import sources_csv
from acutance.report.tables.restoration import restoration_tables
from acutance.report.tables.result import tables
from acutance.report.text import reasons_text, text
from acutance.report.truth import (
    landscape_document,
    scene_document,
    target_truth_document,
    truth_document,
)

__all__ = [
    "Comparison",
    "Panel",
    "Table",
    "bands_document",
    "bands_page",
    "bands_tables",
    "bands_text",
    "before_after_figure",
    "budget_document",
    "budget_figure",
    "budget_text",
    "compare",
    "csv",
    "document",
    "draw",
    "figure_bytes",
    "json_text",
    "landscape_document",
    "measurement_schema",
    "mirror_plan_figure",
    "mirror_plan_text",
    "niirs_text",
    "notebook_html",
    "page",
    "panel_figure",
    "panels",
    "plan_text",
    "proof_text",
    "reasons_text",
    "rejection_page",
    "restoration_figure",
    "restoration_page",
    "restoration_tables",
    "restoration_text",
    "save_figure",
    "scene_document",
    "sensor_document",
    "sources_csv",
    "study_figure",
    "study_text",
    "tables",
    "target_truth_document",
    "text",
    "truth_document",
]
