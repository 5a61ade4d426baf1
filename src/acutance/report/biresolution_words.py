"""A bi-resolution measurement in words and tables: the pair, the iterations, the regions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.html import Section, Table
from acutance.report.quantity import transfer_name
from acutance.report.text import align_columns
from acutance.report.wording import format_number, word_estimate

if TYPE_CHECKING:
    from acutance.targets.pair import BiresolutionMeasurement

__all__ = ["biresolution_blocks", "biresolution_sections"]


def biresolution_blocks(measurement: BiresolutionMeasurement) -> tuple[str, ...]:
    """The paragraphs a bi-resolution measurement adds to the text."""
    return (align_columns(_pair_rows(measurement), "ll"), describe_quantity(measurement))


def describe_quantity(measurement: BiresolutionMeasurement) -> str:
    """What the curves are of."""
    if measurement.reference_known:
        return "The curves are the low sensor's own: the high image's MTF was divided out."
    return (
        "The curves are MTF_low / MTF_high: the high image's own MTF was not given, and the low "
        "sensor's is lower by that."
    )


def biresolution_sections(measurement: BiresolutionMeasurement) -> tuple[Section, ...]:
    """The sections a bi-resolution measurement adds to the report."""
    iterations = tuple(
        (
            str(i), format_number(step.residual), f"{step.change:.1e}" if i else "",
            *(f"{value:.4f}" for value in (*step.shift_px, *step.variance_px2)),
        )
        for i, step in enumerate(measurement.steps)
    )  # fmt: skip
    return (
        Section(
            "The pair",
            paragraphs=(describe_quantity(measurement),),
            tables=(Table(("", ""), tuple(_pair_rows(measurement)), "ll"),),
        ),
        Section(
            "Iterations of the parametric fit",
            paragraphs=(
                "Blur the high image, sample it, compare, change the kernel, until the relative "
                "change of the residual falls below the threshold "
                f"{measurement.options['stop_change']:g} (Li et al., 5.3). The free kernel starts "
                "from the last one.",
            ),
            tables=(
                Table(
                    (
                        "step", "residual", "relative change", "shift down [px]",
                        "shift across [px]", "variance along [px²]", "variance across [px²]",
                    ),
                    iterations,
                    "rrrrrrr",
                ),
            ),
        ),
    )  # fmt: skip


def _pair_rows(measurement: BiresolutionMeasurement) -> list[tuple[str, str]]:
    high, grid = measurement.high, measurement.grid
    rows, cols = measurement.ratio
    same = format_number(rows) == format_number(cols)
    ratio = format_number(rows) if same else f"{format_number(rows)} by {format_number(cols)}"
    source = {
        "geotransform": "by the geotransforms",
        "shapes": "by the shapes of the images",
        "given": "as given",
    }[grid.source]
    down, across = (word_estimate(one).value_and_std for one in measurement.shift_px)
    fit, local = measurement.pixel_fit, measurement.local
    share = f", {100 * measurement.share_read:.0f} % of the scene" * (measurement.share_read < 1)
    mtf = [measurement.local_mtf_nyquist(axis)[0] for axis in ("across", "along")]
    spread = [float(np.nanstd(one)) if np.isfinite(one).any() else float("nan") for one in mtf]
    return [
        ("high image", f"{high.path or 'array in memory'}, band {high.band}"),
        ("ratio of the GSDs", f"{ratio}, {source}"),
        ("shift of the low content", f"{down} px down, {across} px across"),
        ("gain, offset", f"{measurement.gain:.5g}, {measurement.offset:.5g}"),
        ("low pixels used", f"{fit.used} (left out {fit.left_out}){share}"),
        (
            "residual",
            f"{format_number(fit.noise)}, correlation of neighbours {fit.whitening.strongest:+.2f}",
        ),
        ("noise of the high image", format_number(measurement.high_noise)),
        (
            "regions of the map",
            f"{local.pixels.size}; {transfer_name(measurement)} at Nyquist scatters by "
            f"{spread[0]:.3f} across, {spread[1]:.3f} along, "
            f"shifts by {local.shift_spread_px:.3f} px",
        ),
    ]
