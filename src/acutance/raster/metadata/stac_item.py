"""STAC items: what a catalogue says of an image, by its asset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.times import time_or_day

__all__ = ["is_stac_item", "names_image", "read_stac_item"]


def is_stac_item(document: Mapping[str, Any]) -> bool:
    """Whether a JSON document is a STAC item."""
    return document.get("type") == "Feature" and "stac_version" in document


def names_image(document: Mapping[str, Any], image: str) -> bool:
    """Whether an asset of an item is the image."""
    return _asset(document, image) is not None


def read_stac_item(document: Mapping[str, Any], source: str, image: str) -> Findings:
    """What an item says of the image that is one of its assets.

    What an asset states itself goes before the item's properties. view:incidence_angle is the
    zenith angle on the ground; view:off_nadir, at the satellite, is not taken.

    Parameters
    ----------
    document : mapping
    source, image : str
        Names of the files.
    """
    properties, asset = _mapping(document.get("properties")), _asset(document, image)
    own = {**properties, **(asset or {})}
    time, place = own.get("datetime"), "datetime"
    if time_or_day(time) is None:
        time, place = own.get("start_datetime"), "start_datetime"
    notes = () if asset is not None else (f"{source}: none of its assets is {image}",)
    gsd = number(own.get("gsd")) if asset is not None else None
    return find(
        source,
        {
            "sensor": (word(own.get("platform")), "platform"),
            "level": (word(own.get("processing:level")), "processing:level"),
            "acquired": (time_or_day(time), place),
            "bands": (_bands(asset), "bands"),
            "gsd_m": (None if gsd is None else (gsd, gsd), "gsd"),
            "view_zenith_deg": (number(own.get("view:incidence_angle")), "view:incidence_angle"),
            "view_azimuth_deg": (number(own.get("view:azimuth")), "view:azimuth"),
            "sun_elevation_deg": (number(own.get("view:sun_elevation")), "view:sun_elevation"),
            "sun_azimuth_deg": (number(own.get("view:sun_azimuth")), "view:sun_azimuth"),
        },
        notes=notes,
        centre=_centre(document.get("bbox")),
    )


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _asset(document: Mapping[str, Any], image: str) -> Mapping[str, Any] | None:
    """The asset whose file is the image."""
    for one in _mapping(document.get("assets")).values():
        link = str(_mapping(one).get("href", "")).partition("?")[0]
        if link.rpartition("/")[2] == image:
            return _mapping(one)
    return None


def _bands(asset: Mapping[str, Any] | None) -> tuple[str, ...] | None:
    """Names of the asset's bands, of STAC 1.1 or of the extension eo."""
    listed = None if asset is None else asset.get("bands") or asset.get("eo:bands")
    if not isinstance(listed, Sequence) or isinstance(listed, str):
        return None
    names = [word(_mapping(one).get("name")) for one in listed]
    known = tuple(name for name in names if name is not None)
    return known if known and len(known) == len(names) else None


def _centre(box: Any) -> tuple[float, float] | None:
    if not isinstance(box, Sequence) or len(box) not in (4, 6):
        return None
    half = len(box) // 2
    low, high = lon_lat(box[0], box[1]), lon_lat(box[half], box[half + 1])
    # A box over the antimeridian has its west east of its east.
    if low is None or high is None or high[0] < low[0]:
        return None
    return (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
