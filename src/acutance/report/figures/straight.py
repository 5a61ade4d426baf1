"""Drawings of edges and pulses: the target, its samples along the normal, the zeros of a pulse."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.report.figures.curves import band_edges, curve_panels, draw_mtf
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.figures.pixels import show_pixels
from acutance.report.labels import word_estimate
from acutance.report.paper import BLUE, FAINT, ORANGE, PLUM, VERMILION
from acutance.targets.straight.pulse_spectrum import zeros_cpp

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.curves import Estimate
    from acutance.geometry.line import Line
    from acutance.targets.straight import StraightMeasurement

__all__ = [
    "TOP_BESIDE_ZEROS",
    "draw_esf",
    "draw_prf",
    "draw_target",
    "mark_zeros",
    "straight_panels",
]

MAX_ZEROS_NAMED = 8
HEIGHTS_OF_NAMES = (0.585, 0.45, 0.3, 0.15)
TOP_BESIDE_ZEROS = 1.2
"""A ratio of spectra has spikes at the zeros of the pulse's; they are not drawn whole."""
MIN_REACH_PX, REACH_FWHM = 3.0, 3.5
"""How far from a step its samples are drawn: in pixels at least, in widths of the LSF."""


def straight_panels(measurement: StraightMeasurement) -> tuple[Panel, ...]:
    """MTF and LSF; the target and its samples where the measurement still has its pixels."""
    mtf, lsf = curve_panels(measurement)
    width_px = measurement.width_px
    if width_px is not None:
        mtf = Panel(mtf.title, f"{mtf.caption} Dotted: zeros of the pulse's own spectrum.",
                    on_axes(_draw_pulse_mtf, measurement))  # fmt: skip
    if measurement.details is None:
        return mtf, lsf
    target = Panel(
        "The pixels and the line",
        f"The region, {'the fitted line' if width_px is None else 'both sides of the pulse'}, and "
        "the pixels of the fit.",
        on_axes(draw_target, measurement),
        is_target=True,
    )
    if width_px is None:
        samples = Panel(
            "Edge spread function",
            "Every pixel at its distance along the normal, the fitted ESF, and the residuals.",
            _above_residuals(measurement, draw_esf),
        )
    else:
        samples = Panel(
            "Pulse response",
            "Every pixel at its distance from the first side, the fitted response, and the "
            "residuals.",
            _above_residuals(measurement, draw_prf),
        )
    return mtf, lsf, target, samples


def _above_residuals(
    measurement: StraightMeasurement, draw: Callable[[Axes, StraightMeasurement], None]
) -> Callable[[FigureBase], None]:
    """Every pixel along the normal, and below it the residuals."""

    def drawn(page: FigureBase) -> None:
        values, residuals = page.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
        draw(values, measurement)
        _draw_residuals(residuals, measurement)

    return drawn


def draw_target(axes: Axes, measurement: StraightMeasurement) -> None:
    """The pixels around the target, its line or sides, those of the fit, and an arrow across.

    The arrow goes from dark to bright, of a pulse from the background into it.
    """
    line, pulse_width, details = measurement.line, measurement.width_px, measurement.details
    rows_shown, cols_shown = _surroundings(details.used)
    pixels, used = details.pixels[rows_shown, cols_shown], details.used[rows_shown, cols_shown]
    row = measurement.image.roi[0] + rows_shown.start
    col = measurement.image.roi[1] + cols_shown.start
    height, width = pixels.shape
    show_pixels(axes, pixels, row, col)
    axes.contour(
        np.arange(-1, width + 1) + col, np.arange(-1, height + 1) + row,
        np.pad(used, 1).astype(float), levels=[0.5], colors=[ORANGE], linewidths=1.3,
    )  # fmt: skip
    sides = [line] if pulse_width is None else [line, line.moved(pulse_width.value, 0.0)]
    for side in sides:
        _draw_line(axes, side, (row, col), pixels.shape)
    x, y = line.normal
    half = max(0.13 * min(height, width), 0.05 * max(height, width))
    axes.annotate(
        "", (line.col + half * x, line.row + half * y), (line.col - half * x, line.row - half * y),
        arrowprops={"arrowstyle": "-|>", "color": BLUE, "linewidth": 2.4, "mutation_scale": 17},
    )  # fmt: skip
    target, way = ("edge", "dark → bright") if pulse_width is None else ("sides", "into the pulse")
    _legend_below(axes, [(target, VERMILION), ("pixels used", ORANGE), (way, BLUE)])
    axes.set_title("Target")


