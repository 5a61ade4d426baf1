"""Regions as a person writes them: four numbers, a box of longitudes, a GeoJSON file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.raster.geolocation import LONLAT_CRS
from acutance.raster.image import Image
from acutance.raster.region import Box, Region

__all__ = ["parse_roi"]

_PIXELS = "pixel"
_RECTANGLE = re.compile(r"^\s*-?\d+\s*(,\s*-?\d+\s*){3}$")
_FORMS = (
    "write ROW,COL,HEIGHT,WIDTH (pixels), lonlat:WEST,SOUTH,EAST,NORTH (degrees) "
    "or the path of a GeoJSON file"
)


def parse_roi(text: str, image: Image) -> Region:
    """The region a text asks for, in the pixels of an image.

    Parameters
    ----------
    text : str
        One of

        - ``ROW,COL,HEIGHT,WIDTH``: whole pixels, all inside the image; row and column from 0;
        - ``lonlat:WEST,SOUTH,EAST,NORTH``: degrees on WGS 84, carried into the image's CRS;
        - the path of a GeoJSON file with one polygon, bare or as Feature, FeatureCollection,
          GeometryCollection or MultiPolygon. Its coordinates are in the CRS of its "crs" member;
          the name "pixel" there means pixels. With no such member they are longitude and latitude
          (RFC 7946) if the image has a CRS, and pixels if it has none. In pixels x is the column
          and y the row, from 0, an integer being a pixel centre. Corners are carried over and
          joined by straight lines in the image.
    image : Image

    Returns
    -------
    Region
        With at least one pixel centre inside the image. A polygon may reach beyond it.

    Raises
    ------
    RegionError
        If the text is none of these, the file has no polygon or several, its coordinates cannot
        be related to the image, or the region holds none of the image's pixels.
    """
    if _RECTANGLE.match(text):
        box = Box(*(int(number) for number in text.split(",")))
        box.require_inside(image.shape)
        return Region.from_box(box)
    if text.startswith("lonlat:"):
        region = _lonlat_region(text.removeprefix("lonlat:"), image)
        region.box(image.shape)
        return region
    return _geojson_region(text, image)


def _lonlat_region(text: str, image: Image) -> Region:
    try:
        west, south, east, north = (float(number) for number in text.split(","))
    except ValueError:
        raise RegionError(f"the region 'lonlat:{text}' is not four numbers: {_FORMS}") from None
    if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
        raise RegionError(
            f"the region 'lonlat:{text}' is no box on the Earth: "
            "give -180 <= WEST < EAST <= 180 and -90 <= SOUTH < NORTH <= 90"
        )
    corners = np.array([[west, north], [east, north], [east, south], [west, south]])
    return Region(_to_pixels(corners, LONLAT_CRS, image))


def _geojson_region(name: str, image: Image) -> Region:
    document = _load_geojson(name)
    rings = _single_polygon(document, name)
    crs = _declared_crs(document, name)
    if crs is None and image.geolocation is None:
        return _bare_region(rings, image, name)
    if crs is None:
        crs = LONLAT_CRS
        _require_lonlat(rings[0], name)
    region = _region(rings, crs, image)
    region.box(image.shape)
    return region


def _bare_region(rings: list[Floats], image: Image, name: str) -> Region:
    """Coordinates that nobody says the meaning of, on an image without a CRS: pixels."""
    try:
        region = _region(rings, _PIXELS, image)
        region.box(image.shape)
    except RegionError as error:
        raise RegionError(
            f"{error}. The coordinates of {name} were read as pixels (x the column, y the row), "
            "as neither the file nor the image has a CRS: if they are longitudes and latitudes, "
            "use an image that has one"
        ) from None
    return region


def _region(rings: list[Floats], crs: str, image: Image) -> Region:
    outline, *holes = (_to_pixels(ring, crs, image) for ring in rings)
    return Region(outline, tuple(holes))


def _load_geojson(name: str) -> dict[str, Any]:
    path = Path(name)
    if not path.is_file():
        raise RegionError(
            f"the region {name!r} is neither numbers nor a file that exists: {_FORMS}"
        )
    try:
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise RegionError(
            f"{name} cannot be read as GeoJSON ({error}): write a file with one Polygon"
        ) from error
    if not isinstance(document, dict):
        raise RegionError(f"{name} holds a {type(document).__name__}, not a GeoJSON object")
    return document


def _single_polygon(document: dict[str, Any], name: str) -> list[Floats]:
    """The rings of the only polygon, as (n, 2) arrays of (x, y)."""
    polygons = list(_polygons(document, name))
    if not polygons:
        raise RegionError(f"{name} holds no polygon: draw the target as one Polygon")
    if len(polygons) > 1:
        labels = ", ".join(label for label, _ in polygons[:10])
        raise RegionError(
            f"{name} holds {len(polygons)} polygons ({labels}), and a region is one target: "
            "keep one polygon in a file"
        )
    rings = polygons[0][1]
    if not isinstance(rings, list) or not rings:
        raise RegionError(f"{name} holds a polygon without coordinates: draw the target again")
    return [_ring(ring, name) for ring in rings]


def _polygons(node: Any, name: str, label: str = "") -> Iterator[tuple[str, Any]]:
    """Every polygon below a GeoJSON object: what to call it, and its coordinates."""
    if node is None:
        return
    if not isinstance(node, dict):
        raise RegionError(f"{name} holds {node!r:.40} where GeoJSON has an object")
    kind = node.get("type")
    if kind == "FeatureCollection":
        for number, feature in enumerate(_members(node, "features", name), start=1):
            yield from _polygons(feature, name, f"feature {number}")
    elif kind == "Feature":
        properties = node.get("properties")
        title = properties.get("name") if isinstance(properties, dict) else None
        yield from _polygons(node.get("geometry"), name, str(title) if title else label)
    elif kind == "GeometryCollection":
        for number, geometry in enumerate(_members(node, "geometries", name), start=1):
            yield from _polygons(geometry, name, f"{label} geometry {number}".strip())
    elif kind == "MultiPolygon":
        for number, part in enumerate(_members(node, "coordinates", name), start=1):
            yield f"{label} part {number}".strip(), part
    elif kind == "Polygon":
        yield label or "polygon", node.get("coordinates")
    else:
        raise RegionError(
            f"{name} holds a {kind!r}, which has no inside: draw the target as a Polygon"
        )


def _members(node: dict[str, Any], key: str, name: str) -> list[Any]:
    members = node.get(key)
    if not isinstance(members, list):
        raise RegionError(f"{name} holds a {node['type']} without a list of {key}")
    return members


def _ring(ring: Any, name: str) -> Floats:
    try:
        corners = np.array([[float(x), float(y)] for x, y, *_ in ring])
    except (TypeError, ValueError):
        raise RegionError(
            f"{name} holds a polygon whose corners are not pairs of numbers: draw it again"
        ) from None
    if not np.isfinite(corners).all():
        raise RegionError(
            f"{name} holds a polygon with a corner that is NaN or infinite: draw it again"
        )
    return corners


def _declared_crs(document: dict[str, Any], name: str) -> str | None:
    """The name in the "crs" member; ``None`` without one."""
    member = document.get("crs")
    if member is None:
        return None
    properties = member.get("properties") if isinstance(member, dict) else None
    crs = properties.get("name") if isinstance(properties, dict) else None
    if not isinstance(crs, str):
        raise RegionError(
            f'{name} has a "crs" without a name: write '
            '"crs": {"type": "name", "properties": {"name": "EPSG:32631"}}, or "pixel" as the name'
        )
    return crs


def _require_lonlat(outline: Floats, name: str) -> None:
    x, y = np.abs(outline).T
    if (x > 180.0).any() or (y > 90.0).any():
        raise RegionError(
            f"{name} has the corner {outline[0, 0]:g}, {outline[0, 1]:g}, which is no longitude "
            'and latitude, and no "crs" member: add '
            '"crs": {"type": "name", "properties": {"name": "EPSG:32631"}} with the CRS of the '
            'coordinates, or "pixel" as the name'
        )


def _to_pixels(points: Floats, crs: str, image: Image) -> Floats:
    """Points (x, y) in a CRS, or in pixels, as (row, col)."""
    if crs.lower() == _PIXELS:
        return points[:, ::-1]
    if image.geolocation is None:
        raise RegionError(
            f"the region is in {crs}, but the image has no CRS to find it by: "
            "give it in pixels, ROW,COL,HEIGHT,WIDTH"
        )
    row, col = image.geolocation.from_crs(points[:, 0], points[:, 1], crs)
    if not (np.isfinite(row).all() and np.isfinite(col).all()):
        raise RegionError(
            f"the region cannot be carried from {crs} to the image's CRS: it is too far away; "
            "choose a region inside the image"
        )
    return np.column_stack([row, col])
