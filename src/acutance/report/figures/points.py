"""Drawings of point sources: where they are, their phases, each with its fit, the PSF's surface."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.geometry.line import axis_names
from acutance.report.figures.curves import axis_labels
from acutance.report.figures.labels_apart import labels_apart
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.figures.pixels import show_pixels
from acutance.report.paper import BLUE, FAINT, INK, ORANGE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.targets.points import PointsMeasurement
    from acutance.targets.points.detect import RejectedSpot
    from acutance.targets.points.sources import PointSource, SourceStamp

__all__ = ["points_panels"]

MAX_SHOWN = 20
GALLERY_COLUMNS = 10
MAX_NAMED = 40
MAX_REJECTED_SHOWN = 40
LABEL_STEP = 0.055
"""Of a number to its point, over half the width of the axes."""
LABEL_SIDES = ((1, -0.6), (-1, -0.6), (1, 0.8), (-1, 0.8), (0, -1), (0, 1))
"""Where a number may stand, in such steps; rows go downwards."""
NAME_PT = (50.0, 10.0)
"""Width and height of the reason beside a cross."""
BOX_PT = (12.5, 10.0)
"""Width and height of a number in its box, on the map."""
BOX_SIDES = ((1.15, 0), (-1.15, 0), (0, -1.15), (0, 1.15), (0.9, -0.8), (-0.9, -0.8), (0.9, 0.8),
             (-0.9, 0.8))  # fmt: skip
"""Where it may stand beside its circle, in widths and heights."""


def points_panels(measurement: PointsMeasurement) -> tuple[Panel, ...]:
    """Phases, PSF and survey; map and gallery where it still has its pixels."""
    details = measurement.details
    panels = [
        Panel(
            "Sub-pixel phases",
            "Where each source lies within its pixel; evenly spread phases sample the PSF best.",
            on_axes(_draw_phases, measurement),
        ),
        Panel(
            "PSF surface",
            "Light of a point with the pixel's area included, as a share of its peak.",
            lambda page: _draw_surface(page, measurement),
        ),
    ]
    if measurement.survey is not None:
        panels.append(
            Panel(
                "Measured against surveyed places",
                "Measured minus surveyed, after one common shift.",
                on_axes(_draw_survey, measurement),
            )
        )
    if details is None:
        return tuple(panels)
    panels.insert(0, _map_panel(measurement))
    if details.published is not None:
        panels.append(
            Panel(
                "Aligned samples",
                "The pixels of all sources moved onto one another, and the Gaussian through them.",
                lambda page: _draw_aligned(page, measurement),
            )
        )
    return (*panels, _gallery_panel(measurement))


def _map_panel(measurement: PointsMeasurement) -> Panel:
    counted = ", counted from 1" if len(measurement.sources) <= MAX_NAMED else ""
    return Panel(
        "Sources",
        f"Circles: the sources measured{counted}. Crosses: what was rejected, for another reason "
        "than being faint.",
        on_axes(_draw_places, measurement),
        is_target=True,
    )


def _gallery_panel(measurement: PointsMeasurement) -> Panel:
    rows = math.ceil(min(len(measurement.sources), MAX_SHOWN) / GALLERY_COLUMNS)
    return Panel(
        "Gallery",
        "Each source (upper) with the residuals of the fit (lower; blue to red is minus to plus "
        "five standard deviations of the noise).",
        lambda page: _draw_gallery(page, measurement),
        wide=True,
        height_in=0.5 + 2.7 * rows,
    )


def _draw_places(axes: Axes, measurement: PointsMeasurement) -> None:
    row, col = measurement.image.roi[:2]
    stretched = np.arcsinh(
        (measurement.details.pixels - np.nanmedian(measurement.details.pixels))
        / max(float(np.median([one.peak for one in measurement.sources])) / 20, 1e-300)
    )
    show_pixels(axes, stretched, row, col)
    places = measurement.positions
    axes.plot(
        places[:, 1], places[:, 0], "o", markersize=9, markerfacecolor="none",
        markeredgecolor=ORANGE, markeredgewidth=1.2,
    )  # fmt: skip
    plain = [one for one in measurement.rejected if one.reason != "faint"]
    if len(places) <= MAX_NAMED:
        crosses = np.array([(one.row, one.col) for one in plain], float).reshape(-1, 2)
        _number_sources(axes, places, crosses)
    for one in plain[:MAX_REJECTED_SHOWN]:
        axes.plot(one.col, one.row, "x", markersize=6, color=VERMILION, markeredgewidth=1.3)
    if len(plain) <= MAX_NAMED // 2:
        _name_rejected(axes, plain)
    axes.set_title(f"{len(places)} sources, {len(measurement.rejected)} rejected")


def _name_rejected(axes: Axes, rejected: Sequence[RejectedSpot]) -> None:
    """The reason beside each cross, but for one whose name would lie over another's."""
    scale_pt = _pt_per_px(axes)
    named: list[RejectedSpot] = []
    for one in rejected:
        if any(
            scale_pt * abs(one.row - other.row) < NAME_PT[1]
            and scale_pt * abs(one.col - other.col) < NAME_PT[0]
            for other in named
        ):
            continue
        named.append(one)
        axes.annotate(
            one.reason, (one.col, one.row), (5, -8), textcoords="offset points", fontsize=6.5,
            color=VERMILION,
        )  # fmt: skip


