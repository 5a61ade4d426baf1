"""All edges of one target: where they are and their means."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.errors import OptionError
from acutance.report.figures.curves import COLORS, TWO_SIDED_95, band_edges, mark_frequencies
from acutance.report.figures.pixels import as_backdrop, show_pixels
from acutance.report.figures.writing import write_grid
from acutance.report.labels import count_edges, describe_image, word_estimate
from acutance.report.paper import (
    BLUE,
    FAINT,
    INK,
    NAME_WITH_ROOM,
    VERMILION,
    new_page,
    split_page,
    styled,
)
from acutance.report.tables.target import group_rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves.grid import Floats
    from acutance.targets import EdgeGroup, TargetResult

__all__ = ["target_figure"]

MAX_NAMED = 8
DRAWN = ("mtf_nyquist", "rer", "fwhm_px", "mtf50_cpp", "mtf_area")


def target_figure(
    result: TargetResult[Any],
    *,
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
    on_page: bool = False,
) -> Figure:
    """All edges of a target: where they are, their MTFs by direction, the group means.

    Parameters
    ----------
    result : TargetResult
    backdrop : (rows, cols) array, optional
        The pixels to draw the edges on; without it the measured regions are put together.
    origin : tuple of int, optional
        Row and column of the backdrop's first pixel in the whole image.
    on_page : bool, optional
        Whether it is for a page, which has title and means of its own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    OptionError
        If no edge was measured.
    """
    if not result.measurements:
        reasons = "".join(f"; {one.reason}" for one in result.rejected[:1])
        raise OptionError(
            f"there is nothing to draw: none of the {len(result.rejected)} edges tried was "
            f"measured{reasons}. Print the result as text or JSON instead"
        )
    shown = as_backdrop(backdrop)
    pixels, (row, col) = (shown, origin) if shown is not None else _mosaic(result.measurements)
    with styled():
        figure = new_page(13.0, 6.2 if on_page else 8.4)
        left, right = split_page(figure, 1, 2, widths=(1.0, 1.05))
        if not on_page:
            image, table = left.subplots(2, 1, height_ratios=(2.1, 1.0))
            _write_groups(table, result)
        else:
            image = left.subplots()
        _show_edges(image, result, pixels, row, col)
        for axes, orientation in zip(
            _panels(right, len(result.groups)), result.groups, strict=True
        ):
            _draw_group(axes, result, orientation, COLORS[orientation])
        if on_page:
            return figure
        count = len(result.measurements)
        none = "".join(f"; none {one}" for one in COLORS if one not in result.groups)
        where = f"\n{describe_image(result.measurements[0], NAME_WITH_ROOM)}" if count else ""
        figure.suptitle(
            f"{count_edges(count)} measured, {len(result.rejected)} rejected{none}{where}",
            x=0.012, ha="left", fontsize=11,
        )  # fmt: skip
    return figure


def _show_edges(
    axes: Axes, result: TargetResult[Any], pixels: Floats | None, row: int, col: int
) -> None:
    if pixels is None:
        # Measurements without details have no pixels: their lines alone.
        axes.set(xlabel="column", ylabel="row", aspect="equal")
        axes.invert_yaxis()
    else:
        show_pixels(axes, pixels, row, col)
    _number_edges(axes, result)


def _panels(page: FigureBase, count: int) -> list[Axes]:
    """As many panels as there are directions, one below the other."""
    return list(np.atleast_1d(page.subplots(count, 1)))


def _mosaic(measurements: Sequence[Any]) -> tuple[Floats | None, tuple[int, int]]:
    """The regions put where they belong, NaN between them; nothing where pixels are missing."""
    boxes = np.array([one.image.roi for one in measurements])
    first = boxes[:, :2].min(axis=0)
    if any(one.details is None for one in measurements):
        return None, (int(first[0]), int(first[1]))
    last = (boxes[:, :2] + boxes[:, 2:]).max(axis=0)
    canvas = np.full(tuple(last - first), math.nan)
    for one in measurements:
        row, col, height, width = one.image.roi
        pixels = one.details.pixels
        part = canvas[row - first[0] :, col - first[1] :][:height, :width]
        part[...] = np.where(np.isfinite(pixels), pixels, part)
    return canvas, (int(first[0]), int(first[1]))


def _number_edges(axes: Axes, result: TargetResult[Any]) -> None:
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
    axes.set_title("Edges: across blue, along orange")


def _draw_group(axes: Axes, result: TargetResult[Any], orientation: str, color: str) -> None:
    group: EdgeGroup[Any] = result.groups[orientation]
    top = max(float(one.mtf.value.max()) for one in group.measurements)
    mark_frequencies(axes, group.measurements[0].response.gsd_m, top)
    numbers = {id(one): i for i, one in enumerate(result.measurements, start=1)}
    for one in group.left_out:
        axes.plot(one.mtf.freq_cpp, one.mtf.value, color=FAINT, linewidth=0.9, linestyle="--")
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
    if len(members) <= MAX_NAMED:
        named += f" ({', '.join(members)})"
    if group.left_out:
        named += f", {len(group.left_out)} left out (dashed)"
    axes.text(
        0.985,
        0.955,
        f"{named}\nmean at Nyquist {word_estimate(mean).value_and_std}",
        transform=axes.transAxes,
        ha="right",
        va="top",
    )
    axes.set_title(f"MTF {orientation}")


def _write_groups(axes: Axes, result: TargetResult[Any]) -> None:
    rows = [("", "", "mean ± std", "chi² / dof", "p")]
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
