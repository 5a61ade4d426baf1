"""Bars in words and tables: every group with its MTF and its plain readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.curves import Estimate
from acutance.report.html import Section, Table
from acutance.report.plane_text import plane_csv
from acutance.report.tables import STEP_CPP
from acutance.report.text import align_columns
from acutance.report.wording import metric_words, word_estimate

if TYPE_CHECKING:
    from acutance.targets.periodic import BarsMeasurement

__all__ = ["bars_blocks", "bars_csv", "bars_sections"]

COLUMNS = ("", "c/px", "period [px]", "bars", "MTF", "sinusoid", "CTF", "Coltman")
ALIGN = "rrrrrrrr"


def bars_blocks(measurement: BarsMeasurement) -> tuple[str, ...]:
    """The paragraphs bars add to the text: along the normal, and group by group."""
    return (
        align_columns(_normal_rows(measurement), "ll"),
        align_columns([COLUMNS, *_group_rows(measurement)], ALIGN),
    )


def bars_sections(measurement: BarsMeasurement) -> tuple[Section, ...]:
    """The sections bars add to the report."""
    return (
        Section(
            "Along the bars' normal",
            tables=(Table(("", ""), tuple(_normal_rows(measurement)), "ll"),),
        ),
        Section(
            "Groups",
            paragraphs=(
                "MTF: the joint fit of all groups. Sinusoid: the fundamental of every group over "
                "that of square bars. CTF: the contrast of the bars themselves. Coltman: MTF from "
                "the CTF of all groups by Coltman's series, with a CTF that falls along the last "
                "two groups' line beyond them.",
            ),
            tables=(Table(COLUMNS, tuple(_group_rows(measurement)), ALIGN),),
        ),
    )


def bars_csv(measurement: BarsMeasurement) -> str:
    """The MTF as CSV: `plane_csv`, then the curve along the normal as direction "normal"."""
    lines = [plane_csv(measurement).rstrip("\n")]
    metres = measurement.across.gsd_m is not None
    gsd_m = measurement.response.gsd_m
    for freq in np.linspace(0.0, 1.0, round(1.0 / STEP_CPP) + 1).tolist():
        here = measurement.mtf(freq)
        cells = [f"{number:.6f}" for number in (here.value, here.std, *here.interval(0.95))]
        if metres and gsd_m is not None:
            cells.append(f"{freq / gsd_m:.6f}")
        lines.append(",".join(["normal", f"{freq:.2f}", *cells]))
    return "\n".join(lines) + "\n"


def _normal_rows(measurement: BarsMeasurement) -> list[tuple[str, str]]:
    rows = [("direction of the normal", f"{measurement.directions_deg[0]:.2f}°")]
    for name, number in measurement.response.metrics().items():
        if name in ("mtf_nyquist", "rer", "fwhm_px", "fwhm_m", "mtf50_cpp"):
            words = metric_words(name)
            rows.append((words.label, f"{word_estimate(number).value_and_std} {words.unit}"))
    rows.append(("contrast before the sensor", word_estimate(measurement.contrast).value_and_std))
    return rows


def _group_rows(measurement: BarsMeasurement) -> list[tuple[str, ...]]:
    return [
        (
            str(number),
            f"{group.freq_cpp:.4f}",
            word_estimate(group.period_px).value_and_std,
            str(group.bars.count),
            word_estimate(group.mtf).value_and_std,
            word_estimate(
                Estimate(group.reading.modulation, group.reading.modulation_std)
            ).value_and_std,
            word_estimate(Estimate(group.reading.ctf, group.reading.ctf_std)).value_and_std,
            f"{group.coltman:.4f}",
        )
        for number, group in enumerate(measurement.groups, start=1)
    ]
