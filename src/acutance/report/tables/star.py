"""A star in tables: where it is, what it holds, the mean over its directions, its rings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.html import Table
from acutance.report.labels import word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.targets.periodic import StarMeasurement

__all__ = ["star_tables"]


def star_tables(measurement: StarMeasurement) -> tuple[Table, ...]:
    """The star and its rings."""
    return _star_table(measurement), _rings_table(measurement)


def _star_table(measurement: StarMeasurement) -> Table:
    star = measurement.star
    row, col = (word_estimate(one).value_and_std for one in measurement.centre)
    low, high = measurement.reach_cpp
    sweep = "a full turn"
    if star.sweep_deg < 360:
        first = (star.first_deg + 180) % 360 - 180
        sweep = f"{star.sweep_deg:.0f}° from {first:.0f}°"
    mtf50 = word_estimate(measurement.mean_mtf50_cpp).value_and_std
    rows = (
        ("MTF at Nyquist, mean over directions",
         word_estimate(measurement.mean_mtf_nyquist).value_and_std),
        ("MTF50, mean over directions", f"{mtf50} c/px"),
        ("centre", f"row {row}, column {col}"),
        ("spokes", f"{star.cycles} cycles, {sweep}, up to {star.rim_px:.1f} px"),
        ("amplitude before the sensor",
         f"{word_estimate(measurement.level).value_and_std} DN"),
        ("frequencies of the spokes used", f"{low:.3f} to {high:.2f} c/px"),
        ("aliased within", f"{measurement.nyquist_px:.1f} px of the centre"),
    )  # fmt: skip
    return Table(("", ""), rows, "ll", title="The star")


def _rings_table(measurement: StarMeasurement) -> Table:
    rings = measurement.rings
    rows = tuple(
        (f"{measurement.star.radius_at(f):.1f}", f"{f:.3f}", write_fixed(m), write_fixed(s))
        for f, m, s in zip(
            rings.freq_cpp.tolist(), rings.modulation.tolist(), rings.std.tolist(), strict=True
        )
    )
    note = (
        "The plain reading: a sinusoid fitted to every ring, over the spokes' amplitude before "
        "the sensor. It is no measure near the centre, where spokes change within the blur."
    )
    columns = ("Radius [px]", "c/px", "Modulation", "± noise")
    return Table(columns, rows, "rrrr", parts=2, title="Rings", notes=(note,), page_only=True)
