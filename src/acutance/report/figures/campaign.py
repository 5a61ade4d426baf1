"""Drawings of a campaign: the site with its targets, and every method against the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from acutance.curves.metric_words import metric_words
from acutance.report.figures.curves import TWO_SIDED_95, band_edges, mark_frequencies
from acutance.report.figures.pixels import show_pixels
from acutance.report.figures.scene import scene_panels
from acutance.report.figures.straight import draw_esf, draw_prf
from acutance.report.paper import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    VERMILION,
    new_page,
    split_page,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves.grid import Floats
    from acutance.optics import Sensor
    from acutance.report.figures.panel import Panel
    from acutance.report.tables.campaign import CampaignEntry
    from acutance.scan import SceneMeasurement
    from acutance.simulate import Scene
    from acutance.targets.straight import StraightMeasurement

__all__ = [
    "Drawing",
    "campaign_figure",
    "curves_figure",
    "draw_small_edge",
    "draw_small_pulse",
    "draw_titled",
    "landscape_figure",
    "site_figure",
]

Drawing: TypeAlias = "Callable[[FigureBase], None]"
"""Draws into a part of a figure."""


COLORS = {"edge": BLUE, "pulse": VERMILION, "points": ORANGE, "bars": GREEN, "star": PURPLE}
LABEL_PX = 3.0
ENTRY_IN = 0.235
NAMES = ("mtf_nyquist", "rer", "fwhm_px")


def site_figure(scene: Scene, drawings: Sequence[Drawing]) -> Figure:
    """The whole site with the outline of every region, and six drawings of its targets.

    Parameters
    ----------
    scene : Scene
    drawings : sequence of function of a part of a figure
        What the targets show.
    """
    with styled():
        figure = new_page(14.6, 8.9)
        left, right = split_page(figure, 1, 2, widths=(1.0, 1.0))
        _draw_site(left.subplots(), scene)
        for place, draw in zip(split_page(right, 3, 2), drawings, strict=False):
            draw(place)
    return figure


def _draw_site(axes: Axes, scene: Scene) -> None:
    show_pixels(axes, np.asarray(scene.image, float), 0, 0)
    for edge in scene.edges:
        _outline(axes, edge.region, f"{edge.name} edge", COLORS["edge"])
    for target in scene.targets:
        _outline(axes, target.region, target.name, COLORS[target.kind])
    axes.set_title("The site and the regions that are measured")


def _outline(axes: Axes, region: Floats, name: str, color: str) -> None:
    corners = np.vstack([region, region[:1]])
    axes.plot(corners[:, 1], corners[:, 0], color=color, linewidth=1.6)
    top = corners[np.argmin(corners[:, 0] + 0.2 * corners[:, 1])]
    axes.annotate(
        name, (float(top[1]), float(top[0])), (0, LABEL_PX), textcoords="offset points",
        ha="left", va="bottom", color="white", fontsize=9, fontweight="bold",
        bbox={"boxstyle": "round,pad=0.2", "facecolor": color, "edgecolor": "none"},
    )  # fmt: skip


def campaign_figure(entries: Sequence[CampaignEntry]) -> Figure:
    """Each method minus the truth with its 95 % interval: MTF at Nyquist, RER, FWHM."""
    with styled():
        figure = new_page(12.4, 1.2 + ENTRY_IN * (len(entries) + 2))
        sides = figure.subplots(1, len(NAMES), sharey=True)
        rows = _rows(entries)
        for axes, name in zip(sides, NAMES, strict=True):
            _draw_deviations(axes, entries, rows, name)
        sides[0].set_yticks(rows, [_label(one, entries) for one in entries])
        sides[0].set_ylim(max(rows) + 0.7, min(rows) - 1.4)
        for orientation in ("across", "along"):
            own = [row for row, one in zip(rows, entries, strict=True)
                   if one.orientation == orientation]  # fmt: skip
            if own:
                sides[0].annotate(
                    orientation, (0.01, min(own) - 0.55), xycoords=("axes fraction", "data"),
                    ha="left", va="bottom", color=FAINT, fontweight="bold",
                )  # fmt: skip
    return figure


def _rows(entries: Sequence[CampaignEntry]) -> list[float]:
    """Places of the entries, with a gap between the two directions."""
    found, row = [], 0.0
    for i, one in enumerate(entries):
        if i and entries[i - 1].orientation != one.orientation:
            row += 1.3
        found.append(row)
        row += 1.0
    return found


def _label(entry: CampaignEntry, entries: Sequence[CampaignEntry]) -> str:
    """The target, and the method where there are several."""
    methods = {one.method for one in entries if one.target == entry.target}
    return entry.target if len(methods) == 1 else f"{entry.target}, {entry.method}"


def _draw_deviations(
    axes: Axes, entries: Sequence[CampaignEntry], rows: Sequence[float], name: str
) -> None:
    """Deviations from the truth; an arrow at the border where one or its interval goes on."""
    offs = np.array([one.numbers(name)[0].value - one.numbers(name)[1] for one in entries])
    stds = np.array([one.numbers(name)[0].std for one in entries])
    trusted = np.array([one.reference for one in entries])
    reach = 1.15 * float(np.nanmax((np.abs(offs) + TWO_SIDED_95 * stds)[trusted]))
    axes.axvline(0.0, color=INK, linewidth=1.0)
    for off, std, row, one in zip(offs, stds, rows, entries, strict=True):
        color = INK if one.target == "all combined" else (BLUE if one.reference else FAINT)
        ends = off - TWO_SIDED_95 * std, off + TWO_SIDED_95 * std
        for side, outside in ((-1, ends[0] < -reach), (1, ends[1] > reach)):
            if outside:
                axes.plot(
                    side * reach * 0.97, row, marker=">" if side > 0 else "<", color=color,
                    markersize=6,
                )  # fmt: skip
        if abs(off) > reach:
            continue
        axes.errorbar(
            off, row, xerr=TWO_SIDED_95 * std, fmt="D" if color == INK else "o", color=color,
            markersize=5, capsize=3, linewidth=1.4,
        )  # fmt: skip
    words = metric_words(name)
    axes.set(xlim=(-reach, reach), xlabel="measured − true", title=words.label_with_unit)
    axes.grid(visible=False, axis="y")
    axes.locator_params(axis="x", nbins=5)


def _color(target: str) -> str:
    """That of the target's kind, as on the site: mirrors are the points."""
    return next((color for kind, color in COLORS.items() if kind in target), COLORS["points"])


