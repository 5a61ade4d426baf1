"""One drawing for each step of a measurement, each on axes it is handed."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import metrics
from acutance.curves.grid import Floats, crossing
from acutance.report.page import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, SHADE, VERMILION
from acutance.report.wording import word_estimate
from acutance.targets.straight.pulse_spectrum import zeros_cpp

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.curves import Lsf, Mtf
    from acutance.geometry.line import Line
    from acutance.targets.measurement import Measurement, Samples

__all__ = [
    "band_edges",
    "draw_cut",
    "draw_esf",
    "draw_lsf",
    "draw_mtf",
    "draw_pixels",
    "draw_residuals",
    "mark_frequencies",
    "mark_zeros",
    "reach_px",
    "show_pixels",
]

TWO_SIDED_95 = 1.959964
MOST_ZEROS_NAMED = 8
HEIGHTS_OF_NAMES = (0.585, 0.45, 0.3, 0.15)
TOP_BESIDE_ZEROS = 1.2
"""A ratio of spectra has spikes at the zeros of the pulse's; they are not drawn whole."""


def band_edges(value: Floats, std: Floats) -> tuple[Floats, Floats]:
    """Lower and upper edge of the 95 % band."""
    return value - TWO_SIDED_95 * std, value + TWO_SIDED_95 * std


def reach_px(measurement: Measurement) -> float:
    """How far from a step a drawing goes: where something still happens, 3 px at least."""
    grid = measurement.lsf.distance_px
    wide = 3.5 * measurement.fwhm_px.value
    end = float(min(-grid[0], grid[-1]))
    return min(max(3.0, wide), end) if math.isfinite(wide) else end


def show_pixels(axes: Axes, pixels: Floats, row: int, col: int) -> None:
    """An image in grey, its axes counting pixels of the whole image from (row, col)."""
    import matplotlib

    low, high = np.nanpercentile(pixels, (0.5, 99.5))
    margin = 0.08 * (high - low)
    height, width = pixels.shape
    axes.imshow(
        pixels,
        cmap=matplotlib.colormaps["gray"].with_extremes(bad="#f6e7da"),
        vmin=low - margin,
        vmax=high + margin,
        extent=(col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5),
        interpolation="nearest",
    )
    axes.grid(visible=False)
    axes.locator_params(axis="x", integer=True, nbins=_tick_count(width / height))
    axes.locator_params(axis="y", integer=True, nbins=_tick_count(height / width))
    axes.set(xlabel="column", ylabel="row")


def _tick_count(relative_length: float) -> int:
    """How many intervals between ticks have room on a side of an image."""
    return math.ceil(6 * min(1.0, relative_length) - 0.5)


def draw_cut(axes: Axes, measurement: Measurement) -> None:
    """The pixels around the target, its line or sides, the band used, and an arrow across.

    The arrow goes from dark to bright, of a pulse from the ground into it.
    """
    line = measurement.line
    pulse_width = measurement.width_px
    rows_shown, cols_shown = _surroundings(measurement.samples.used)
    pixels = measurement.samples.image[rows_shown, cols_shown]
    used = measurement.samples.used[rows_shown, cols_shown]
    row = measurement.image.roi[0] + rows_shown.start
    col = measurement.image.roi[1] + cols_shown.start
    height, width = pixels.shape
    show_pixels(axes, pixels, row, col)
    axes.contour(
        np.arange(-1, width + 1) + col,
        np.arange(-1, height + 1) + row,
        np.pad(used, 1).astype(float),
        levels=[0.5],
        colors=[ORANGE],
        linewidths=1.3,
    )
    sides = [line] if pulse_width is None else [line, line.moved(pulse_width.value, 0.0)]
    for side in sides:
        _draw_line(axes, side, (row, col), pixels.shape)
    x, y = line.normal
    half = max(0.13 * min(height, width), 0.05 * max(height, width))
    axes.annotate(
        "",
        (line.col + half * x, line.row + half * y),
        (line.col - half * x, line.row - half * y),
        arrowprops={"arrowstyle": "-|>", "color": BLUE, "linewidth": 2.4, "mutation_scale": 17},
    )
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
    """The rows and columns that hold the pixels used, with a margin to see what lies beside."""
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
        handles=handles,
        loc="outside lower center",
        ncols=len(entries),
        columnspacing=1.2,
        handlelength=1.4,
    )


