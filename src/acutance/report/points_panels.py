"""Drawings of point sources: where they are, their phases, each with its fit, the PSF's surface."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.page import BLUE, FAINT, INK, ORANGE, VERMILION
from acutance.report.panels import show_pixels
from acutance.report.plane_panels import PlanePanel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.targets.points import PointsMeasurement
    from acutance.targets.points.sources import PointSource

__all__ = ["points_panels"]

MOST_SHOWN = 20
GALLERY_COLUMNS = 10
MOST_NAMED = 40
MOST_REJECTED_SHOWN = 40


def points_panels(measurement: PointsMeasurement) -> tuple[PlanePanel, ...]:
    """What a measurement of points adds to its page: map, phases, surface, gallery, residuals."""
    panels = [
        PlanePanel(
            "Sources",
            "Circles: the sources measured, counted from 1. Crosses: what was rejected.",
            lambda page: _draw_places(page.subplots(), measurement),
        ),
        PlanePanel(
            "Sub-pixel phases",
            "Where each source lies within its pixel; evenly spread phases sample the PSF best.",
            lambda page: _draw_phases(page.subplots(), measurement),
        ),
        PlanePanel(
            "PSF surface",
            "Light of a point with the pixel's area included, as a share of its peak.",
            lambda page: _draw_surface(page, measurement),
        ),
    ]
    if measurement.survey is not None:
        panels.append(
            PlanePanel(
                "Measured against surveyed places",
                "Measured less surveyed, after one common shift.",
                lambda page: _draw_survey(page.subplots(), measurement),
            )
        )
    if measurement.published is not None:
        panels.append(
            PlanePanel(
                "Aligned samples",
                "The pixels of all sources moved onto one another, and the Gaussian through them.",
                lambda page: _draw_aligned(page, measurement),
            )
        )
    rows = math.ceil(min(len(measurement.sources), MOST_SHOWN) / GALLERY_COLUMNS)
    panels.append(
        PlanePanel(
            "Gallery",
            "Each source (upper) with what the fit leaves of it (lower; blue to red is minus to "
            "plus five standard deviations of the noise).",
            lambda page: _draw_gallery(page, measurement),
            wide=True,
            height_in=0.5 + 2.7 * rows,
        )
    )
    return tuple(panels)


def _draw_places(axes: Axes, measurement: PointsMeasurement) -> None:
    row, col = measurement.image.roi[:2]
    stretched = np.arcsinh(
        (measurement.pixels - np.nanmedian(measurement.pixels))
        / max(float(np.median([one.peak for one in measurement.sources])) / 20, 1e-300)
    )
    show_pixels(axes, stretched, row, col)
    places = measurement.positions
    axes.plot(
        places[:, 1], places[:, 0], "o", markersize=9, markerfacecolor="none",
        markeredgecolor=ORANGE, markeredgewidth=1.2,
    )  # fmt: skip
    if len(places) <= MOST_NAMED:
        for number, (down, right) in enumerate(places.tolist(), start=1):
            axes.annotate(
                str(number), (right, down), (6, 3), textcoords="offset points", fontsize=7,
                color=ORANGE,
            )  # fmt: skip
    plain = [one for one in measurement.rejected if one.reason != "faint"]
    for one in plain[:MOST_REJECTED_SHOWN]:
        axes.plot(one.col, one.row, "x", markersize=6, color=VERMILION, markeredgewidth=1.3)
        if len(plain) <= MOST_NAMED // 2:
            axes.annotate(
                one.reason, (one.col, one.row), (5, -8), textcoords="offset points", fontsize=6.5,
                color=VERMILION,
            )  # fmt: skip
    axes.set_title(f"{len(places)} sources, {len(measurement.rejected)} rejected")


def _draw_phases(axes: Axes, measurement: PointsMeasurement) -> None:
    phases = np.array([one.phase for one in measurement.sources])
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=FAINT, lw=1)
    axes.errorbar(
        phases[:, 1], phases[:, 0],
        xerr=[one.col.std for one in measurement.sources],
        yerr=[one.row.std for one in measurement.sources],
        fmt="o", color=BLUE, markersize=4.5, linewidth=1,
    )  # fmt: skip
    if len(phases) <= MOST_NAMED:
        for number, (down, right) in enumerate(phases.tolist(), start=1):
            axes.annotate(
                str(number), (right, down), (4, 3), textcoords="offset points", fontsize=7,
                color=INK,
            )  # fmt: skip
    axes.set(
        xlim=(-0.58, 0.58), ylim=(0.58, -0.58), aspect="equal",
        xlabel="across, from the pixel's centre [px]",
        ylabel="along [px]", title="Sub-pixel phases",
    )  # fmt: skip


def _draw_surface(page: FigureBase, measurement: PointsMeasurement) -> None:
    axes: Any = page.subplots(subplot_kw={"projection": "3d"})
    distance, psf = measurement.psf(3.0, 0.15)
    x, y = np.meshgrid(distance, distance)
    axes.plot_surface(x, y, psf / psf.max(), cmap="Blues", edgecolor=INK, linewidth=0.15)
    axes.set(xlabel="across [px]", ylabel="along [px]", title="PSF, share of its peak")
    axes.tick_params(labelsize=7)


def _draw_survey(axes: Axes, measurement: PointsMeasurement) -> None:
    survey = measurement.survey
    assert survey is not None
    errors, unit = survey.errors_cm, "cm"
    if errors is None:
        errors, unit = (survey.across_px, survey.along_px), "px"
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(0.0, color=FAINT, linewidth=0.8)
    axes.plot(*errors, "o", color=BLUE, markersize=4.5)
    for number, right, down in zip(survey.point.tolist(), *errors, strict=True):
        axes.annotate(
            str(number + 1), (right, down), (4, 3), textcoords="offset points", fontsize=7
        )
    across, along = survey.rmse_cm or survey.rmse_px
    reach = 1.25 * max(float(np.abs(np.concatenate(errors)).max()), 1e-6)
    axes.set(
        xlim=(-reach, reach), ylim=(reach, -reach), aspect="equal",
        xlabel=f"across [{unit}]", ylabel=f"along [{unit}]",
        title=f"Less surveyed: rms {across:.3g}, {along:.3g} {unit}",
    )  # fmt: skip


def _draw_aligned(page: FigureBase, measurement: PointsMeasurement) -> None:
    found = measurement.published
    assert found is not None
    for axes, places, other, sigma, name in (
        (part, *rest)
        for part, rest in zip(
            page.subplots(2, 1, sharex=True),
            (
                (found.x, found.y, found.psf.sigma_x_px, "across"),
                (found.y, found.x, found.psf.sigma_y_px, "along"),
            ),
            strict=True,
        )
    ):
        near = np.abs(other) < 0.35
        grid = np.linspace(-2.6, 2.6, 201)
        axes.plot(places[near], found.value[near], ".", color=FAINT, markersize=4)
        axes.plot(grid, np.exp(-0.5 * (grid / sigma) ** 2), color=BLUE)
        axes.set_ylabel(name)
        axes.set_title(f"σ {name} {sigma:.3f} px")
    axes.set_xlabel("distance from the fitted peak [px]")


def _draw_gallery(page: FigureBase, measurement: PointsMeasurement) -> None:
    shown = measurement.sources[:MOST_SHOWN]
    lines = math.ceil(len(shown) / GALLERY_COLUMNS)
    grid = page.subplots(2 * lines, GALLERY_COLUMNS, squeeze=False)
    noise = _noise(measurement)
    for axes in grid.flat:
        axes.axis("off")
    for number, one in enumerate(shown):
        line, column = divmod(number, GALLERY_COLUMNS)
        upper, lower = grid[2 * line, column], grid[2 * line + 1, column]
        _draw_stamp(upper, one, number + 1)
        lower.imshow(
            one.residual, cmap="RdBu_r", vmin=-5 * noise, vmax=5 * noise, interpolation="nearest"
        )
    more = len(measurement.sources) - len(shown)
    page.suptitle(
        "Sources and what the fit leaves of them" + (f" ({more} more not shown)" if more else ""),
        x=0.012, ha="left", fontsize=11, fontweight="bold",
    )  # fmt: skip


def _noise(measurement: PointsMeasurement) -> float:
    if measurement.fit is not None:
        return max(measurement.fit.noise, 1e-300)
    return measurement.published.noise_std if measurement.published is not None else 1.0


def _draw_stamp(axes: Axes, one: PointSource, number: int) -> None:
    pixels: Floats = one.pixels
    axes.imshow(
        pixels, cmap="gray", interpolation="nearest",
        vmin=one.background.value - 0.1 * one.peak, vmax=one.background.value + one.peak,
    )  # fmt: skip
    down, right = one.row.value - one.origin[0], one.col.value - one.origin[1]
    axes.plot(right, down, "+", color=ORANGE, markersize=7, markeredgewidth=1.0)
    axes.set_title(f"{number}: SNR {one.snr:.0f}", fontsize=8, fontweight="normal", loc="center")