def curves_figure(entries: Sequence[CampaignEntry]) -> Figure:
    """The MTFs of the reference methods across and along with the truth."""
    with styled():
        figure = new_page(12.4, 4.6)
        for place, orientation in zip(split_page(figure, 1, 2), ("across", "along"), strict=True):
            axes = place.subplots()
            own = [one for one in entries if one.reference and one.orientation == orientation]
            mark_frequencies(axes, None, 1.0)
            single = [one for one in own if one.target != "all combined"]
            for one in single:
                color = _color(one.target)
                low, high = band_edges(one.response.mtf.value, one.response.mtf.std)
                axes.fill_between(
                    one.response.mtf.freq_cpp, low, high, color=color, alpha=0.15, linewidth=0
                )
                axes.plot(
                    one.response.mtf.freq_cpp, one.response.mtf.value, color=color, linewidth=1.3,
                    label=one.target,
                )  # fmt: skip
            truth = own[-1].truth.mtf
            axes.plot(truth.freq_cpp, truth.value, color=INK, linewidth=1.5, linestyle="--",
                      label="truth")  # fmt: skip
            axes.set_title(f"MTF {orientation}")
            axes.legend(loc="upper right", bbox_to_anchor=(1.0, 0.93))
    return figure


def landscape_figure(measurement: SceneMeasurement, pixels: Floats, sensor: Sensor) -> Figure:
    """A landscape, the edges found in it, and their sharpness by direction with the truth."""
    scene_map, by_direction, *_ = scene_panels(measurement)
    with styled():
        figure = new_page(14.6, 4.6)
        image, edges, directions = split_page(figure, 1, 3, widths=(1.0, 1.3, 1.1))
        axes = image.subplots()
        show_pixels(axes, pixels, 0, 0)
        axes.set_title("The landscape")
        scene_map.draw(edges)
        by_direction.draw(directions)
        normal = np.linspace(0.0, 2 * np.pi, 181)
        u, v = (0.5 * wave(normal) for wave in (np.cos, np.sin))
        directions.gca().plot(
            normal, np.abs(sensor.otf(u, v)), color=INK, linewidth=1.4, linestyle="--"
        )
    return figure


def draw_titled(panel: Panel, title: str, page: FigureBase) -> None:
    """A panel under another title."""
    panel.draw(page)
    page.gca().set_title(title)


def draw_small_edge(measurement: StraightMeasurement, page: FigureBase) -> None:
    """The ESF with its pixels."""
    axes = page.subplots()
    draw_esf(axes, measurement)
    axes.set(title="Vertical edge", xlabel="distance along the normal [px]")


def draw_small_pulse(measurement: StraightMeasurement, page: FigureBase) -> None:
    """The response to a pulse with its pixels."""
    axes = page.subplots()
    if measurement.width_px is not None:
        draw_prf(axes, measurement)
    if legend := axes.get_legend():
        legend.remove()
    axes.set(title="Pulse tarp", xlabel="distance along the normal [px]")
