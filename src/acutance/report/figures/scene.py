"""Drawings of a scene: where its edges are, how sharp each is, by direction and in all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.geometry.angles import wrap_axis
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.paper import BLUE, FAINT, INK, SHADE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.scan import SceneMeasurement

__all__ = ["scene_panels"]

_TWO_SIDED = 1.96
_BINS = 40
_MANY = 4000
_NYQUIST_CPP = 0.5


def scene_panels(measurement: SceneMeasurement) -> tuple[Panel, ...]:
    """What a scene adds to its page: a map of its edges, sharpness by direction, and all of it."""
    return (
        Panel(
            "Edges of the scene",
            "Every edge that was found, in pixels of the image. Colour: its MTF at Nyquist minus "
            "that of the sensor along its normal, of edges that are used; grey: left out.",
            on_axes(_draw_map, measurement),
            is_target=True,
        ),
        Panel(
            "By direction",
            "MTF at Nyquist of every used edge along its normal (points, dark where the object is "
            "ideal), and of the sensor with its 95 % band.",
            on_axes(_draw_directions, measurement),
        ),
        Panel(
            "Sharpness of the edges",
            "MTF at Nyquist of the used edges minus that of the sensor along their normals. Ideal "
            "objects scatter about 0 by the deviations of the edges; soft ones lie to the left.",
            on_axes(_draw_histogram, measurement),
        ),
    )


def _along(measurement: SceneMeasurement, normal_deg: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """MTF of the sensor at Nyquist along normals, and its standard deviation."""
    angle = np.radians(normal_deg)
    u, v = _NYQUIST_CPP * np.cos(angle), _NYQUIST_CPP * np.sin(angle)
    otf, factor = measurement.otf.model.otf(u, v), measurement.otf.model.factor(u, v)
    modulus = np.abs(otf)
    along = (np.conj(otf) / np.maximum(modulus, 1e-12))[:, None] * factor
    return modulus, np.sqrt(np.sum(along.real**2, axis=1))


def _draw_map(axes: Axes, measurement: SceneMeasurement) -> None:
    from matplotlib.collections import LineCollection

    edges = measurement.edges
    angle, half = np.radians(edges.normal_deg), 0.5 * edges.length_px
    right, down = -half * np.sin(angle), half * np.cos(angle)
    lines = np.stack([
        np.stack([edges.col - right, edges.row - down], axis=1),
        np.stack([edges.col + right, edges.row + down], axis=1),
    ], axis=1)  # fmt: skip
    used = edges.used
    axes.add_collection(LineCollection(list(lines[~used]), colors=FAINT, linewidths=0.8, alpha=0.6))
    off = edges.mtf_nyquist[used] - _along(measurement, edges.normal_deg[used])[0]
    reach = max(float(np.quantile(np.abs(off), 0.95)), 0.02)
    coloured = LineCollection(list(lines[used]), cmap="RdYlBu", linewidths=2.0)
    coloured.set_array(np.clip(off, -reach, reach))
    coloured.set_clim(-reach, reach)
    axes.add_collection(coloured)
    axes.figure.colorbar(coloured, ax=axes, shrink=0.8, label="edge − sensor, MTF at Nyquist")
    row, col, height, width = measurement.image.roi
    axes.set(
        xlim=(col - 0.5, col + width - 0.5), ylim=(row + height - 0.5, row - 0.5),
        xlabel="column", ylabel="row", title="Edges of the scene",
    )  # fmt: skip
    # The colours in the middle of the scale are pale.
    axes.set_facecolor(INK)
    axes.set_aspect("equal")
    axes.grid(visible=False)


def _draw_directions(axes: Axes, measurement: SceneMeasurement) -> None:
    edges = measurement.edges
    used = np.flatnonzero(edges.used)
    some = used[:: max(1, used.size // _MANY)]
    normal = wrap_axis(edges.normal_deg[some])
    ideal = edges.ideal[some] > 0.5
    for own, color in ((~ideal, FAINT), (ideal, BLUE)):
        axes.scatter(
            normal[own], edges.mtf_nyquist[some][own], s=9, color=color, linewidths=0, alpha=0.5
        )
    every = np.linspace(-90.0, 90.0, 91)
    modulus, std = _along(measurement, every)
    axes.fill_between(
        every, modulus - _TWO_SIDED * std, modulus + _TWO_SIDED * std, color=VERMILION, alpha=0.25,
        linewidth=0,
    )  # fmt: skip
    axes.plot(every, modulus, color=VERMILION, linewidth=1.6)
    axes.set(
        xlim=(-90, 90), xlabel="normal / deg (0: along the rows, 90: down the columns)",
        ylabel="MTF at Nyquist", title="By direction",
    )  # fmt: skip
    axes.set_xticks([-90, -45, 0, 45, 90])
    axes.set_ylim(bottom=0)


def _draw_histogram(axes: Axes, measurement: SceneMeasurement) -> None:
    edges = measurement.edges
    used = edges.used
    off = edges.mtf_nyquist[used] - _along(measurement, edges.normal_deg[used])[0]
    low, high = np.quantile(off, [0.005, 0.995])
    bins = np.linspace(min(low, -0.02), max(high, 0.02), _BINS + 1)
    axes.hist(
        np.clip(off, bins[0], bins[-1]), bins.tolist(), color=SHADE, edgecolor=FAINT, linewidth=0.6
    )
    axes.hist(
        np.clip(off, bins[0], bins[-1]), bins.tolist(), weights=edges.ideal[used], color=BLUE,
        alpha=0.6,
    )  # fmt: skip
    axes.axvline(0.0, color=VERMILION, linewidth=1.6)
    ideal = measurement.objects["ideal"]
    axes.set(
        xlabel="edge − sensor, MTF at Nyquist", ylabel="edges",
        title=f"Sharpness; blue: ideal, {100 * ideal.value:.0f} ± {100 * ideal.std:.0f} %",
    )  # fmt: skip
    axes.grid(visible=False, axis="x")
