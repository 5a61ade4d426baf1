"""Drawings of a scene: its edges, sharpness by direction and over the field, the population."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.figures.curves import band_edges
from acutance.report.figures.panel import Panel
from acutance.report.figures.scene_field import field_panel
from acutance.report.figures.scene_map import map_panel
from acutance.report.figures.scene_population import population_panel
from acutance.report.figures.scene_sensor import edges_seen, sensor_along
from acutance.report.labels import word_softness
from acutance.report.paper import BLUE, FAINT, VERMILION

if TYPE_CHECKING:
    from acutance.scan import SceneMeasurement

__all__ = ["scene_panels"]

_MAX_DOTS = 4000
_ROOM = 1.5
"""Directions are drawn to so many times the sensor's largest MTF."""


def scene_panels(
    measurement: SceneMeasurement, backdrop: Floats | None = None
) -> tuple[Panel, ...]:
    """What a scene adds to its page: a map of its edges, sharpness by direction, place and object.

    Parameters
    ----------
    measurement : SceneMeasurement
    backdrop : (rows, cols) array, optional
        A quick look at what was scanned, of any size: the edges are drawn on it.
    """
    return (
        map_panel(measurement, backdrop),
        Panel(
            "By direction",
            "MTF at Nyquist along the normal, from dark to bright (0: along the rows, 90: down the "
            "columns). Red: the sensor with its 95 % band, the mean over the field. Dots: used "
            "edges, blue where the object is probably ideal, else grey; edges beyond the rim lie "
            "on it." + _stated(measurement),
            lambda page: _draw_directions(
                page.subplots(subplot_kw={"projection": "polar"}), measurement
            ),
        ),
        population_panel(measurement),
        *((field_panel(measurement),) if measurement.field.is_fitted else ()),
    )


def _stated(measurement: SceneMeasurement) -> str:
    """Why all edges lie below the sensor."""
    softness = word_softness(measurement.options)
    if not softness:
        return ""
    return f" The edges have the {softness} of softness that are stated of all objects."


def _draw_directions(axes: Any, measurement: SceneMeasurement) -> None:
    from matplotlib.ticker import MaxNLocator

    edges = edges_seen(measurement)
    some = slice(None, None, max(1, edges.mtf.size // _MAX_DOTS))
    angle_deg = np.linspace(0.0, 360.0, 181)
    mtf, std = sensor_along(measurement, angle_deg)
    low, high = band_edges(mtf, std)
    top = max(_ROOM * float(mtf.max()), float(high.max()))
    normal, value = np.radians(edges.normal_deg[some]), np.minimum(edges.mtf[some], top)
    ideal = edges.ideal[some] > 0.5
    opacity = float(np.clip(20 / np.sqrt(max(value.size, 1)), 0.25, 0.8))
    for own, color in ((~ideal, FAINT), (ideal, BLUE)):
        axes.scatter(
            normal[own], value[own], s=8 if value.size < 1000 else 4, color=color, linewidths=0,
            alpha=opacity, rasterized=value.size > 1000, zorder=2.1,
        )  # fmt: skip
    # Directions turn as in the image: rows go downwards.
    axes.set_theta_direction(-1)
    angle = np.radians(angle_deg)
    axes.fill_between(angle, np.maximum(low, 0.0), high, color=VERMILION, alpha=0.25, linewidth=0)
    axes.plot(angle, mtf, color=VERMILION, linewidth=1.6, zorder=2.3)
    axes.set_ylim(0.0, top)
    ticks = np.asarray(MaxNLocator(4).tick_values(0.0, top))
    axes.set_yticks(ticks[(ticks > 0) & (ticks < top)])
    axes.tick_params(axis="y", labelsize=7.5)
    # The radius is read above the dots: labels of ticks are drawn at 2.5.
    axes.set_axisbelow(False)
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.6})
    axes.set_rlabel_position(22.5)
    axes.set_title("MTF at Nyquist by direction", pad=14)
    axes.grid(color=FAINT, alpha=0.35)
