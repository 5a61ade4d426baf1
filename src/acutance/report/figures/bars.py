"""Drawings of bars: where the groups are, their profiles, MTF at their frequencies, residuals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves.metrics import NYQUIST_CPP
from acutance.report.figures.curves import TWO_SIDED_95, band_edges, mark_frequencies
from acutance.report.figures.panel import Panel, on_axes, required
from acutance.report.figures.pixels import draw_residual_map, show_pixels
from acutance.report.labels import write_fixed
from acutance.report.paper import BLUE, FAINT, GREEN, INK, ORANGE, SHADE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.targets.periodic import BarsMeasurement
    from acutance.targets.periodic.bars_measurement import BarsGroup, GroupProfile

__all__ = ["bars_panels"]

MAX_GROUPS = 12
COLUMNS = 4


def bars_panels(measurement: BarsMeasurement) -> tuple[Panel, ...]:
    """MTF along the normal; groups, residuals and profiles where it still has its pixels."""
    along_normal = Panel(
        "MTF along the bars' normal",
        "Line: the joint fit of all groups with its 95 % band. Dots: the plain readings: a "
        "sinusoid over that of the bars, the contrast of the bars (CTF), and the MTF by "
        "Coltman's series from it.",
        on_axes(_draw_mtf, measurement),
    )
    if measurement.details is None:
        return (along_normal,)
    rows = math.ceil(min(len(measurement.groups), MAX_GROUPS) / COLUMNS)
    return (
        Panel(
            "Groups",
            "The outline of every group, with its number and its frequency in cycles per pixel.",
            on_axes(_draw_groups, measurement),
            is_target=True,
        ),
        along_normal,
        Panel(
            "Residuals",
            "Image minus fitted bars, in standard deviations of the noise; grey was not used.",
            on_axes(_draw_residual, measurement),
        ),
        Panel(
            "Profiles",
            "Every pixel of a group at its distance along the normal (dots), and the fit (line): "
            "0 is the background, 1 a wide bar. The bars before the sensor are grey.",
            lambda page: _draw_profiles(page, measurement),
            wide=True,
            height_in=0.4 + 2.5 * rows,
        ),
    )


_ROOM_FOR_LABEL = 0.7
"""Part of the image's width up to which a label stands right of its group."""


def _draw_groups(axes: Axes, measurement: BarsMeasurement) -> None:
    pixels = required(measurement.details).pixels
    show_pixels(axes, pixels, *measurement.image.roi[:2])
    last = measurement.image.roi[1] + _ROOM_FOR_LABEL * pixels.shape[1]
    for number, group in enumerate(measurement.groups, start=1):
        rows, cols = group.bars.region.T
        axes.fill(cols, rows, facecolor="none", edgecolor=ORANGE, linewidth=1.2)
        # In a box a label is legible on bars and on a background; it stays inside the image.
        inside = float(cols.max()) > last
        axes.annotate(
            f"{number}: {group.freq_cpp:.3g}", (float(cols.max()), float(rows.mean())),
            (-4 if inside else 4, 0), textcoords="offset points", ha="right" if inside else "left",
            fontsize=7, color="white", va="center", fontweight="bold",
            bbox={"boxstyle": "round,pad=0.15", "facecolor": VERMILION, "edgecolor": "none"},
        )  # fmt: skip
    # In two lines: a map of bars is often narrow, and a panel cuts off what is wider.
    axes.set_title(f"{len(measurement.groups)} groups of bars\n(number: cycles per pixel)")


def _draw_mtf(axes: Axes, measurement: BarsMeasurement) -> None:
    response = measurement.normal_response
    mtf = response.mtf
    low, high = band_edges(mtf.value, mtf.std)
    groups = [one for one in measurement.groups if measurement.is_first_direction(one)]
    highest = [float(high.max()), *(one.reading.ctf for one in groups)]
    mark_frequencies(axes, response.gsd_m, 1.02 * float(np.nanmax(highest)))
    axes.fill_between(mtf.freq_cpp, low, high, color=BLUE, alpha=0.25, linewidth=0)
    axes.plot(mtf.freq_cpp, mtf.value, color=BLUE, label="joint fit")
    freq = [one.freq_cpp for one in groups]
    axes.errorbar(
        freq, [one.reading.modulation for one in groups],
        yerr=[TWO_SIDED_95 * one.reading.modulation_std for one in groups],
        fmt="o", color=INK, markersize=3.5, linewidth=0.9, label="sinusoid", zorder=3,
    )  # fmt: skip
    axes.plot(
        freq, [one.reading.ctf for one in groups], "s", color=ORANGE, markersize=4, label="CTF"
    )
    axes.plot(
        freq, [one.coltman for one in groups], "x", color=VERMILION, markersize=5,
        label="Coltman",
    )  # fmt: skip
    axes.set_title(f"MTF along the normal, {write_fixed(measurement.directions_deg[0], 1)}°")
    axes.legend(loc="lower left")


def _draw_residual(axes: Axes, measurement: BarsMeasurement) -> None:
    details = required(measurement.details)
    noise = max(details.noise, 1e-9 * abs(measurement.contrast.value))
    draw_residual_map(
        axes, required(measurement.details).residual / noise, *measurement.image.roi[:2]
    )


def _draw_profiles(page: FigureBase, measurement: BarsMeasurement) -> None:
    shown = measurement.groups[:MAX_GROUPS]
    rows = math.ceil(len(shown) / COLUMNS)
    grid = page.subplots(rows, COLUMNS, squeeze=False, sharey=True)
    for axes in grid.flat[len(shown) :]:
        axes.axis("off")
    for number, (axes, group) in enumerate(zip(grid.flat, shown, strict=False), start=1):
        _draw_profile(axes, group, required(measurement.details).profiles[number - 1], number)
        if number > len(shown) - COLUMNS:
            axes.set_xlabel("distance along the normal [px]")
    more = len(measurement.groups) - len(shown)
    page.suptitle(
        "Profiles of the groups" + (f" ({more} more not shown)" if more else ""),
        x=0.012, ha="left", fontsize=11, fontweight="bold",
    )  # fmt: skip


def _draw_profile(axes: Axes, group: BarsGroup, profile: GroupProfile, number: int) -> None:
    bars = group.bars
    for place in bars.places_px.tolist():
        axes.axvspan(
            place - 0.25 * bars.period_px, place + 0.25 * bars.period_px, color=SHADE, zorder=0
        )
    axes.plot(profile.across_px, profile.value, ".", color=FAINT, markersize=2.2, rasterized=True)
    order = np.argsort(profile.across_px)
    axes.plot(profile.across_px[order], profile.fitted[order], color=BLUE, linewidth=1.3)
    aliased = group.freq_cpp > NYQUIST_CPP
    axes.set_title(
        f"{number}: {group.freq_cpp:.3f} c/px, MTF {group.mtf.value:.3f}"
        + (" (aliased)" if aliased else ""),
        fontsize=8.5, color=GREEN if aliased else INK,
    )  # fmt: skip
