"""Figures and texts of studies by their names."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from acutance.arguments import require_class
from acutance.report.studies.angle import angle_figure
from acutance.report.studies.plan import plan_figure
from acutance.report.studies.snr import ground_noise_figure, snr_figure
from acutance.report.studies.width import width_figure
from acutance.report.studies.width_correction import width_correction_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from acutance.studies import StudyResult

__all__ = ["STUDY_FIGURES", "plan_text", "study_figure", "study_text"]

STUDY_FIGURES: dict[str, Callable[[StudyResult], Figure]] = {
    "snr": snr_figure,
    "ground-noise": ground_noise_figure,
    "angle": angle_figure,
    "width": width_figure,
    "width-correction": width_correction_figure,
    "plan": plan_figure,
}


def study_figure(result: StudyResult) -> Figure:
    """The figure of a study, laid out as the paper's.

    Parameters
    ----------
    result : StudyResult
    """
    require_class("StudyResult", result=result)
    return STUDY_FIGURES[result.name](result)


def study_text(result: StudyResult) -> str:
    """The answers of a study, one a line, with what the paper printed.

    Parameters
    ----------
    result : StudyResult
    """
    require_class("StudyResult", result=result)
    lines = [result.title]
    for found in result.findings:
        printed = "" if found.published is None else f" (paper: {found.published:g})"
        lines.append(f"  {found.text}{printed}")
    return "\n".join(lines)


def plan_text(result: StudyResult) -> str:
    """The answers of a plan, and its designs as a table.

    Parameters
    ----------
    result : StudyResult
    """
    require_class("StudyResult", result=result)
    is_pulse, table = result.options.target == "pulse", result.table
    head = {
        "varied": "varied", "rows": "rows", "length_m": "length m", "angle_deg": "angle",
        "target_width_px": "width px", "target_width_m": "width m",
        "mtf_nyquist_free": "free LSF", "mtf_nyquist_bound": "shape",
        "mtf_nyquist_rms": "MTF", "rer_rms": "RER", "fwhm_px_rms": "FWHM px",
        "width_px_rms": "found px",
    }  # fmt: skip
    if not is_pulse:
        head = {name: words for name, words in head.items() if "width" not in name}
    simulated = result.options.draws > 1
    if not simulated:
        head = {name: words for name, words in head.items() if not name.endswith("_rms")}
    elif table["refused"].any():
        head["refused"] = "refused"
    rows = [list(head.values())]
    for row in table.rows():
        rows.append([_cell(name, row[name]) for name in head])
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = [
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    caption = [
        "free LSF, shape: bounds of the std of the MTF at Nyquist with a free LSF and with a blur "
        f"of known shape, both with a fitted line{' and width' if is_pulse else ''}."
    ]
    if simulated:
        refusals = ", without those refused" if "refused" in head else ""
        caption.append(
            f"MTF, RER, FWHM{', found' if is_pulse else ''}: rms error of our estimator in "
            f"{result.options.draws} simulated images{refusals}."
        )
    return "\n".join([study_text(result), _sensor_line(result), "", *lines, "", *caption])


def _sensor_line(result: StudyResult) -> str:
    """The sensor that is planned for: deviations depend on its sharpness."""
    options = result.options
    own = options.sensor.response(options.angles_deg[0]).mtf_nyquist.value
    named = f" {options.sensor_name}" if options.sensor_name else ""
    gsd = "" if options.sensor.gsd_m is None else f", GSD {options.sensor.gsd_m:.4g} m"
    return f"  sensor{named}: MTF at Nyquist {own:.3f}{gsd}"


def _cell(name: str, value: float | int | str) -> str:
    if isinstance(value, str):
        return value
    if value != value:
        return "-"
    if name.endswith(("_rms", "_bound", "_free")):
        return f"{value:.4f}"
    return f"{value:g}" if name in ("rows", "refused") else f"{value:.2f}"
