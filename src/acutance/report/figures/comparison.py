"""Several measurements of one target, side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.metric_words import metric_words
from acutance.report.figures.curves import band_edges, mark_frequencies
from acutance.report.figures.straight import TOP_BESIDE_ZEROS, draw_target, mark_zeros
from acutance.report.figures.writing import write_grid
from acutance.report.labels import MISSING, describe_image, title_of, word_estimate
from acutance.report.paper import INK, NAME_WITH_ROOM, PALETTE, new_page, split_page, styled
from acutance.report.tables.comparison import true_numbers
from acutance.report.tables.measurement import numbers_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.report.comparison import Comparison

__all__ = ["comparison_figure"]

MAX_BESIDE_ZEROS = 0.2
COMPARED = ("mtf_nyquist", "rer", "fwhm_px", "mtf50_cpp", "mtf_area", "overshoot")
ROW_IN, TABLE_LINE_IN = 6.8, 0.22


def comparison_figure(comparison: Comparison, on_page: bool = False) -> Figure:
    """Target, curves, differences and numbers of several measurements.

    Parameters
    ----------
    comparison : Comparison
        Differences are taken to the truth, or to the first measurement where the truth is not
        known.
    on_page : bool, optional
        Whether it is for a page, which has title and numbers of its own.

    Returns
    -------
    matplotlib.figure.Figure
    """
    lines = len(comparison.measurements) + bool(comparison.truth) + 1
    table_in = 0.2 + TABLE_LINE_IN * lines if not on_page else 0.0
    directions = comparison.directions
    heights = [height for _ in directions for height in (ROW_IN, table_in) if height]
    with styled():
        figure = new_page(13.0, sum(heights) + 0.4)
        parts = iter(split_page(figure, len(heights), 1, heights=heights))
        for direction in directions:
            _draw_direction(next(parts), comparison, direction, direction == directions[0])
            if not on_page:
                _write_numbers(next(parts).subplots(), comparison, direction)
        first = comparison.measurements[0]
        if not on_page:
            figure.suptitle(
                f"{title_of(first).split(',')[0]} measured by {len(comparison.labels)} methods"
                f"{_not_measured(comparison)}\n"
                f"{describe_image(first, NAME_WITH_ROOM)}",
                x=0.012, ha="left", fontsize=11,
            )  # fmt: skip
    return figure


def _not_measured(comparison: Comparison) -> str:
    """The methods by which there is no result: "; not by sdsu-2005"."""
    names = ", ".join(str(one.values["method"]) for one in comparison.rejected)
    return f"; not by {names}" if names else ""


def _draw_direction(page: FigureBase, comparison: Comparison, direction: str, first: bool) -> None:
    """MTFs next to their differences; the target and the differences of the ESFs below."""
    measurement: Any = comparison.measurements[0]
    responses: dict[str, Response] = {
        label: one.directions[direction]  # type: ignore[index]
        for label, one in zip(comparison.labels, comparison.measurements, strict=True)
    }
    truth = comparison.truth.get(direction)
    name, reference = ("truth", truth) if truth is not None else next(iter(responses.items()))
    has_target = first and hasattr(measurement, "line") and measurement.details is not None
    upper, lower = split_page(page, 2, 1)
    left, right = split_page(upper, 1, 2, widths=(1.0, 1.0))
    mtfs, mtf_axes = left.subplots(), right.subplots()
    width = getattr(measurement, "width_px", None)
    _draw_mtfs(mtfs, responses, truth, math.inf if width is None else TOP_BESIDE_ZEROS)
    if len(comparison.directions) > 1:
        mtfs.set_title(f"MTF {direction} track")
    _draw_mtf_differences(mtf_axes, responses, reference, name)
    if width is not None:
        mark_zeros(mtfs, width.value)
        low, high = mtf_axes.get_ylim()
        mtf_axes.set_ylim(max(low, -MAX_BESIDE_ZEROS), min(high, MAX_BESIDE_ZEROS))
    if has_target:
        target, lower = split_page(lower, 1, 2)
        draw_target(target.subplots(), measurement)
    _draw_esf_differences(lower.subplots(), responses, reference, name)


def _draw_mtfs(
    axes: Axes, responses: Mapping[str, Response], truth: Response | None, most: float
) -> None:
    top = max(float(response.mtf.value.max()) for response in responses.values())
    mark_frequencies(axes, next(iter(responses.values())).gsd_m, min(top, most))
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        mtf = response.mtf
        low, high = band_edges(mtf.value, mtf.std)
        axes.fill_between(mtf.freq_cpp, low, high, color=color, alpha=0.18, linewidth=0)
        axes.plot(mtf.freq_cpp, mtf.value, color=color, label=label)
    if truth is not None:
        axes.plot(truth.mtf.freq_cpp, truth.mtf.value, "k--", linewidth=1.3, label="truth")
    axes.set_title("Modulation transfer function")
    axes.legend(loc="upper right")


def _colors(count: int) -> list[str]:
    return [PALETTE[i % len(PALETTE)] for i in range(count)]


def _draw_mtf_differences(
    axes: Axes, responses: Mapping[str, Response], reference: Response, name: str
) -> None:
    freq = reference.mtf.freq_cpp
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        mtf = response.mtf
        if response is not reference:
            value = np.interp(freq, mtf.freq_cpp, mtf.value) - reference.mtf.value
            std = np.interp(freq, mtf.freq_cpp, mtf.std)
            _draw_difference(axes, freq, value, std, color, label)
    _mark_zero(axes)
    axes.axvline(0.5, color=INK, linewidth=1, dashes=(5, 3))
    axes.set(xlim=(0.0, 1.0), xlabel="frequency [cycles/pixel]", title=f"MTF − {name}")


def _draw_esf_differences(
    axes: Axes, responses: Mapping[str, Response], reference: Response, name: str
) -> None:
    places = np.linspace(-5.0, 5.0, 501)
    base, _ = _esf_at(reference, places)
    for (label, response), color in zip(responses.items(), _colors(len(responses)), strict=True):
        if response is not reference:
            value, std = _esf_at(response, places)
            _draw_difference(axes, places, value - base, std, color, label)
    _mark_zero(axes)
    axes.set(xlim=(-5, 5), xlabel="distance along the normal [px]", title=f"ESF − {name}")


def _draw_difference(
    axes: Axes, places: Floats, value: Floats, std: Floats, color: str, label: str
) -> None:
    low, high = band_edges(value, std)
    axes.fill_between(places, low, high, color=color, alpha=0.18, linewidth=0)
    axes.plot(places, value, color=color, label=label)


def _mark_zero(axes: Axes) -> None:
    axes.axhline(0.0, color=INK, linewidth=1, dashes=(4, 3), zorder=1)


def _esf_at(response: Response, places: Floats) -> tuple[Floats, Floats]:
    esf = response.esf
    value = np.interp(places, esf.distance_px, esf.value, left=0.0, right=1.0)
    return value, np.interp(places, esf.distance_px, esf.std)


def _write_numbers(axes: Axes, comparison: Comparison, direction: str) -> None:
    numbers: dict[str, dict[str, Estimate]] = {
        label: numbers_of(one)[direction]
        for label, one in zip(comparison.labels, comparison.measurements, strict=True)
    }
    truth = true_numbers(comparison, direction)
    pulses = all("width_px" in each for each in numbers.values())
    names = (*(("width_px",) if pulses else ()), *COMPARED)
    rows = [("", "", *(metric_words(name).label_with_unit for name in names))]
    marks = [INK]
    if truth:
        known = (word_estimate(truth[name]).value if name in truth else MISSING for name in names)
        rows.append(("–", "truth", *known))
        marks.append(INK)
    for (label, each), color in zip(numbers.items(), _colors(len(numbers)), strict=True):
        rows.append(("■", label, *(word_estimate(each[name]).value_and_std for name in names)))
        marks.append(color)
    places = (0.01, 0.03, *np.linspace(0.27, 1.0, len(names)))
    write_grid(axes, rows, places=places, align="ll" + "r" * len(names), marks=marks)
