"""What is true of a simulated image, as JSON documents."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, fields, replace
from typing import TYPE_CHECKING, Any

from acutance.arguments import require_class
from acutance.report.budget import sensor_document

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.simulate import (
        BarsTruth,
        LandscapeEdge,
        LandscapeTruth,
        PointsTruth,
        PulseTruth,
        Scene,
        StarTruth,
        Truth,
    )

__all__ = [
    "landscape_document",
    "scene_document",
    "target_truth_document",
    "truth_document",
]


def truth_document(truth: Truth | PulseTruth, sensor: Sensor) -> dict[str, Any]:
    """The document ``acutance/truth/1``: what a perfect measurement of a simulation returns.

    Numbers and curves stand under the names they have in a measurement; the line of a pulse is its
    middle.
    """
    numbers = {name: number.value for name, number in truth.response.metrics().items()}
    return {
        "schema": "acutance/truth/1",
        "orientation": truth.orientation,
        "sensor": sensor_document(sensor),
        "line": truth.line.to_dict(),
        "angle_deg": truth.line.angle_deg,
        **_levels(truth),
        "noise": None if truth.noise is None else _fields(truth.noise),
        **numbers,
        "mtf": _without_std(truth.mtf.to_dict()),
        "lsf": _without_std(truth.lsf.to_dict()),
        "esf": _without_std(truth.esf.to_dict()),
    }


def _levels(truth: Truth | PulseTruth) -> dict[str, float | None]:
    """Levels of a target, and the width of a pulse."""
    from acutance.simulate import Truth

    if isinstance(truth, Truth):
        return {"dark": truth.dark, "bright": truth.bright}
    return {
        "dark": truth.left,
        "bright": truth.level,
        "dark_behind": truth.right,
        "width_px": truth.width_px,
        "width_m": truth.width_m,
        "prf_fwhm_px": truth.prf_fwhm_px,
    }


def _fields(described: Any) -> dict[str, Any]:
    return {one.name: getattr(described, one.name) for one in fields(described)}


def _without_std(curve: dict[str, list[float]]) -> dict[str, list[float]]:
    return {name: values for name, values in curve.items() if name != "std"}


def target_truth_document(
    truth: PulseTruth | BarsTruth | StarTruth | PointsTruth, sensor: Sensor
) -> dict[str, Any]:
    """The document ``acutance/truth/1`` of a target that is no edge; "kind" says which."""
    noise = None if truth.noise is None else asdict(truth.noise)
    return {
        "schema": "acutance/truth/1",
        **truth.to_dict(),
        "sensor": sensor_document(sensor),
        "noise": noise,
    }


def scene_document(scene: Scene) -> dict[str, Any]:
    """The document ``acutance/scene/1``: regions and truths of all targets by name."""
    require_class("Scene", scene=scene)
    edges = {
        edge.name: {
            "region": edge.region.tolist(),
            "truth": truth_document(edge.truth, scene.sensor),
        }
        for edge in scene.edges
    }
    targets = {
        target.name: {
            "kind": target.kind,
            "region": target.region.tolist(),
            "truth": target_truth_document(target.truth, scene.sensor),
        }
        for target in scene.targets
    }
    return {
        "schema": "acutance/scene/1",
        "description": scene.description,
        "edges": edges,
        "targets": targets,
    }


def landscape_document(
    truth: LandscapeTruth,
    *,
    half_width_px: float = 20.0,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """A landscape's edges as GeoJSON in pixels, x the column and y the row: regions and truths.

    The regions are what ``--roi`` takes. Properties of each edge: its place, direction and
    length, levels, softness, radius, what lies beside it, and the numbers of the image along its
    normal (``mtf_nyquist``, ``rer``, ``fwhm_px``) and of the sensor alone (``sensor_...``).

    Parameters
    ----------
    truth : LandscapeTruth
    half_width_px : float, optional
        How far the regions reach on either side.
    progress : function of (done, total), optional
        Called after each edge.
    """
    require_class("LandscapeTruth", truth=truth)
    features = []
    for done, edge in enumerate(truth.edges, start=1):
        ring = edge.region(half_width_px)[:, ::-1].round(3).tolist()
        features.append(
            {
                "type": "Feature",
                # Of a copy: an edge keeps its curves, and there may be tens of thousands.
                "properties": _landscape_edge(replace(edge), half_width_px),
                "geometry": {"type": "Polygon", "coordinates": [[*ring, ring[0]]]},
            }
        )
        if progress is not None:
            progress(done, len(truth.edges))
    return {
        "type": "FeatureCollection",
        "schema": "acutance/landscape/1",
        "crs": "pixel",
        "options": asdict(truth.options),
        "noise": None if truth.noise is None else _fields(truth.noise),
        "features": features,
    }


def _landscape_edge(edge: LandscapeEdge, half_width_px: float) -> dict[str, Any]:
    numbers = ("mtf_nyquist", "rer", "fwhm_px")
    alone = edge.sensor_response
    return {
        "name": edge.name,
        **edge.line.to_dict(),
        "angle_deg": edge.line.angle_deg,
        "ends": edge.ends().round(4).tolist(),
        "radius_px": edge.radius_px if math.isfinite(edge.radius_px) else None,
        "curvature_per_px": edge.curvature_per_px,
        "softness_px": edge.softness_px,
        "dark": edge.dark,
        "bright": edge.bright,
        "snr": edge.snr if math.isfinite(edge.snr) else None,
        "texture_dark": edge.texture_dark,
        "texture_bright": edge.texture_bright,
        "kind": edge.kind(half_width_px),
        "clean_dark_px": edge.clean_dark_px,
        "clean_bright_px": edge.clean_bright_px,
        "beside": [asdict(one) for one in edge.beside],
        **{name: getattr(edge, name).value for name in numbers},
        **{f"sensor_{name}": getattr(alone, name).value for name in numbers},
    }