def draw_pixels(axes: Axes, samples: Samples, values: Floats | None = None) -> None:
    """Every pixel used, or some `values` of them, (n,), at its distance along the normal."""
    shown = samples.value if values is None else values
    _dot(axes, samples.distance_px, shown, f"{samples.distance_px.size} pixels")


def _dot(axes: Axes, places: Floats, values: Floats, label: str | None = None) -> None:
    style: dict[str, Any] = {"markersize": 3, "alpha": 0.45, "rasterized": True}
    axes.plot(places, values, ".", color=FAINT, label=label, **style)


def draw_esf(axes: Axes, measurement: Measurement) -> None:
    """The samples along the normal and the edge spread function with its 95 % band."""
    esf, reach = measurement.esf, reach_px(measurement)
    samples = measurement.samples
    # Slow trends of the ground belong to the fit: pixels are shown without them, as residuals are.
    fitted = np.interp(samples.distance_px, esf.distance_px, esf.value, left=0.0, right=1.0)
    draw_pixels(axes, samples, fitted + samples.residual)
    low, high = band_edges(esf.value, esf.std)
    axes.fill_between(esf.distance_px, low, high, color=BLUE, alpha=0.3, linewidth=0)
    axes.plot(esf.distance_px, esf.value, color=BLUE, label="ESF, 95 % band")
    axes.set(xlim=(-reach, reach), ylabel="edge response", title="Edge spread function")
    axes.legend(loc="upper left")


def draw_residuals(axes: Axes, measurement: Measurement) -> None:
    """What the fit leaves of every sample, in percent of the step or of the pulse's height."""
    samples, esf, reach = measurement.samples, measurement.esf, reach_px(measurement)
    _dot(axes, samples.distance_px, 100 * samples.residual)
    end = reach
    if measurement.width_px is None:
        low, high = band_edges(np.zeros_like(esf.std), 100 * esf.std)
        axes.fill_between(esf.distance_px, low, high, color=BLUE, alpha=0.3, linewidth=0)
    else:
        end += measurement.width_px.value
    axes.axhline(0.0, color=BLUE, linewidth=1)
    axes.set(xlim=(-reach, end), xlabel="distance along the normal [px]", ylabel="residual [%]")


def draw_lsf(axes: Axes, measurement: Measurement) -> None:
    """The line spread function with its 95 % band and the FWHM."""
    lsf, reach = measurement.lsf, reach_px(measurement)
    low, high = band_edges(lsf.value, lsf.std)
    axes.fill_between(lsf.distance_px, low, high, color=BLUE, alpha=0.3, linewidth=0)
    axes.plot(lsf.distance_px, lsf.value, color=BLUE)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    _mark_fwhm(axes, lsf, f"FWHM {word_estimate(measurement.fwhm_px).value_and_std} px")
    top = float(np.max(high))
    axes.set(
        xlim=(-reach, reach),
        ylim=(min(-0.05 * top, 1.05 * float(np.min(low))), 1.22 * top),
        xlabel="distance along the normal [px]",
        ylabel="LSF [1/px]",
        title="Line spread function",
    )


def _mark_fwhm(axes: Axes, lsf: Lsf, label: str) -> None:
    peak = int(np.argmax(lsf.value))
    half = 0.5 * float(lsf.value[peak])
    at = float(lsf.distance_px[peak])
    left = crossing(lsf.distance_px, lsf.value, half, at, -1)
    right = crossing(lsf.distance_px, lsf.value, half, at, +1)
    if math.isnan(left) or math.isnan(right):
        return
    axes.annotate(
        "",
        (right, half),
        (left, half),
        arrowprops={"arrowstyle": "<|-|>", "color": VERMILION, "shrinkA": 0, "shrinkB": 0},
    )
    axes.text(0.5, 0.965, label, transform=axes.transAxes, color=VERMILION, ha="center", va="top")


