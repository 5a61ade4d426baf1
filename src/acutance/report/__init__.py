"""Faces of a measurement on paper: text, figures, HTML, CSV and JSON."""

from acutance.report.bars_panels import bars_panels
from acutance.report.bars_words import bars_blocks, bars_csv, bars_sections
from acutance.report.biresolution_panels import biresolution_panels
from acutance.report.biresolution_words import biresolution_blocks, biresolution_sections
from acutance.report.budget import (
    budget_document,
    budget_figure,
    budget_text,
    sensor_document,
)
from acutance.report.combine_panels import combine_panels
from acutance.report.combine_words import combine_blocks, combine_sections
from acutance.report.comparison_page import comparison_figure
from acutance.report.documents import (
    comparison_document,
    json_text,
    measurement_document,
    measurement_schema,
    target_document,
    truth_document,
)
from acutance.report.edge_page import edge_figure, panel_figures
from acutance.report.mirrors_page import mirror_plan_figure, mirror_plan_text
from acutance.report.page import save_figure
from acutance.report.plane_page import plane_figure, plane_panels
from acutance.report.plane_panels import PlanePanel
from acutance.report.plane_report import plane_report, plane_sections
from acutance.report.plane_text import plane_csv, plane_document, plane_text
from acutance.report.points_panels import points_panels
from acutance.report.points_tables import points_blocks, points_sections, sources_csv
from acutance.report.reports import comparison_report, edge_report, target_report
from acutance.report.scene_truth import scene_document, target_truth_document
from acutance.report.star_panels import star_panels
from acutance.report.star_words import star_blocks, star_csv, star_sections
from acutance.report.study_figures import plan_text, study_figure, study_text
from acutance.report.tables import mtf_csv, mtf_csv_of_many
from acutance.report.target_page import target_figure
from acutance.report.text import comparison_text, target_text, text_report

__all__ = [
    "PlanePanel",
    "bars_blocks",
    "bars_csv",
    "bars_panels",
    "bars_sections",
    "biresolution_blocks",
    "biresolution_panels",
    "biresolution_sections",
    "budget_document",
    "budget_figure",
    "budget_text",
    "combine_blocks",
    "combine_panels",
    "combine_sections",
    "comparison_document",
    "comparison_figure",
    "comparison_report",
    "comparison_text",
    "edge_figure",
    "edge_report",
    "json_text",
    "measurement_document",
    "measurement_schema",
    "mirror_plan_figure",
    "mirror_plan_text",
    "mtf_csv",
    "mtf_csv_of_many",
    "panel_figures",
    "plan_text",
    "plane_csv",
    "plane_document",
    "plane_figure",
    "plane_panels",
    "plane_report",
    "plane_sections",
    "plane_text",
    "points_blocks",
    "points_panels",
    "points_sections",
    "save_figure",
    "scene_document",
    "sensor_document",
    "sources_csv",
    "star_blocks",
    "star_csv",
    "star_panels",
    "star_sections",
    "study_figure",
    "study_text",
    "target_document",
    "target_figure",
    "target_report",
    "target_text",
    "target_truth_document",
    "text_report",
    "truth_document",
]