def _pt_per_px(axes: Axes) -> float:
    """Points of the page per pixel of a map. Pixels are square: one side of the axes limits it."""
    box = axes.get_window_extent()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    scale = min(box.width / abs(right - left), box.height / abs(top - bottom))
    return float(scale * 72 / axes.figure.dpi)


def _number_sources(axes: Axes, places: Floats, crosses: Floats) -> None:
    """Numbers in boxes beside the circles at (row, col), legible on every ground."""
    scale_pt = _pt_per_px(axes)
    size = np.array(BOX_PT)
    found = labels_apart(
        places[:, ::-1] * scale_pt / size, BOX_SIDES, crosses[:, ::-1] * scale_pt / size
    )
    away = found * size - places[:, ::-1] * scale_pt
    for number, (place, (x, y)) in enumerate(zip(places.tolist(), away, strict=True), start=1):
        axes.annotate(
            str(number), (place[1], place[0]), (x, -y), textcoords="offset points", fontsize=7,
            color="white", fontweight="bold", ha="center", va="center",
            bbox={"boxstyle": "round,pad=0.15", "facecolor": VERMILION, "edgecolor": "none"},
        )  # fmt: skip


def _draw_phases(axes: Axes, measurement: PointsMeasurement) -> None:
    phases = np.array([one.phase for one in measurement.sources])
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=FAINT, lw=1)
    axes.errorbar(
        phases[:, 1], phases[:, 0],
        xerr=[one.col.std for one in measurement.sources],
        yerr=[one.row.std for one in measurement.sources],
        fmt="o", color=BLUE, markersize=4.5, linewidth=1,
    )  # fmt: skip
    if len(phases) <= MAX_NAMED:
        for number, (down, right) in enumerate(phases.tolist(), start=1):
            axes.annotate(
                str(number), (right, down), (4, 3), textcoords="offset points", fontsize=7,
                color=INK,
            )  # fmt: skip
    axes.set(
        xlim=(-0.58, 0.58), ylim=(0.58, -0.58), aspect="equal",
        **axis_labels(measurement, "px from the pixel's centre"), title="Sub-pixel phases",
    )  # fmt: skip


