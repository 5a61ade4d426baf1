"""A field with an edge and a pulse, and its survey."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import acutance as ac
from acutance.geometry import Line
from acutance.simulate.tarps import EdgeTarps, PulseTarp

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.5)
GSD_M, WEST_M, NORTH_M = 0.5, 600_000.0, 5_000_000.0
SHAPE = (110, 170)
EDGE = EdgeTarps("edge", 55.3, 50.4, 6.0, 36.0, 200.0, 1200.0)
PULSE = PulseTarp("pulse", 55.4, 125.7, 6.0, 3.0, 50.0, 1200.0)


def on_map(row: float, col: float) -> list[float]:
    """Map coordinates of a place of the field."""
    return [WEST_M + GSD_M * (col + 0.5), NORTH_M - GSD_M * (row + 0.5)]


def line_of(tarp: Any, length_px: float) -> list[list[float]]:
    """A surveyed line along a tarp."""
    edge = Line(tarp.row, tarp.col, tarp.normal_deg)
    ends = (edge.slid(-0.5 * length_px), edge.slid(0.5 * length_px))
    return [on_map(end.row, end.col) for end in ends]


def feature(name: str, kind: str, shape: str | None, points: Any, **more: Any) -> dict[str, Any]:
    """A feature of the survey."""
    geometry = None if shape is None else {"type": shape, "coordinates": points}
    properties = {"name": name, "kind": kind, "position_std_m": 1.5, **more}
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def survey(*features: dict[str, Any], crs: str = "EPSG:32631") -> dict[str, Any]:
    """A survey of features; of the field's edge and pulse without any."""
    both = (
        feature("edge", "edge", "LineString", line_of(EDGE, 30.0)),
        feature("pulse", "pulse", "LineString", line_of(PULSE, 40.0), width_m=1.5),
    )
    return {"type": "FeatureCollection", "crs": crs, "features": list(features or both)}


def written(path: Path, document: Any) -> Path:
    """A JSON document as a file."""
    path.write_text(json.dumps(document), encoding="utf-8")
    return path
