"""Where the edges of a scene lie, in the colours of their sharpness."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.figures.panel import Panel
from acutance.report.figures.pixels import as_backdrop
from acutance.report.figures.scene_sensor import behind_words, edges_seen
from acutance.report.paper import INK, SKY, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.scan import SceneMeasurement

__all__ = ["map_panel"]

_FEW_LINES, _MAX_LINES = 200, 2500
"""So many of the used edges are drawn, and of the others: more lie over one another."""
_MAX_GAIN = 2.0
"""How much thicker a dozen lines are than `_FEW_LINES`."""
_MIN_SHARE = 0.008
"""Shortest line, a share of the map's side: a shorter one has no colour that can be seen."""
_VECTOR_LINES = 1000
"""More lines than these are drawn as pixels in vector graphics."""
_REACH = 3.0
"""Standard deviations at the ends of the colours: ideal edges stay pale."""
_GROUND, _IDEAL = "#7d8792", "#fff5c4"
_MAX_PIXELS = 1200
_HEIGHT_IN = 5.4


def map_panel(measurement: SceneMeasurement, backdrop: Floats | None = None) -> Panel:
    """The map of a scene, on a quick look at what was scanned if there is one (rows, cols)."""
    shown = as_backdrop(backdrop)
    edges = measurement.edges
    used = int(edges.used.sum())
    steps = [_step(used), _step(edges.size - used)]
    thinned = (
        f" One in {steps[0]} of the used edges and one in {steps[1]} of the others is drawn."
        if max(steps) > 1
        else ""
    )
    is_short = edges.length_px < np.where(edges.used, _shortest(measurement, used), 0.0)
    lengthened = " Short ones are drawn longer than they are." if is_short.any() else ""
    return Panel(
        "Edges of the scene",
        "Edges that are used, in the colour of their MTF at Nyquist minus that of the sensor at "
        "their place along their normal, in standard deviations of the edge: pale as sharp as the "
        "sensor, orange softer, blue sharper than it. Thin dark lines: left out."
        + thinned
        + lengthened
        + behind_words(measurement),
        lambda page: _draw(page, measurement, shown),
        height_in=_HEIGHT_IN,
        is_target=True,
    )


def _step(count: int) -> int:
    """Of so many edges one in how many is drawn."""
    return max(1, math.ceil(count / _MAX_LINES))


def _shortest(measurement: SceneMeasurement, used: int) -> float:
    """Length of the shortest of so many lines in pixels: a few are thick, and longer than thick."""
    return _MIN_SHARE * max(measurement.image.roi[2:]) * max(1.0, _gain(used)) ** 2


def _draw(page: FigureBase, measurement: SceneMeasurement, backdrop: Floats | None) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap

    axes: Axes = page.subplots()
    row, col, height, width = measurement.image.roi
    extent = (col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5)
    axes.set_facecolor(_GROUND)
    if backdrop is not None:
        _draw_backdrop(axes, backdrop, extent)
    edges, seen = measurement.edges, edges_seen(measurement)
    some = np.flatnonzero(~edges.used)[:: _step(int(np.sum(~edges.used)))]
    lines = _lines(
        edges.row[some], edges.col[some], edges.normal_deg[some],
        np.maximum(edges.length_px[some], _MIN_SHARE * max(height, width)),
    )  # fmt: skip
    axes.add_collection(
        LineCollection(
            list(lines), colors=INK, linewidths=0.9 * min(1.0, _gain(len(lines))), alpha=0.75,
            rasterized=len(lines) > _VECTOR_LINES,
        )
    )  # fmt: skip
    few = slice(None, None, _step(seen.row.size))
    lines = _lines(
        seen.row[few], seen.col[few], seen.normal_deg[few],
        np.maximum(seen.length_px[few], _shortest(measurement, seen.row.size)),
    )  # fmt: skip
    coloured = LineCollection(
        list(lines), linewidths=2.4 * _gain(len(lines)),
        cmap=LinearSegmentedColormap.from_list("sharpness", [VERMILION, _IDEAL, SKY]),
        rasterized=len(lines) > _VECTOR_LINES,
    )  # fmt: skip
    coloured.set_array(np.clip((seen.off / seen.std)[few], -_REACH, _REACH))
    coloured.set_clim(-_REACH, _REACH)
    axes.add_collection(coloured)
    bar = page.colorbar(coloured, ax=axes, location="bottom", shrink=0.9, aspect=30, extend="both")
    bar.set_label("softer ←  edge − sensor [std of the edge]  → sharper")
    axes.set(
        xlim=extent[:2], ylim=extent[2:], xlabel="column", ylabel="row",
        title="Edges of the scene",
    )  # fmt: skip
    axes.set_aspect("equal")
    axes.locator_params(nbins=6)
    axes.grid(visible=False)


def _lines(row: Floats, col: Floats, normal_deg: Floats, length_px: Floats) -> Floats:
    """Ends of edges, (n, 2, 2): columns before rows."""
    angle, half = np.radians(normal_deg), 0.5 * length_px
    middle = np.stack([col, row], axis=1)
    away = np.stack([-half * np.sin(angle), half * np.cos(angle)], axis=1)
    return np.stack([middle - away, middle + away], axis=1)


def _gain(count: int) -> float:
    """Factor of the width of lines: the more there are, the thinner."""
    return min(_MAX_GAIN, math.cbrt(_FEW_LINES / max(count, 1)))


def _draw_backdrop(axes: Axes, pixels: Floats, extent: tuple[float, float, float, float]) -> None:
    """An image in middle greys: the colours of edges stand out from them."""
    step = max(1, math.ceil(max(pixels.shape) / _MAX_PIXELS))
    shown = np.ma.masked_invalid(pixels[::step, ::step])
    if not shown.count():
        return
    low, high = np.percentile(shown.compressed(), (1.0, 99.0))
    margin = 0.6 * max(float(high - low), 1e-9)
    axes.imshow(
        shown, cmap="gray", vmin=low - margin, vmax=high + margin, extent=extent,
        interpolation="nearest", aspect="auto",
    )  # fmt: skip