def _draw_line(axes: Axes, line: Line, origin: tuple[int, int], shape: tuple[int, ...]) -> None:
    """A line as far as it runs through pixels of a shape, the first of them at `origin`."""
    (row, col), (height, width) = origin, shape
    x, y = line.normal
    run = np.linspace(-height - width, height + width, 4001)
    columns, rows = line.col - y * run, line.row + x * run
    inside = (np.abs(columns - col - (width - 1) / 2) <= width / 2) & (
        np.abs(rows - row - (height - 1) / 2) <= height / 2
    )
    axes.plot(columns[inside], rows[inside], color=VERMILION, linewidth=2)


def _surroundings(used: NDArray[np.bool_]) -> tuple[slice, slice]:
    """The rows and columns that hold the pixels used, with a margin of their surroundings."""
    spans = []
    for axis in (1, 0):
        places = np.flatnonzero(used.any(axis=axis))
        first, last = int(places[0]), int(places[-1])
        margin = max(6, (last - first) // 6)
        spans.append(slice(max(0, first - margin), min(used.shape[1 - axis], last + 1 + margin)))
    return spans[0], spans[1]


def _legend_below(axes: Axes, entries: list[tuple[str, str]]) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=color, label=label) for label, color in entries]
    axes.figure.legend(
        handles=handles, loc="outside lower center", ncols=len(entries), columnspacing=1.2,
        handlelength=1.4,
    )  # fmt: skip


def _reach_px(measurement: StraightMeasurement) -> float:
    """How far from a step a drawing goes: where something still happens."""
    grid = measurement.lsf.distance_px
    wide = REACH_FWHM * measurement.fwhm_px.value
    end = float(min(-grid[0], grid[-1]))
    return min(max(MIN_REACH_PX, wide), end) if math.isfinite(wide) else end


def _dot(axes: Axes, places: Floats, values: Floats, label: str | None = None) -> None:
    style: dict[str, Any] = {"markersize": 3, "alpha": 0.45, "rasterized": True}
    axes.plot(places, values, ".", color=FAINT, label=label, **style)


def draw_esf(axes: Axes, measurement: StraightMeasurement) -> None:
    """The samples along the normal and the edge spread function with its 95 % band."""
    esf, details, reach = measurement.esf, measurement.details, _reach_px(measurement)
    # Plateau gradients belong to the fit: pixels are shown without them, as residuals are.
    fitted = np.interp(details.distance_px, esf.distance_px, esf.value, left=0.0, right=1.0)
    count = f"{details.distance_px.size} pixels"
    _dot(axes, details.distance_px, fitted + details.residual, count)
    low, high = band_edges(esf.value, esf.std)
    axes.fill_between(esf.distance_px, low, high, color=BLUE, alpha=0.3, linewidth=0)
    axes.plot(esf.distance_px, esf.value, color=BLUE, label="ESF, 95 % band")
    axes.set(xlim=(-reach, reach), ylabel="edge response", title="Edge spread function")
    axes.legend(loc="upper left")


