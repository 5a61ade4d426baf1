"""A pair of images in tables: geometry, radiometry and noise, and the iterations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.geometry.line import axis_names
from acutance.report.html import Table
from acutance.report.labels import (
    format_number,
    transfer_name,
    word_estimate,
    write_fixed,
)

if TYPE_CHECKING:
    from acutance.targets.pair import BiresolutionMeasurement

__all__ = ["biresolution_tables"]

SOURCES = {
    "geotransform": "by the geotransforms",
    "shapes": "by the shapes of the images",
    "given": "as given",
}


def biresolution_tables(measurement: BiresolutionMeasurement) -> tuple[Table, ...]:
    """The pair, and the iterations of the parametric fit."""
    return _pair_table(measurement), _iterations_table(measurement)


def _describe_quantity(measurement: BiresolutionMeasurement) -> str:
    if measurement.reference_known:
        return "The curves are the low sensor's own: the high image's MTF was divided out."
    return (
        "The curves are MTF_low / MTF_high: the high image's own MTF was not given, and the low "
        "sensor's is lower by that."
    )


def _iterations_table(measurement: BiresolutionMeasurement) -> Table:
    rows = tuple(
        (
            str(i), format_number(step.residual), f"{step.change:.1e}" if i else "",
            *(write_fixed(value) for value in (*step.shift_px, *step.variance_px2)),
        )
        for i, step in enumerate(measurement.steps)
    )  # fmt: skip
    note = (
        "Blur the high image, sample it, compare, change the kernel, until the relative change of "
        f"the residual falls below the threshold {measurement.options['stop_change']:g} (Li et "
        "al., 5.3). The free kernel starts from the last one."
    )
    x, y = axis_names(measurement.image.along_track)
    columns = (
        "step", "residual [DN]", "relative change", f"shift {y} [px]", f"shift {x} [px]",
        f"variance {y} [px²]", f"variance {x} [px²]",
    )  # fmt: skip
    return Table(
        columns, rows, "rrrrrrr", title="Iterations of the parametric fit", notes=(note,),
        page_only=True,
    )  # fmt: skip


def _correlation_words(measurement: BiresolutionMeasurement) -> str:
    """How residuals of neighbours correlate, as the check of it found."""
    found = [one.value for one in measurement.checks if one.name == "residual_correlation"]
    return "".join(f", correlation of neighbours {value:.2f}" for value in found)


def _pair_table(measurement: BiresolutionMeasurement) -> Table:
    high, grid = measurement.high, measurement.grid
    rows, cols = measurement.ratio
    same = format_number(rows) == format_number(cols)
    ratio = format_number(rows) if same else f"{format_number(rows)} by {format_number(cols)}"
    down, right = (word_estimate(one).value_and_std for one in measurement.shift_px)
    share = f", {100 * measurement.share_read:.0f} % of the scene" * (measurement.share_read < 1)
    local = measurement.local
    mtf = [measurement.local_mtf_nyquist(axis)[0] for axis in ("across", "along")]
    scatter = [float(np.nanstd(one)) if np.isfinite(one).any() else float("nan") for one in mtf]
    found = (
        ("high image", f"{high.path or 'array in memory'}, band {high.band_label}"),
        ("ratio of the GSDs", f"{ratio}, {SOURCES[grid.source]}"),
        ("shift of the low content", f"{down} px down, {right} px to the right"),
        ("gain, offset", f"{measurement.gain:.5g}, {measurement.offset:.5g} DN"),
        ("low pixels used", f"{measurement.used} (left out {measurement.left_out}){share}"),
        (
            "residual",
            f"{format_number(measurement.residual_std)} DN{_correlation_words(measurement)}",
        ),
        ("noise of the high image", f"{format_number(measurement.high_noise)} DN"),
        (
            "regions of the map",
            f"{local.pixels.size}; {transfer_name(measurement)} at Nyquist scatters by "
            f"{scatter[0]:.3f} across, {scatter[1]:.3f} along, "
            f"shifts by {local.shift_scatter_px:.3f} px",
        ),
    )
    return Table(("", ""), found, "ll", title="The pair", notes=(_describe_quantity(measurement),))
