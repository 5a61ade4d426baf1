"""GeoJSON files: their polygons and points as written, and the CRS they declare.

Coordinates stay (x, y) as in the file; `acutance.raster.coordinates` relates them to an image.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import RegionError

__all__ = ["declared_crs", "load_geojson", "points", "polygons"]


_NOTHING = "no geometry: draw the target as a Polygon"


def load_geojson(name: str) -> dict[str, Any]:
    """The object in a GeoJSON file.

    Raises
    ------
    RegionError
        If the file cannot be read, or holds no JSON object.
    """
    try:
        document = json.loads(Path(name).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise RegionError(
            f"{name} cannot be read ({error.strerror or error}): name a GeoJSON file"
        ) from error
    except (ValueError, RecursionError) as error:
        raise RegionError(
            f"{name} cannot be read as GeoJSON ({error}): give a file of GeoJSON"
        ) from error
    if not isinstance(document, dict):
        raise RegionError(
            f"{name} holds a {type(document).__name__}, not a GeoJSON object: export it again"
        )
    return document


def declared_crs(document: Mapping[str, Any], name: str) -> str | None:
    """The CRS in the "crs" member: its name, or the member itself if it is a text.

    Returns
    -------
    str or None
        ``None`` without such a member.

    Raises
    ------
    RegionError
        If there is one, but without a name.
    """
    member = document.get("crs")
    if member is None or isinstance(member, str):
        return member
    properties = member.get("properties") if isinstance(member, Mapping) else None
    crs = properties.get("name") if isinstance(properties, Mapping) else None
    if not isinstance(crs, str):
        raise RegionError(
            f'{name} has a "crs" without a name: write "crs": "EPSG:32631", or "crs": "pixel" '
            "for rows and columns"
        )
    return crs


def polygons(document: dict[str, Any], name: str) -> dict[str, list[Floats] | str]:
    """The polygons of a file in its order, each by its name, and what is none.

    Parameters
    ----------
    document : dict
        Polygon, MultiPolygon, Feature, FeatureCollection or GeometryCollection.
    name : str
        Of the file, for messages.

    Returns
    -------
    dict
        The rings of each polygon, outline first, as (n, 2) arrays of (x, y); of other geometry, or
        none, the reason why it is no region. The name is that of the feature
        (``properties.name``, else ``id``), else its number in the file; a name that stands there
        twice gets a number.

    Raises
    ------
    RegionError
        If there is no polygon, or what is no GeoJSON.
    """
    found: dict[str, list[Floats] | str] = {}
    for label, rings in _polygons(document, name):
        if not isinstance(rings, str) and not (isinstance(rings, list) and rings):
            raise RegionError(f"{name} holds a polygon without coordinates: draw the target again")
        found[_unused(label, found)] = (
            rings if isinstance(rings, str) else [_ring(ring, name) for ring in rings]
        )
    others = [one for one in found.values() if isinstance(one, str)]
    if len(others) == len(found):
        drawn = next((one for one in others if one != _NOTHING), None)
        raise RegionError(
            f"{name} holds no polygon: draw every target as a Polygon"
            if drawn is None
            else f"{name} holds {drawn}"
        )
    return found


def points(document: dict[str, Any], name: str) -> Floats:
    """The Points and MultiPoints of a file, (n, 2) as (x, y); other geometry is passed over.

    Raises
    ------
    RegionError
        If a point is not two finite numbers.
    """
    try:
        pairs = [(float(one[0]), float(one[1])) for one in _points(document)]
    except (TypeError, ValueError, IndexError) as error:
        raise RegionError(f"{name} holds a Point without two numbers: write [x, y]") from error
    if not np.isfinite(pairs).all():
        raise RegionError(f"{name} holds a Point that is NaN or infinite: remove it")
    return np.array(pairs).reshape(-1, 2)


def _unused(label: str, used: dict[str, Any]) -> str:
    number, free = 1, label
    while free in used:
        number += 1
        free = f"{label} ({number})"
    return free


def _polygons(node: Any, name: str, label: str = "") -> Iterator[tuple[str, Any]]:
    """Every geometry below a GeoJSON object: what to call it, and its coordinates.

    Of one that is no polygon the reason instead.
    """
    if node is None:
        yield label or "geometry", _NOTHING
        return
    if not isinstance(node, dict):
        raise RegionError(f"{name} holds {node!r:.40} where GeoJSON has an object: export it again")
    kind = node.get("type")
    if kind == "FeatureCollection":
        for number, feature in enumerate(_members(node, "features", name), start=1):
            yield from _polygons(feature, name, f"feature {number}")
    elif kind == "Feature":
        yield from _polygons(node.get("geometry"), name, _title(node) or label)
    elif kind == "GeometryCollection":
        for number, geometry in enumerate(_members(node, "geometries", name), start=1):
            yield from _polygons(geometry, name, f"{label} geometry {number}".strip())
    elif kind == "MultiPolygon":
        for number, part in enumerate(_members(node, "coordinates", name), start=1):
            yield f"{label} part {number}".strip(), part
    elif kind == "Polygon":
        yield label or "polygon", node.get("coordinates")
    elif kind is None:
        raise RegionError(
            f"{name} is no GeoJSON: what it holds has no type; give a Polygon, a Feature or a "
            "FeatureCollection"
        )
    else:
        yield (
            label or str(kind),
            f"a {kind!r}, which has no inside: draw the target as a Polygon",
        )


def _title(feature: dict[str, Any]) -> str | None:
    """The name of a feature as its author gave it."""
    properties = feature.get("properties")
    own = properties if isinstance(properties, dict) else {}
    for title in (own.get("name"), feature.get("id"), own.get("id")):
        if isinstance(title, str | int) and str(title).strip():
            return str(title).strip()
    return None


def _members(node: dict[str, Any], key: str, name: str) -> list[Any]:
    members = node.get(key)
    if not isinstance(members, list):
        raise RegionError(f"{name} holds a {node['type']} without a list of {key}: export it again")
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


def _points(document: Any) -> Iterator[Any]:
    """Coordinates of all Points of a GeoJSON document."""
    if not isinstance(document, dict):
        return
    kind = document.get("type")
    if kind == "FeatureCollection":
        for feature in document.get("features") or []:
            yield from _points(feature)
    elif kind == "Feature":
        yield from _points(document.get("geometry"))
    elif kind == "GeometryCollection":
        for geometry in document.get("geometries") or []:
            yield from _points(geometry)
    elif kind == "Point":
        yield document.get("coordinates")
    elif kind == "MultiPoint":
        yield from document.get("coordinates") or []
