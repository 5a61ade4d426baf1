"""Bars in tables: the numbers along their normal, and every group with its plain readings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from acutance.curves import Estimate
from acutance.curves.metric_words import metric_words
from acutance.report.html import Table
from acutance.report.labels import word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.targets.periodic import BarsMeasurement

__all__ = ["bars_tables"]

ALONG_NORMAL = ("mtf_nyquist", "rer", "fwhm_px", "fwhm_m", "mtf50_cpp")
COLUMNS = ("Group", "c/px", "period [px]", "bars", "MTF", "sinusoid", "CTF", "Coltman")


def bars_tables(measurement: BarsMeasurement) -> tuple[Table, ...]:
    """Along the normal, and group by group."""
    return _normal_table(measurement), _groups_table(measurement)


def _normal_table(measurement: BarsMeasurement) -> Table:
    rows = [("direction of the normal", f"{write_fixed(measurement.directions_deg[0], 2)}°")]
    for name, number in measurement.normal_response.metrics().items():
        if name in ALONG_NORMAL:
            words = metric_words(name)
            value = f"{word_estimate(number).value_and_std} {words.unit}".rstrip()
            rows.append((words.label, value))
    contrast = word_estimate(measurement.contrast).value_and_std
    rows.append(("contrast before the sensor", f"{contrast} DN"))
    return Table(("", ""), tuple(rows), "ll", title="Along the bars' normal")


def _groups_table(measurement: BarsMeasurement) -> Table:
    rows = tuple(
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
            word_estimate(Estimate(group.coltman, math.nan)).value,
        )
        for number, group in enumerate(measurement.groups, start=1)
    )
    note = (
        "MTF: the joint fit of all groups. Sinusoid: the fundamental of every group over that of "
        "square bars. CTF: the contrast of the bars themselves. Coltman: MTF from the CTF of all "
        "groups by Coltman's series, with a CTF that falls along the last two groups' line beyond "
        "them. Neither is defined for a group along the grid of which pixels hide a harmonic. "
        "Deviations of sinusoid and CTF are those of the noise alone: as groups have ends, "
        "one or two percent of either are no MTF."
    )
    return Table(COLUMNS, rows, "rrrrrrrr", title="Groups", notes=(note,))
