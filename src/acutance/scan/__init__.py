"""Whole scenes: the sensor from all straight edges of an image, whatever their objects are.

In the order data take: `windows` (a large image in parts), `edge_points` (maxima of the gradient,
between pixels), `segments` (straight or gently curved chains of them), `pieces` (what is measured
by itself), `window_edges` (a window's edges, measured and judged by `acutance.targets.straight`),
`all_windows` (every window, on several processes), `population` (what they share, and how soft
the objects are), `sensor_fit` (the sensor over the plane of frequencies), `scene` (the public
function), `scene_edges` and `scene_measurement` (its result), `checks` (is the scene rich
enough), `options`.
"""

from acutance.scan.options import ScanOptions
from acutance.scan.scene import scan_scene
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.scene_measurement import SceneMeasurement

__all__ = ["ScanOptions", "SceneEdges", "SceneMeasurement", "scan_scene"]
