"""What is true of a simulated image, as JSON documents."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from acutance.report.budget import sensor_document
from acutance.report.documents import truth_document

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.simulate import BarsTruth, PointsTruth, PulseTruth, Scene, StarTruth

__all__ = ["scene_document", "target_truth_document"]


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
