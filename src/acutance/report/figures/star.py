"""Drawings of a star: where it is, its aliased centre, MTF against radius and over directions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.report.figures.curves import TWO_SIDED_95, band_edges
from acutance.report.figures.panel import Panel, on_axes, required
from acutance.report.figures.pixels import draw_residual_map, show_pixels
from acutance.report.paper import BLUE, FAINT, GREEN, INK, ORANGE, SHADE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.targets.periodic import StarMeasurement

__all__ = ["star_panels"]

POLAR_CPP = 0.7
LEVELS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
FREQS_CPP = {0.25: BLUE, 0.5: VERMILION}
ROOM = 1.4
"""How much of the surroundings of the aliased centre is drawn with it."""


def star_panels(measurement: StarMeasurement) -> tuple[Panel, ...]:
    """MTF by radius and direction; the star and residuals where it still has its pixels."""
    pixels = () if measurement.details is None else _pixel_panels(measurement)
    return (*pixels, *_curve_panels(measurement))


def _pixel_panels(measurement: StarMeasurement) -> tuple[Panel, ...]:
    return (
        Panel(
            "Star",
            "Pixels between the orange circles were used. Inside the red curve the spokes are "
            "finer than two pixels across or along: what is seen there is aliased.",
            on_axes(_draw_star, measurement),
            is_target=True,
        ),
        Panel(
            "Centre of the star",
            "The aliased part: its spokes seem to be coarser than they are. The fit knows what "
            "sampling does and uses them all the same.",
            on_axes(_draw_centre, measurement),
        ),
        Panel(
            "Residuals",
            "Image minus fitted star, in standard deviations of the noise.",
            on_axes(_draw_residual, measurement),
        ),
    )


def _curve_panels(measurement: StarMeasurement) -> tuple[Panel, ...]:
    return (
        Panel(
            "MTF against radius",
            "Dots: a sinusoid fitted to every ring of pixels. Line: the joint fit's mean over the "
            "directions with its 95 % band. Grey: no spokes were used there.",
            on_axes(_draw_radii, measurement),
        ),
        Panel(
            "MTF by direction and frequency",
            "Distance from the middle is frequency up to 0.7 c/px, the angle the direction "
            "across the spokes (0: along the rows, 90: down the columns). Red: Nyquist. Dashed: "
            "the range of the spokes used. Grey: directions the star does not hold.",
            lambda page: _draw_polar(
                page.subplots(subplot_kw={"projection": "polar"}), measurement
            ),
        ),
        Panel(
            "MTF by direction",
            "At half of Nyquist and at Nyquist, with 95 % bands.",
            on_axes(_draw_directions, measurement),
        ),
    )


def _draw_star(axes: Axes, measurement: StarMeasurement) -> None:
    star = measurement.star
    show_pixels(axes, required(measurement.details).pixels, *measurement.image.roi[:2])
    low, high = measurement.reach_cpp
    for freq in (low, high):
        _draw_circle(axes, measurement, star.radius_at(freq))
    axes.plot(*_aliased_curve(measurement), color=VERMILION, linewidth=1.3)
    axes.plot(star.col, star.row, "+", color=BLUE, markersize=9, markeredgewidth=1.6)
    axes.set_title(f"Star of {star.cycles} cycles")


def _draw_circle(axes: Axes, measurement: StarMeasurement, radius: float) -> None:
    star = measurement.star
    angle = np.radians(star.first_deg + np.linspace(0.0, star.sweep_deg, 361))
    axes.plot(
        star.col + radius * np.cos(angle), star.row + radius * np.sin(angle),
        color=ORANGE, linewidth=1.3,
    )  # fmt: skip


def _aliased_curve(measurement: StarMeasurement) -> tuple[Floats, Floats]:
    """Columns and rows of the places where spokes reach 0.5 c/px across or along."""
    star = measurement.star
    angle = np.radians(star.first_deg + np.linspace(0.0, star.sweep_deg, 721))
    # The frequency of a spoke points at right angles to it.
    steepest = np.maximum(np.abs(np.sin(angle)), np.abs(np.cos(angle)))
    radius = star.radius_at(NYQUIST_CPP) * steepest
    return star.col + radius * np.cos(angle), star.row + radius * np.sin(angle)


def _draw_centre(axes: Axes, measurement: StarMeasurement) -> None:
    star = measurement.star
    show_pixels(axes, required(measurement.details).pixels, *measurement.image.roi[:2])
    axes.plot(*_aliased_curve(measurement), color=VERMILION, linewidth=1.5)
    axes.plot(star.col, star.row, "+", color=BLUE, markersize=9, markeredgewidth=1.6)
    half = ROOM * measurement.nyquist_px
    row, col, height, width = measurement.image.roi
    axes.set(
        xlim=(max(star.col - half, col - 0.5), min(star.col + half, col + width - 0.5)),
        ylim=(min(star.row + half, row + height - 0.5), max(star.row - half, row - 0.5)),
        title=f"Aliased within {measurement.nyquist_px:.1f} px",
    )


def _draw_residual(axes: Axes, measurement: StarMeasurement) -> None:
    details = required(measurement.details)
    noise = max(details.noise, 1e-9 * measurement.level.value)
    draw_residual_map(
        axes, required(measurement.details).residual / noise, *measurement.image.roi[:2]
    )


def _draw_radii(axes: Axes, measurement: StarMeasurement) -> None:
    star, rings, mtf = measurement.star, measurement.rings, measurement.mean_mtf
    lowest, highest = measurement.reach_cpp
    outer, inner = star.radius_at(lowest), star.radius_at(highest)
    freq = mtf.freq_cpp[1:]
    radius = star.radius_at(1.0) / freq
    low, high = band_edges(mtf.value[1:], mtf.std[1:])
    axes.fill_between(radius, low, high, color=BLUE, alpha=0.25, linewidth=0)
    axes.plot(radius, mtf.value[1:], color=BLUE, label="joint fit, mean over directions")
    axes.errorbar(
        star.radius_at(1.0) / rings.freq_cpp, rings.modulation, yerr=TWO_SIDED_95 * rings.std,
        fmt=".", color=INK, markersize=3.5, linewidth=0.8, label="rings", zorder=3,
    )  # fmt: skip
    right = 1.06 * outer
    axes.axvspan(0.0, inner, color=SHADE, zorder=0)
    axes.axvspan(outer, right, color=SHADE, zorder=0)
    axes.axvline(measurement.nyquist_px, color=VERMILION, linewidth=1.2)
    top = max(1.08, 1.05 * float(np.max(high[radius > inner])))
    axes.text(
        measurement.nyquist_px, 0.98 * top, " 0.5 c/px", color=VERMILION, va="top", fontsize=8
    )
    axes.set(xlim=(0.0, right), ylim=(min(0.0, float(low.min())), top))
    axes.set(xlabel="radius [px]", ylabel="MTF", title="MTF against radius")
    axes.legend(loc="lower right")


def _draw_polar(axes: Any, measurement: StarMeasurement) -> None:
    angle = np.radians(np.linspace(0.0, 360.0, 181))
    freq = np.linspace(0.0, POLAR_CPP, 71)
    grid_angle, grid_freq = np.meshgrid(angle, freq)
    u, v = grid_freq * np.cos(grid_angle), grid_freq * np.sin(grid_angle)
    mtf = np.abs(measurement.otf.model.otf(u.ravel(), v.ravel())).reshape(u.shape)
    top = max(1.0, float(mtf.max()))
    # Directions turn as in the image: rows go downwards.
    axes.set_theta_direction(-1)
    axes.pcolormesh(
        grid_angle, grid_freq, np.sqrt(mtf), cmap="Blues", vmin=0.0, vmax=1.35 * math.sqrt(top),
        shading="gouraud", rasterized=True,
    )  # fmt: skip
    lines = axes.contour(grid_angle, grid_freq, mtf, LEVELS, colors=[INK], linewidths=0.9)
    axes.clabel(lines, fmt="%g", fontsize=7)
    steepest = np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    axes.plot(angle, NYQUIST_CPP / steepest, color=VERMILION, linewidth=1.2)
    for one in measurement.reach_cpp:
        if one < POLAR_CPP:
            axes.plot(angle, np.full(angle.size, one), color=GREEN, linestyle="--", linewidth=1.1)
    _shade_unmeasured(axes, measurement)
    axes.set_ylim(0.0, POLAR_CPP)
    axes.set_yticks([0.25, 0.5], ["0.25", "0.5"], fontsize=7.5)
    axes.set_title("MTF by direction and frequency", pad=14)
    axes.grid(color=FAINT, alpha=0.35)


def _shade_unmeasured(axes: Any, measurement: StarMeasurement) -> None:
    """Directions across no spoke: those of a star of less than half a turn, and their opposite."""
    sweep = measurement.star.sweep_deg
    if sweep >= 180:
        return
    end = measurement.star.first_deg + 90 + sweep
    for start in (end, end + 180):
        span = np.radians(np.linspace(start, start + 180 - sweep, 61))
        axes.fill_between(span, 0.0, POLAR_CPP, color=SHADE, alpha=0.75, linewidth=0)


def _draw_directions(axes: Axes, measurement: StarMeasurement) -> None:
    held = measurement.directions_deg
    middle = float(np.mean(held))
    angle = np.asarray(np.linspace(middle - 90.0, middle + 90.0, 73))
    highest = 0.0
    for freq, color in FREQS_CPP.items():
        value, std = measurement.mtf_by_direction(freq, angle)
        low, high = band_edges(value, std)
        axes.fill_between(angle, low, high, color=color, alpha=0.25, linewidth=0)
        axes.plot(angle, value, color=color, label=f"{freq:g} c/px")
        inside = np.abs(angle - middle) <= 0.5 * min(measurement.star.sweep_deg, 180.0)
        highest = max(highest, float(high[inside].max()))
    half = 0.5 * min(measurement.star.sweep_deg, 180.0)
    if half < 90:
        axes.axvspan(middle - 90, middle - half, color=SHADE, zorder=0)
        axes.axvspan(middle + half, middle + 90, color=SHADE, zorder=0)
    axes.set(
        xlim=(middle - 90, middle + 90), ylim=(0.0, 1.25 * highest),
        xlabel="direction across the spokes [deg]", ylabel="MTF", title="MTF by direction",
    )  # fmt: skip
    axes.legend(loc="upper right", ncols=2)
