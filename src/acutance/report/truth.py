"""What is true of a simulated image, as JSON documents."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from acutance.report.budget import sensor_document

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.simulate import BarsTruth, PointsTruth, PulseTruth, Scene, StarTruth, Truth

__all__ = ["scene_document", "target_truth_document", "truth_document"]


def truth_document(truth: Truth | PulseTruth, sensor: Sensor) -> dict[str, Any]:
    """The document ``acutance/truth/1``: what a perfect measurement of a simulation returns.

    Numbers and curves stand under the names they have in a measurement; the line of a pulse is its
    middle.
    """
    numbers = {name: number.value for name, number in truth.response.metrics().items()}
    return {
        "schema": "acutance/truth/1",
        "orientation": truth.orientation,
        "sensor": {
            "gsd_m": sensor.gsd_m,
            "blocks": [{"block": type(one).__name__, **_fields(one)} for one in sensor.blocks],
        },
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
