"""A campaign to be worked off: images of one field with ten targets, on a map that is metres off.

Eight images are rendered, at eight sub-pixel places; every image of the campaign is one of them
with noise of its own, a date of its own, and a geotransform that is wrong by some metres.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

import acutance as ac
from acutance.geometry import Line
from acutance.simulate.campaign import Placed, render_site
from acutance.simulate.points import mirror_columns
from acutance.simulate.tarps import EdgeTarps, PulseTarp

GSD_M, CRS = 0.7, "EPSG:32631"
WEST_M, NORTH_M = 500_000.0, 4_800_000.0
OFF_M = 2.0
"""Standard deviation of every geotransform's shift, in either axis."""
SENSOR = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector(1.0)], gsd_m=GSD_M)
BASES, NOISE_STD = 8, 8.0
SIDE_PX = 512


def _tarps(row: float, col: float) -> list[EdgeTarps | PulseTarp]:
    edges = [
        EdgeTarps(f"edge-{i + 1}", row + y, col + x, normal, 40.0, 200.0, 1200.0)
        for i, (y, x, normal) in enumerate(
            [(60, 80, 6.0), (60, 230, 96.0), (60, 400, 10.0), (190, 80, 98.0), (190, 230, 4.0),
             (190, 400, 84.0), (320, 400, 8.0)]
        )
    ]  # fmt: skip
    pulses = [
        PulseTarp("pulse-1", row + 300, col + 80, 6.0, 3.0, 60.0, 1200.0),
        PulseTarp("pulse-2", row + 300, col + 230, 96.0, 3.0, 60.0, 1200.0),
    ]
    return [*edges, *pulses]


def _mirrors(row: float, col: float) -> np.ndarray:
    return np.array(mirror_columns((row + 350, col + 80)))


def _rendered(shift: tuple[float, float]) -> np.ndarray:
    """The field, its first pixel at a sub-pixel place."""
    row, col = shift
    placed = Placed(
        mirrors=tuple((float(r), float(c)) for r, c in _mirrors(row, col)),
        mirror_peak=900.0,
    )
    scene = render_site(SENSOR, _tarps(row, col), (SIDE_PX, SIDE_PX), placed=placed)
    return scene.image


def _ends(tarp: EdgeTarps | PulseTarp) -> list[tuple[float, float]]:
    """The ends of an edge, or of a pulse's axis, as (row, col)."""
    length = 0.9 * (tarp.side_px if isinstance(tarp, EdgeTarps) else tarp.length_px)
    edge = Line(tarp.row, tarp.col, tarp.normal_deg)
    return [(end.row, end.col) for end in (edge.slid(-0.5 * length), edge.slid(0.5 * length))]


def _on_map(row: float, col: float) -> list[float]:
    return [WEST_M + GSD_M * (col + 0.5), NORTH_M - GSD_M * (row + 0.5)]


def target_features() -> dict[str, Any]:
    """The survey: ten targets on the map."""

    def feature(name: str, kind: str, shape: str, points: Any, **more: Any) -> dict[str, Any]:
        geometry = {"type": shape, "coordinates": points}
        properties = {"name": name, "kind": kind, "site": "field", "position_std_m": OFF_M, **more}
        return {"type": "Feature", "geometry": geometry, "properties": properties}

    features = []
    for tarp in _tarps(0.0, 0.0):
        line = [_on_map(*end) for end in _ends(tarp)]
        if isinstance(tarp, EdgeTarps):
            features.append(feature(tarp.name, "edge", "LineString", line))
        else:
            width_m = tarp.width_px * GSD_M
            features.append(feature(tarp.name, "pulse", "LineString", line, width_m=width_m))
    mirrors = [_on_map(*one) for one in _mirrors(0.0, 0.0)]
    features.append(feature("mirrors", "points", "MultiPoint", mirrors))
    return {"type": "FeatureCollection", "crs": CRS, "features": features}


def make_campaign(folder: Path, count: int, rng: np.random.Generator) -> tuple[str, str]:
    """Write images and targets; the pattern of the images, and the file of the targets.

    Parameters
    ----------
    folder : Path
    count : int
        Images.
    rng : numpy.random.Generator
    """
    images = folder / "images"
    images.mkdir(parents=True)
    shifts = [(float(r), float(c)) for r, c in rng.uniform(0.0, 1.0, (min(BASES, count), 2))]
    bases = [_rendered(shift) for shift in shifts]
    for number, (base, shift) in enumerate(_in_turn(bases, shifts, count)):
        off = rng.normal(0.0, OFF_M, 2)
        west = WEST_M - GSD_M * shift[1] + off[1]
        north = NORTH_M + GSD_M * shift[0] + off[0]
        pixels = base + rng.normal(0.0, NOISE_STD, base.shape)
        day = datetime(2024, 1, 1, 10, 30, tzinfo=UTC) + timedelta(days=4 * number)
        ac.raster.write_geotiff(
            images / f"field-{number:04d}.tif",
            np.clip(np.rint(pixels), 0, 4095).astype(np.uint16),
            transform=(GSD_M, 0.0, west, 0.0, -GSD_M, north),
            crs=CRS,
            tags={"SENSOR": "SIM-1", "ACQUISITION_DATETIME": day.isoformat()},
        )
    targets = folder / "targets.geojson"
    targets.write_text(json.dumps(target_features()), encoding="utf-8")
    return str(images / "*.tif"), str(targets)


def _in_turn(bases: list[Any], shifts: list[Any], count: int) -> Iterator[tuple[Any, Any]]:
    for number in range(count):
        yield bases[number % len(bases)], shifts[number % len(bases)]