def draw_mtf(axes: Axes, measurement: Measurement) -> None:
    """The MTF from 0 to 1 c/px with its 95 % band, Nyquist, MTF50 and the aliased region."""
    mtf = measurement.mtf
    low, high = band_edges(mtf.value, mtf.std)
    top = float(np.max(high))
    if measurement.width_px is not None:
        top = min(top, TOP_BESIDE_ZEROS)
    mark_frequencies(axes, measurement.response.gsd_m, top)
    axes.fill_between(mtf.freq_cpp, low, high, color=BLUE, alpha=0.3, linewidth=0)
    axes.plot(mtf.freq_cpp, mtf.value, color=BLUE)
    _mark_point(axes, mtf, metrics.NYQUIST_CPP, VERMILION)
    nyquist = word_estimate(measurement.mtf_nyquist).value_and_std
    lines = [(f"MTF at Nyquist\n{nyquist}", VERMILION)]
    mtf50 = measurement.response.mtf50_cpp
    if math.isfinite(mtf50.value) and mtf50.value <= 1.0:
        axes.plot(
            [0.0, mtf50.value, mtf50.value],
            [0.5, 0.5, 0.0],
            color=GREEN,
            linewidth=1,
            dashes=(4, 3),
        )
        axes.plot(mtf50.value, 0.5, "o", color=GREEN, markersize=5)
        lines.append((f"MTF50\n{word_estimate(mtf50).value_and_std} c/px", GREEN))
    for i, (text, color) in enumerate(lines):
        axes.text(
            0.985,
            0.955 - 0.155 * i,
            text,
            transform=axes.transAxes,
            ha="right",
            va="top",
            color=color,
        )
    if measurement.width_px is not None:
        mark_zeros(axes, measurement.width_px.value)
    axes.set_title("Modulation transfer function")


def mark_zeros(axes: Axes, width_px: float) -> None:
    """Where the spectrum of a pulse of this width has its zeros, as thin dotted lines."""
    zeros = zeros_cpp(width_px, 0.99).tolist()
    for k, zero in enumerate(zeros, start=1):
        axes.axvline(zero, color=PURPLE, linewidth=0.9, linestyle=":", zorder=1)
        if k == 1 or len(zeros) <= MOST_ZEROS_NAMED:
            near_end = zero > 0.93
            ends = (zero - 0.05, zero) if near_end else (zero, zero + 0.05)
            axes.text(
                zero + (-0.006 if near_end else 0.006),
                _clear_height(axes, *ends),
                f"{k}/w",
                transform=axes.get_xaxis_transform(),
                ha="right" if near_end else "left",
                va="center",
                color=PURPLE,
                fontsize=7,
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


def _mark_point(axes: Axes, mtf: Mtf, freq_cpp: float, color: str) -> None:
    here = mtf(freq_cpp)
    axes.errorbar(
        freq_cpp,
        here.value,
        yerr=TWO_SIDED_95 * here.std,
        fmt="o",
        color=color,
        markersize=5,
        capsize=3,
        linewidth=1.5,
        zorder=4,
    )


def mark_frequencies(axes: Axes, gsd_m: float | None, top: float) -> None:
    """Axes of an MTF from 0 to 1 c/px: Nyquist, the aliased region, cycles/m when known.

    `top` is the largest value to be drawn; a sharpened image exceeds 1.
    """
    axes.axvspan(metrics.NYQUIST_CPP, 1.0, color=SHADE, linewidth=0, zorder=0)
    axes.axvline(metrics.NYQUIST_CPP, color=INK, linewidth=1, dashes=(5, 3))
    for text, place, height in (
        ("Nyquist", metrics.NYQUIST_CPP - 0.012, 0.955),
        ("aliased", 0.985, 0.55),
    ):
        axes.text(
            place,
            height,
            text,
            transform=axes.get_xaxis_transform(),
            ha="right",
            va="top",
            color=FAINT,
            fontsize=8.5,
        )
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.05 * max(1.0, top)))
    axes.set(xlabel="frequency [cycles/pixel]", ylabel="MTF")
    if gsd_m is not None:
        second = axes.secondary_xaxis("top", functions=(_scaling(1.0 / gsd_m), _scaling(gsd_m)))
        second.set_xlabel("frequency [cycles/m]")


def _scaling(factor: float) -> Callable[[Any], Any]:
    """Multiply by `factor`: one direction of a second axis."""
    return lambda value: np.asarray(value) * factor
