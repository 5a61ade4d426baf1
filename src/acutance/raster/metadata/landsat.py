"""MTL documents of Landsat, collections 1 and 2, as text, XML and JSON."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import date, datetime
from typing import Any
from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.times import time_or_day, utc_time

__all__ = ["ROOTS", "groups_of_xml", "read_mtl"]

ROOTS = ("LANDSAT_METADATA_FILE", "L1_METADATA_FILE")
_CORNERS = ("UL", "UR", "LR", "LL")
_PANCHROMATIC = {"8"}
_THERMAL = {"10", "11", "6_VCID_1", "6_VCID_2"}
_SURFACE_TEMPERATURE = "ST_B"
"""Of level 2: FILE_NAME_BAND_ST_B10 is what FILE_NAME_BAND_10 is of level 1."""


def read_mtl(document: Mapping[str, Any], source: str, image: str) -> Findings:
    """What an MTL document says of one of its images.

    The angle of view is none of it: ROLL_ANGLE is the spacecraft's.

    Parameters
    ----------
    document : mapping
        With one of the groups `ROOTS`.
    source, image : str
        Names of the files; the band is the one whose file the image is.
    """
    items = _flat(next((document[name] for name in ROOTS if name in document), document))
    band = _band(items, image)
    gsd, gsd_place = _gsd(items, band)
    return find(
        source,
        {
            "sensor": (word(items.get("SPACECRAFT_ID")), "SPACECRAFT_ID"),
            "level": _level(items),
            "acquired": _acquired(items),
            "bands": (_name(band), f"FILE_NAME_BAND_{band}"),
            "gsd_m": (gsd, gsd_place),
            "sun_elevation_deg": (number(items.get("SUN_ELEVATION")), "SUN_ELEVATION"),
            "sun_azimuth_deg": (number(items.get("SUN_AZIMUTH")), "SUN_AZIMUTH"),
        },
        centre=_centre(items),
    )  # fmt: skip


def _flat(group: Any) -> dict[str, Any]:
    """All items of all groups; of several with one name the first."""
    found: dict[str, Any] = {}
    for name, value in group.items() if isinstance(group, Mapping) else ():
        inner = _flat(value) if isinstance(value, Mapping) else {str(name): value}
        found = {**inner, **found}
    return found


def _band(items: Mapping[str, Any], image: str) -> str | None:
    """The band whose file is the image, as its item names it."""
    stem = image.rpartition(".")[0].upper()
    for name, value in items.items():
        found = re.match(r"FILE_NAME_BAND_(\w+)$", name)
        if found and str(value).rpartition(".")[0].upper() == stem:
            return found[1]
    return None


def _name(band: str | None) -> tuple[str, ...] | None:
    """A band has one name at all levels."""
    return None if band is None else (f"B{band.removeprefix(_SURFACE_TEMPERATURE)}",)


def _acquired(items: Mapping[str, Any]) -> tuple[datetime | date | None, str]:
    """The time of the scene's middle; the day where that is missing."""
    day, time = items.get("DATE_ACQUIRED"), items.get("SCENE_CENTER_TIME")
    found = utc_time(word(day, time, joined="T"))
    if found is None:
        return time_or_day(day), "DATE_ACQUIRED"
    return found, "DATE_ACQUIRED, SCENE_CENTER_TIME"


def _level(items: Mapping[str, Any]) -> tuple[str | None, str]:
    """In collection 1 and before DATA_TYPE was the level."""
    name = "PROCESSING_LEVEL" if "PROCESSING_LEVEL" in items else "DATA_TYPE"
    return word(items.get(name)), name


def _gsd(items: Mapping[str, Any], band: str | None) -> tuple[tuple[float, float] | None, str]:
    if band is None:
        return None, ""
    kind = "PANCHROMATIC" if band in _PANCHROMATIC else "REFLECTIVE"
    of_mapper = str(items.get("SPACECRAFT_ID", "")).endswith(("4", "5"))
    is_temperature = band.startswith(_SURFACE_TEMPERATURE)
    if is_temperature or band in _THERMAL or (band == "6" and of_mapper):
        kind = "THERMAL"
    size = number(items.get(f"GRID_CELL_SIZE_{kind}"))
    return (None if size is None else (size, size)), f"GRID_CELL_SIZE_{kind}"


def _centre(items: Mapping[str, Any]) -> tuple[float, float] | None:
    corners = [
        lon_lat(items.get(f"CORNER_{one}_LON_PRODUCT"), items.get(f"CORNER_{one}_LAT_PRODUCT"))
        for one in _CORNERS
    ]
    known = [one for one in corners if one is not None]
    if len(known) < len(_CORNERS) or max(known)[0] - min(known)[0] > 180.0:
        return None
    return sum(lon for lon, _ in known) / 4, sum(lat for _, lat in known) / 4


def groups_of_xml(root: Element) -> dict[str, Any]:
    """The XML form as groups."""
    return {root.tag: _groups(root)}


def _groups(element: Element) -> dict[str, Any]:
    return {one.tag: _groups(one) if len(one) else (one.text or "").strip() for one in element}