def draw_prf(axes: Axes, measurement: StraightMeasurement) -> None:
    """The samples along the normal, the fitted pulse response, both sides and the width."""
    details, width_px = measurement.details, _width_of(measurement)
    reach = _reach_px(measurement)
    _dot(axes, details.distance_px, details.value, f"{details.distance_px.size} pixels")
    order = np.argsort(details.distance_px)
    fitted = details.value - details.residual
    axes.plot(details.distance_px[order], fitted[order], color=BLUE, label="fitted PRF")
    low, high = min(0.0, float(fitted.min())), max(1.0, float(fitted.max()))
    bottom, at = low - 0.12 * (high - low), high + 0.12 * (high - low)
    for side in (0.0, width_px.value):
        axes.plot([side, side], [bottom, at], color=VERMILION, linewidth=1.2, dashes=(4, 3))
    axes.annotate(
        "", (width_px.value, at), (0.0, at),
        arrowprops={"arrowstyle": "<|-|>", "color": VERMILION, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip
    axes.text(
        0.5 * width_px.value, at + 0.03 * (high - low), "w", color=VERMILION, ha="center",
        va="bottom",
    )  # fmt: skip
    axes.set(
        xlim=(-reach, width_px.value + reach), ylim=(bottom, high + 0.3 * (high - low)),
        ylabel="response", title=f"Pulse, w = {word_estimate(width_px).value_and_std} px",
    )  # fmt: skip
    axes.legend(loc="upper right")


def _width_of(measurement: StraightMeasurement) -> Estimate:
    assert measurement.width_px is not None
    return measurement.width_px


def _draw_residuals(axes: Axes, measurement: StraightMeasurement) -> None:
    """What the fit leaves of every sample, in percent of the step or of the pulse's height."""
    details, esf, reach = measurement.details, measurement.esf, _reach_px(measurement)
    _dot(axes, details.distance_px, 100 * details.residual)
    end = reach
    if measurement.width_px is None:
        low, high = band_edges(np.zeros_like(esf.std), 100 * esf.std)
        axes.fill_between(esf.distance_px, low, high, color=BLUE, alpha=0.3, linewidth=0)
    else:
        end += measurement.width_px.value
    axes.axhline(0.0, color=BLUE, linewidth=1)
    axes.set(xlim=(-reach, end), xlabel="distance along the normal [px]", ylabel="residual [%]")


def _draw_pulse_mtf(axes: Axes, measurement: StraightMeasurement) -> None:
    draw_mtf(axes, measurement, TOP_BESIDE_ZEROS)
    mark_zeros(axes, _width_of(measurement).value)


def mark_zeros(axes: Axes, width_px: float) -> None:
    """Where the spectrum of a pulse of this width has its zeros, as thin dotted lines."""
    zeros = zeros_cpp(width_px, 0.99).tolist()
    for k, zero in enumerate(zeros, start=1):
        axes.axvline(zero, color=PLUM, linewidth=1.3, linestyle=":", zorder=1)
        if k == 1 or len(zeros) <= MAX_ZEROS_NAMED:
            # Beside it end the axes, or lies the line at Nyquist.
            on_left = zero > 0.93 or 0.45 < zero < 0.5
            ends = (zero - 0.05, zero) if on_left else (zero, zero + 0.05)
            axes.text(
                zero + (-0.006 if on_left else 0.006),
                _clear_height(axes, *ends),
                f"{k}/w",
                transform=axes.get_xaxis_transform(),
                ha="right" if on_left else "left",
                va="center",
                color=PLUM,
                fontsize=9,
            )


def _clear_height(axes: Axes, left: float, right: float) -> float:
    """Where between two frequencies no curve passes: of some heights of the axes the clearest."""
    bottom, top = axes.get_ylim()
    passed = [np.array([bottom, top], float)]
    for line in axes.lines:
        x, y = (np.asarray(part, float) for part in line.get_data())
        inside = (x >= left - 0.01) & (x <= right + 0.01)
        if np.count_nonzero(inside) > 1 and np.ptp(x) > 0:
            # A spike passes every height between its neighbouring samples.
            passed.append(np.concatenate([np.linspace(*pair) for pair in pairwise(y[inside])]))
    taken = (np.concatenate(passed) - bottom) / (top - bottom)
    return max(HEIGHTS_OF_NAMES, key=lambda height: float(np.min(np.abs(taken - height))))