def _draw_surface(page: FigureBase, measurement: PointsMeasurement) -> None:
    axes: Any = page.subplots(subplot_kw={"projection": "3d"})
    distance, psf = measurement.psf(3.0, 0.15)
    x, y = np.meshgrid(distance, distance)
    axes.plot_surface(x, y, psf / psf.max(), cmap="Blues", edgecolor=INK, linewidth=0.15)
    axes.set(**axis_labels(measurement, "px"), title="PSF, share of its peak")
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
    across, along = survey.rmse_cm or survey.rmse_px
    reach = 1.25 * max(float(np.abs(np.concatenate(errors)).max()), 1e-6)
    _number_apart(axes, np.column_stack(errors), survey.point.tolist(), reach)
    axes.set(
        xlim=(-reach, reach), ylim=(reach, -reach), aspect="equal",
        xlabel=f"across [{unit}]", ylabel=f"along [{unit}]",
        title=f"Measured − surveyed: rms {across:.2g}, {along:.2g} {unit}",
    )  # fmt: skip


def _number_apart(axes: Axes, places: Floats, points: Sequence[int], reach: float) -> None:
    """Numbers next to points (x, y)."""
    step = LABEL_STEP * reach
    for number, (x, y) in zip(points, labels_apart(places / step, LABEL_SIDES), strict=True):
        axes.text(step * x, step * y, str(number + 1), fontsize=7, ha="center", va="center")


def _draw_aligned(page: FigureBase, measurement: PointsMeasurement) -> None:
    found = measurement.details.published
    assert found is not None
    x_name, y_name = axis_names(measurement.image.along_track)
    for axes, places, other, sigma, name in (
        (part, *rest)
        for part, rest in zip(
            page.subplots(2, 1, sharex=True),
            (
                (found.x, found.y, found.psf.sigma_x_px, x_name),
                (found.y, found.x, found.psf.sigma_y_px, y_name),
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
    shown = measurement.details.stamps[:MAX_SHOWN]
    reach = max(max(one.pixels.shape) for one in shown) // 2
    lines = math.ceil(len(shown) / GALLERY_COLUMNS)
    grid = page.subplots(2 * lines, GALLERY_COLUMNS, squeeze=False)
    noise = max(measurement.noise_std, 1e-300)
    for axes in grid.flat:
        axes.axis("off")
    for number, stamp in enumerate(shown):
        line, column = divmod(number, GALLERY_COLUMNS)
        upper, lower = grid[2 * line, column], grid[2 * line + 1, column]
        _draw_stamp(upper, measurement.sources[number], stamp, number + 1)
        lower.imshow(
            stamp.residual, cmap="RdBu_r", vmin=-5 * noise, vmax=5 * noise, interpolation="nearest"
        )
        _centre_on(measurement.sources[number], stamp, reach, (upper, lower))
    more = len(measurement.sources) - len(shown)
    page.suptitle(
        "Sources and their residuals, −5 (blue) to 5 (red) standard deviations"
        + (f" ({more} more not shown)" if more else ""),
        x=0.012, ha="left", fontsize=11, fontweight="bold",
    )  # fmt: skip


def _centre_on(one: PointSource, stamp: SourceStamp, reach: int, pair: tuple[Axes, Axes]) -> None:
    """Show as much around every source: what the image does not have stays blank."""
    down, right = round(one.row.value) - stamp.origin[0], round(one.col.value) - stamp.origin[1]
    for axes in pair:
        axes.set(
            xlim=(right - reach - 0.5, right + reach + 0.5),
            ylim=(down + reach + 0.5, down - reach - 0.5),
        )


def _draw_stamp(axes: Axes, one: PointSource, stamp: SourceStamp, number: int) -> None:
    # What is darker than its ground was no source, but it is shown all the same.
    ground, height = one.background.value, abs(one.peak)
    axes.imshow(
        stamp.pixels, cmap="gray", interpolation="nearest",
        vmin=ground - (0.1 if one.peak > 0 else 1.0) * height,
        vmax=ground + (1.0 if one.peak > 0 else 0.1) * height,
    )  # fmt: skip
    down, right = one.row.value - stamp.origin[0], one.col.value - stamp.origin[1]
    axes.plot(right, down, "+", color=ORANGE, markersize=7, markeredgewidth=1.0)
    axes.set_title(f"{number}: SNR {one.snr:.0f}", fontsize=8, fontweight="normal", loc="center")
