"""Whole scenes: the sensor from all straight edges of an image, whatever their objects are.

In the order data take: `windows` (a large image in parts), `edge_points` (maxima of the gradient,
between pixels), `segments` (straight or gently curved chains of them), `pieces` (what is measured
by itself), `band_pieces` (the same in several bands), `window_edges` (a window's edges, measured
and judged by `acutance.targets.straight`), `all_windows` (every window, on several processes or a
cluster; finished ones in a file: `kept_windows`, `scan_identity`), `softness` (laws of the
objects), `shares` (by direction), `population` (what the edges share, and what each is),
`information` (what they say of the sensor), `first_guesses` (where its fit begins), `blur_modes`
(how a blur may change), `shared_blur` (what is the sensor's or all objects'), `parts` (do the parts
of a scene agree), `field_fit` and `field` (over the field of view), `sensor_fit` (the sensor over
the plane of frequencies), `stated_objects` (what is stated of all objects), `scene` (the public
function), `left_out` (why edges are not used), `scene_edges` and `scene_measurement` (its result;
written by `edge_table` and `parquet`), `borders` (edges of one object) and `checks` (is the scene
rich enough), `bands` (several bands at once; `band_shift` between them), `options`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use

if TYPE_CHECKING:
    from acutance.scan.band_shift import BandShift
    from acutance.scan.bands import BandEdges, BandScenes, scan_bands
    from acutance.scan.field import Field
    from acutance.scan.options import ScanOptions
    from acutance.scan.scene import edges_of_scene, scan_scene
    from acutance.scan.scene_edges import SceneEdges
    from acutance.scan.scene_measurement import SceneMeasurement, ScenePlace

__all__ = [
    "BandEdges",
    "BandScenes",
    "BandShift",
    "Field",
    "ScanOptions",
    "SceneEdges",
    "SceneMeasurement",
    "ScenePlace",
    "edges_of_scene",
    "scan_bands",
    "scan_scene",
]

# The modules are loaded when a name is first used: a report of an edge scans nothing.
_HOMES = {
    "BandEdges": "bands",
    "BandScenes": "bands",
    "BandShift": "band_shift",
    "Field": "field",
    "ScanOptions": "options",
    "SceneEdges": "scene_edges",
    "SceneMeasurement": "scene_measurement",
    "ScenePlace": "scene_measurement",
    "edges_of_scene": "scene",
    "scan_bands": "bands",
    "scan_scene": "scene",
}

__getattr__ = names_on_use(__name__, _HOMES)
