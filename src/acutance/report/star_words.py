"""A star in words and tables: where it is, what it holds, the mean over its directions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.html import Section, Table
from acutance.report.plane_text import plane_csv
from acutance.report.tables import STEP_CPP
from acutance.report.text import align_columns
from acutance.report.wording import word_estimate

if TYPE_CHECKING:
    from acutance.targets.periodic import StarMeasurement

__all__ = ["star_blocks", "star_csv", "star_sections"]


def star_blocks(measurement: StarMeasurement) -> tuple[str, ...]:
    """The paragraphs a star adds to the text."""
    return (align_columns(_rows(measurement), "ll"),)


def star_sections(measurement: StarMeasurement) -> tuple[Section, ...]:
    """The sections a star adds to the report: the star, and its rings."""
    rings = measurement.rings
    rows = tuple(
        (f"{measurement.star.radius_at(f):.1f}", f"{f:.3f}", f"{m:.4f}", f"{s:.4f}")
        for f, m, s in zip(
            rings.freq_cpp.tolist(), rings.modulation.tolist(), rings.std.tolist(), strict=True
        )
    )
    columns = ("Radius [px]", "c/px", "Modulation", "± noise")
    return (
        Section("The star", tables=(Table(("", ""), tuple(_rows(measurement)), "ll"),)),
        Section(
            "Rings",
            paragraphs=(
                "The plain reading: a sinusoid fitted to every ring, over the spokes' amplitude "
                "before the sensor. It is no measure near the centre, where spokes change within "
                "the blur.",
            ),
            tables=(Table(columns, rows, "rrrr", parts=2),),
        ),
    )


def star_csv(measurement: StarMeasurement) -> str:
    """The MTF as CSV: `plane_csv`, then the mean over the directions as direction "mean"."""
    lines = [plane_csv(measurement).rstrip("\n")]
    empty = "," if lines[0].split("\n", 1)[0].endswith("freq_cpm") else ""
    for freq in np.linspace(0.0, 1.0, round(1.0 / STEP_CPP) + 1).tolist():
        here = measurement.mtf(freq)
        numbers = (here.value, here.std, *here.interval(0.95))
        lines.append(f"mean,{freq:.2f}," + ",".join(f"{number:.6f}" for number in numbers) + empty)
    return "\n".join(lines) + "\n"


def _rows(measurement: StarMeasurement) -> list[tuple[str, str]]:
    star = measurement.star
    row, col = (word_estimate(one).value_and_std for one in measurement.centre)
    low, high = measurement.reach_cpp
    sweep = "a full turn"
    if star.sweep_deg < 360:
        first = (star.first_deg + 180) % 360 - 180
        sweep = f"{star.sweep_deg:.0f}° from {first:.0f}°"
    return [
        ("mean MTF at Nyquist", word_estimate(measurement.mtf_nyquist).value_and_std),
        ("mean MTF50", f"{word_estimate(measurement.mtf50_cpp).value_and_std} c/px"),
        ("centre", f"row {row}, column {col}"),
        ("spokes", f"{star.cycles} cycles, {sweep}, up to {star.rim_px:.1f} px"),
        ("amplitude before the sensor", word_estimate(measurement.level).value_and_std),
        ("frequencies of the spokes used", f"{low:.3f} to {high:.2f} c/px"),
        ("aliased within", f"{measurement.nyquist_px:.1f} px of the centre"),
    ]
