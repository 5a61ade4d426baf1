"""Figures of the page on conventions, and of the systems used throughout."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc

import acutance as ac
from acutance.report.paper import BLUE, FAINT, GREEN, INK, ORANGE, PALETTE, VERMILION, new_page

__all__ = ["metrics_on_curves", "pixel_grid", "reference_systems"]

_SHARP = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])


def pixel_grid() -> Figure:
    """How pixels are counted, and what normal, angle and orientation are."""
    figure = new_page(10.4, 4.0)
    counting, across, along = figure.subplots(1, 3, width_ratios=(1.0, 1.1, 1.1))
    _draw_counting(counting)
    _draw_edge(across, 20.0, "across")
    _draw_edge(along, 20.0, "along")
    return figure


def _draw_counting(axes: Axes) -> None:
    axes.set_title("Counting pixels")
    for place in np.arange(-0.5, 4):
        axes.plot([place, place], [-0.5, 3.5], color=FAINT, lw=0.8)
        axes.plot([-0.5, 3.5], [place, place], color=FAINT, lw=0.8)
    for row in range(4):
        for col in range(4):
            axes.plot(col, row, "o", ms=4, color=BLUE)
            axes.text(
                col, row + 0.13, f"({row}, {col})", ha="center", va="top", color=BLUE, fontsize=9
            )
    axes.plot(-0.5, -0.5, "s", ms=8, color=VERMILION, clip_on=False)
    axes.text(-0.5, -1.08, "blue: (row, column) of pixel centres", color=BLUE, va="center")
    axes.text(-0.5, -0.78, "red: x = 0, y = 0 of GDAL", color=VERMILION, va="center")
    axes.set(xlim=(-0.6, 3.6), ylim=(3.6, -1.25), aspect="equal")
    axes.set_xlabel("column, x →")
    axes.set_ylabel("← row, y (down)")
    axes.set_xticks(range(4))
    axes.set_yticks(range(4))
    axes.grid(False)
    axes.spines[:].set_visible(False)


def _draw_edge(axes: Axes, angle_deg: float, orientation: str) -> None:
    """A simulated edge with its normal, its angle and the distance of one pixel."""
    size = 15
    middle = (size - 1) / 2
    image, truth = ac.simulate.edge(
        _SHARP, angle_deg=angle_deg, orientation=orientation, shape=(size, size),
        dark=0.35, bright=0.95,
    )  # fmt: skip
    axes.imshow(image, cmap="gray", vmin=0, vmax=1)
    line = truth.line
    x, y = line.normal
    reach = 7.0
    axes.plot(
        [line.col - reach * y, line.col + reach * y],
        [line.row + reach * x, line.row - reach * x],
        color=VERMILION, lw=2,
    )  # fmt: skip
    axes.annotate(
        "", (line.col + 4.2 * x, line.row + 4.2 * y), (line.col, line.row),
        arrowprops={"arrowstyle": "-|>", "color": BLUE, "lw": 2.2, "mutation_scale": 16},
    )  # fmt: skip
    axes.text(line.col + 5.1 * x, line.row + 5.1 * y, "n", color=BLUE, fontsize=13, weight="bold",
              ha="center", va="center")  # fmt: skip
    # The image axis the edge is near to, and the angle between them.
    if orientation == "across":
        axes.plot([middle, middle], [middle, middle - 6.6], color=INK, lw=1, ls=(0, (4, 3)))
        start, stop = 270.0, 270.0 + angle_deg
    else:
        axes.plot([middle, middle - 6.6], [middle, middle], color=INK, lw=1, ls=(0, (4, 3)))
        start, stop = 180.0, 180.0 + angle_deg
    axes.add_patch(Arc((middle, middle), 10, 10, theta1=start, theta2=stop, color=INK, lw=1.4))
    half = math.radians((start + stop) / 2)
    axes.text(middle + 5.9 * math.cos(half), middle + 5.9 * math.sin(half), f"{angle_deg:.0f}°",
              ha="center", va="center", fontsize=9.5)  # fmt: skip
    row, col = (11, 12) if orientation == "across" else (12, 12)
    s = float(line.normal_distance(row, col))
    axes.plot(col, row, "o", ms=5, color=GREEN)
    axes.plot([col, col - s * x], [row, row - s * y], color=GREEN, lw=1.6)
    if orientation == "across":
        place = {"x": col, "y": row + 0.9, "ha": "center"}
    else:
        place = {"x": col - 0.5, "y": row + 0.3, "ha": "right"}
    axes.text(s=f"s = {s:.1f} px", color=GREEN, va="center", **place)
    axes.set_title(f"{orientation}: angle {line.angle_deg:.0f}°, θ = {line.normal_deg:.0f}°")
    axes.set_xlabel("column, x →")
    axes.set_ylabel("← row, y (down)")
    axes.set_xticks(range(0, size, 2))
    axes.set_yticks(range(0, size, 2))
    axes.grid(False)


def metrics_on_curves() -> Figure:
    """Every number shown on the curve it is read from."""
    sensor = ac.simulate.reference_systems()["sharpened"]
    truth = sensor.response()
    figure = new_page(10.4, 4.0)
    left, middle, right = figure.subplots(1, 3)
    _draw_esf_numbers(left, truth)
    _draw_lsf_numbers(middle, truth)
    _draw_mtf_numbers(right, truth)
    return figure


def _draw_esf_numbers(axes: Axes, truth: ac.Response) -> None:
    x, y = truth.esf.distance_px, truth.esf.value
    near = np.abs(x) <= 4
    axes.plot(x[near], y[near], color=INK)
    low, high = truth.esf(-0.5).value, truth.esf(0.5).value
    axes.plot([-0.5, 0.5], [low, high], "o", ms=5, color=BLUE)
    axes.vlines([-0.5, 0.5], [low, low], [low, high], color=BLUE, lw=1, ls=":")
    axes.annotate("", (0.5, high), (0.5, low), arrowprops={"arrowstyle": "<->", "color": BLUE})
    axes.hlines(low, -0.5, 0.5, color=BLUE, lw=1, ls=":")
    axes.text(0.66, 0.42, f"RER {truth.rer.value:.3f}", color=BLUE)
    top = float(x[np.argmax(y)])
    axes.annotate(
        f"overshoot {truth.overshoot.value:.3f}", (top, y.max()), (1.1, 1.16), color=VERMILION,
        arrowprops={"arrowstyle": "-", "color": VERMILION, "lw": 0.8}, va="center",
    )  # fmt: skip
    bottom = float(x[np.argmin(y)])
    axes.annotate(
        f"undershoot {truth.undershoot.value:.3f}", (bottom, y.min()), (-3.9, -0.16),
        color=VERMILION, arrowprops={"arrowstyle": "-", "color": VERMILION, "lw": 0.8}, va="center",
    )  # fmt: skip
    extent = truth.half_extent_bright_px.value
    axes.plot([0, extent], [0.95, 0.95], color=GREEN, lw=1.4)
    axes.plot([0, 0], [0.5, 0.95], color=GREEN, lw=0.8, ls=":")
    axes.text(-0.15, 0.95, f"half extent\n50-95 %: {extent:.2f} px", color=GREEN, ha="right",
              va="center")  # fmt: skip
    axes.plot(0, 0.5, "o", ms=5, color=INK)
    axes.set(
        title="ESF", xlabel="normal distance s, px", ylabel="edge response", ylim=(-0.25, 1.25)
    )


def _draw_lsf_numbers(axes: Axes, truth: ac.Response) -> None:
    x, y = truth.lsf.distance_px, truth.lsf.value
    near = np.abs(x) <= 4
    axes.plot(x[near], y[near], color=INK)
    width = truth.fwhm_px.value
    axes.annotate("", (-width / 2, y.max() / 2), (width / 2, y.max() / 2),
                  arrowprops={"arrowstyle": "<->", "color": BLUE})  # fmt: skip
    axes.text(width / 2 + 0.15, y.max() / 2, f"FWHM {width:.3f} px", color=BLUE, va="center")
    axes.axhline(0, color=FAINT, lw=0.8)
    axes.set(title="LSF", xlabel="normal distance s, px", ylabel="line response, 1/px")


def _draw_mtf_numbers(axes: Axes, truth: ac.Response) -> None:
    f, m = truth.mtf.freq_cpp, truth.mtf.value
    axes.plot(f, m, color=INK)
    inside = f <= 0.5
    axes.fill_between(f[inside], 0, m[inside], color=ORANGE, alpha=0.22, lw=0)
    axes.text(0.2, 0.35, f"area {truth.mtf_area.value:.3f}", color="#8a5d00", ha="center")
    nyquist = truth.mtf_nyquist.value
    axes.plot(0.5, nyquist, "o", color=BLUE, ms=5)
    axes.text(0.52, nyquist + 0.07, f"MTF at Nyquist {nyquist:.3f}", color=BLUE, va="center")
    for level, number in ((0.3, truth.mtf30_cpp.value),):
        axes.plot(number, level, "o", color=GREEN, ms=5)
        axes.text(number + 0.02, level + 0.03, f"MTF30 {number:.3f} c/px", color=GREEN)
    axes.set(title="MTF", xlabel="frequency, cycles per pixel", ylabel="modulus of the OTF",
             xlim=(0, 1), ylim=(0, 1.1))  # fmt: skip


def reference_systems() -> Figure:
    """True MTF and LSF of the systems that tests, benchmarks and pages share."""
    figure = new_page(10.4, 4.3)
    left, right = figure.subplots(1, 2)
    marks = ("-", "--")
    for i, (name, sensor) in enumerate(ac.simulate.reference_systems().items()):
        truth = sensor.response()
        style = {"color": PALETTE[i % len(PALETTE)], "ls": marks[i // len(PALETTE)], "label": name}
        left.plot(truth.mtf.freq_cpp, truth.mtf.value, **style)
        near = np.abs(truth.lsf.distance_px) <= 4
        right.plot(truth.lsf.distance_px[near], truth.lsf.value[near], **style)
    left.axvline(0.5, color=FAINT, lw=0.8)
    left.text(0.505, 1.1, "Nyquist", color=FAINT, va="top")
    left.set(title="MTF", xlabel="frequency, cycles per pixel", ylabel="MTF", xlim=(0, 1),
             ylim=(0, 1.12))  # fmt: skip
    left.legend(loc="upper right")
    right.set(title="LSF", xlabel="normal distance, px", ylabel="1/px")
    return figure
