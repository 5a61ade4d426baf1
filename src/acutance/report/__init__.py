"""Faces of a measurement on paper: text, figures, HTML, CSV and JSON."""

from acutance.report.comparison_page import comparison_figure
from acutance.report.documents import json_text, measurement_document, measurement_schema
from acutance.report.edge_page import edge_figure, panel_figures
from acutance.report.page import save_figure
from acutance.report.reports import comparison_report, edge_report, target_report
from acutance.report.tables import mtf_csv
from acutance.report.target_page import target_figure
from acutance.report.text import text_report

__all__ = [
    "comparison_figure",
    "comparison_report",
    "edge_figure",
    "edge_report",
    "json_text",
    "measurement_document",
    "measurement_schema",
    "mtf_csv",
    "panel_figures",
    "save_figure",
    "target_figure",
    "target_report",
    "text_report",
]
