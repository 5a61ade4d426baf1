"""The result of a scan: the sensor under all edges of a scene, the objects, every edge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acutance.curves import Estimate
from acutance.scan.scene_edges import SceneEdges
from acutance.targets.measurement import Measurement

__all__ = ["SceneMeasurement"]


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneMeasurement(Measurement):
    """A sensor measured from the edges of a whole scene; `details` is the `SensorFit`.

    Parameters
    ----------
    edges : SceneEdges
        Every edge that was found, one array a column.
    objects : mapping of str to Estimate
        Shares of the objects: "ideal", "soft 0.2 px" and so on by the size of their softness, and
        "strange" for edges that are neither.
    normal_deg_bins : tuple of float
        Mean directions of the edges, -90 to 90 degrees.
    """

    edges: SceneEdges
    objects: Mapping[str, Estimate]
    normal_deg_bins: tuple[float, ...]

    def target_document(self) -> dict[str, Any]:
        """How many edges, their directions, and the shares of the objects."""
        return {
            "edges": {"found": self.edges.size, "used": int(self.edges.used.sum())},
            "directions_deg": [round(one, 3) for one in self.normal_deg_bins],
            "objects": {name: share.to_dict() for name, share in self.objects.items()},
        }
