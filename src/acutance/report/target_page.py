"""All edges of one target: where they are and what they say together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves import METRICS
from acutance.report.grids import write_grid
from acutance.report.page import BLUE, INK, VERMILION, new_page, split_page, styled
from acutance.report.panels import TWO_SIDED_95, band_edges, mark_frequencies, show_pixels
from acutance.report.wording import MISSING, count_edges, format_number, metric_words, word_estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves.grid import Floats
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import EdgeGroup, TargetResult

__all__ = ["group_rows", "target_figure"]

MOST_NAMED = 8
COLORS = {"across": BLUE, "along": VERMILION}
DRAWN = ("mtf_nyquist", "rer", "fwhm_px", "mtf50_cpp", "mtf_area")


def target_figure(
    result: TargetResult,
    *,
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
) -> Figure:
    """All edges of a target: where they are, their MTFs by direction, the group means.

    Parameters
    ----------
    result : TargetResult
    backdrop : (rows, cols) array, optional
        The pixels to draw the edges on; without it the measured cuts are put together.
    origin : tuple of int, optional
        Row and column of the backdrop's first pixel in the whole image.
    """
    pixels, (row, col) = (
        (backdrop, origin) if backdrop is not None else _mosaic(result.measurements)
    )
    with styled():
        figure = new_page(13.0, 8.4)
        left, right = split_page(figure, 1, 2, widths=(1.0, 1.05))
        image, table = left.subplots(2, 1, height_ratios=(2.1, 1.0))
        show_pixels(image, pixels, row, col)
        _number_edges(image, result)
        _write_groups(table, result)
        for axes, orientation in zip(
            _panels(right, len(result.groups)), result.groups, strict=True
        ):
            _draw_group(axes, result, orientation, COLORS[orientation])
        count = len(result.measurements)
        none = "".join(f"; none {one}" for one in COLORS if one not in result.groups)
        figure.suptitle(
            f"{count_edges(count)} measured, {len(result.rejected)} rejected{none}",
            x=0.012,
            ha="left",
            fontsize=12,
        )
    return figure


def _panels(page: FigureBase, count: int) -> list[Axes]:
    """As many panels as there are directions, one below the other."""
    return list(np.atleast_1d(page.subplots(count, 1)))


def _mosaic(measurements: Sequence[Measurement]) -> tuple[Floats, tuple[int, int]]:
    """The cuts put where they belong; NaN between them."""
    boxes = np.array([one.image.roi for one in measurements])
    first = boxes[:, :2].min(axis=0)
    last = (boxes[:, :2] + boxes[:, 2:]).max(axis=0)
    canvas = np.full(tuple(last - first), math.nan)
    for one in measurements:
        row, col, height, width = one.image.roi
        part = canvas[row - first[0] :, col - first[1] :][:height, :width]
        part[...] = np.where(np.isfinite(one.samples.image), one.samples.image, part)
    return canvas, (int(first[0]), int(first[1]))


def _number_edges(axes: Axes, result: TargetResult) -> None:
    for number, one in enumerate(result.measurements, start=1):
        color = COLORS[one.orientation]
        x, y = one.line.normal
        half = 0.5 * (one.line.length_px if math.isfinite(one.line.length_px) else 0.0)
        axes.plot(
            [one.line.col - half * y, one.line.col + half * y],
            [one.line.row + half * x, one.line.row - half * x],
            color=color,
            linewidth=2.2,
        )
        axes.annotate(
            str(number),
            (one.line.col, one.line.row),
            (11 * x, -11 * y),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8.5,
            fontweight="bold",
            color="white",
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": color, "edgecolor": "white"},
        )
    axes.set_title("Edges: across blue, along vermilion")


def _draw_group(axes: Axes, result: TargetResult, orientation: str, color: str) -> None:
    group: EdgeGroup = result.groups[orientation]
    top = max(float(one.mtf.value.max()) for one in group.measurements)
    mark_frequencies(axes, group.measurements[0].response.gsd_m, top)
    numbers = {id(one): i for i, one in enumerate(result.measurements, start=1)}
    for one in group.measurements:
        low, high = band_edges(one.mtf.value, one.mtf.std)
        axes.fill_between(one.mtf.freq_cpp, low, high, color=color, alpha=0.10, linewidth=0)
        axes.plot(one.mtf.freq_cpp, one.mtf.value, color=color, linewidth=1.1, alpha=0.8)
    mean = group.metrics["mtf_nyquist"]
    axes.errorbar(
        0.5, mean.value, yerr=TWO_SIDED_95 * mean.std, fmt="D", color=INK, capsize=4, zorder=5
    )
    members = [str(numbers[id(one)]) for one in group.measurements]
    named = count_edges(len(members))
    if len(members) <= MOST_NAMED:
        named += f" ({', '.join(members)})"
    axes.text(
        0.985,
        0.955,
        f"{named}\nmean at Nyquist {word_estimate(mean).value_and_std}",
        transform=axes.transAxes,
        ha="right",
        va="top",
    )
    axes.set_title(f"MTF {orientation}")


def group_rows(
    result: TargetResult, names: Sequence[str] = METRICS
) -> list[tuple[str, str, str, str, str]]:
    """Direction, metric, weighted mean, chi-square over its degrees of freedom, p-value."""
    rows = []
    for orientation, group in result.groups.items():
        for name in names:
            if name not in group.metrics:
                continue
            spread, freedom = group.chi_square[name], group.degrees_of_freedom
            rows.append(
                (
                    orientation,
                    metric_words(name).label_with_unit,
                    word_estimate(group.metrics[name]).value_and_std,
                    f"{spread:.1f} / {freedom}" if freedom and math.isfinite(spread) else MISSING,
                    format_number(group.p_value[name], 2),
                )
            )
    return rows


def _write_groups(axes: Axes, result: TargetResult) -> None:
    rows = [("", "", "weighted mean ± std", "chi² / dof", "p")]
    rows += group_rows(result, DRAWN)
    colors = [INK, *(BLUE if row[0] == "across" else VERMILION for row in rows[1:])]
    write_grid(
        axes,
        rows,
        places=(0.0, 0.13, 0.68, 0.86, 1.0),
        align="llrrr",
        colors=colors,
        fontsize=8.5,
    )
