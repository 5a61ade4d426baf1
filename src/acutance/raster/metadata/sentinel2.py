"""Sentinel-2 metadata: of a granule (MTD_TL.xml) and of the product (MTD_MSIL1C.xml, L2A)."""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, number, word
from acutance.raster.metadata.times import utc_time
from acutance.raster.metadata.xml_document import text_at

__all__ = ["PRODUCT_ROOTS", "TILE_ROOTS", "read_product", "read_tile"]

TILE_ROOTS = ("Level-1C_Tile_ID", "Level-2A_Tile_ID")
PRODUCT_ROOTS = ("Level-1C_User_Product", "Level-2A_User_Product")

_BANDS = ("B01", "B02", "B03", "B04", "B05", "B06", "B07", "B08", "B8A", "B09", "B10", "B11", "B12")
"""By bandId, 0 to 12."""
_BAND = re.compile(r"_(B\d\d|B8A)(?=[_.]|$)")
_TILE = re.compile(r"(?:^|_)(T\d\d[A-Z]{3})_")


def read_tile(root: Element, source: str, image: str) -> Findings:
    """What a granule's document says of one of its images.

    Parameters
    ----------
    root : Element
    source, image : str
        Names of the files; the band is that of the image's name, as the format has it.
    """
    identity = text_at(root, "General_Info/TILE_ID") or ""
    own, stated = _TILE.search(f"{image}_"), _TILE.search(identity)
    if own and stated and own[1] != stated[1]:
        return _of_another(source, stated[1], own[1])
    band = _band(image)
    angles = root.find("Geometric_Info/Tile_Angles")
    view = _view(angles, band)
    zenith = number(text_at(angles, "Mean_Sun_Angle/ZENITH_ANGLE"))
    mean = "Mean_Viewing_Incidence_Angle"
    return find(
        source,
        {
            "level": (_level(root), root.tag),
            "acquired": (utc_time(text_at(root, "General_Info/SENSING_TIME")), "SENSING_TIME"),
            "bands": (None if band is None else (band,), "TILE_ID and the image's name"),
            "view_zenith_deg": (number(text_at(view, "ZENITH_ANGLE")), mean),
            "view_azimuth_deg": (number(text_at(view, "AZIMUTH_ANGLE")), mean),
            "sun_elevation_deg": (None if zenith is None else 90.0 - zenith, "Mean_Sun_Angle"),
            "sun_azimuth_deg": (
                number(text_at(angles, "Mean_Sun_Angle/AZIMUTH_ANGLE")),
                "Mean_Sun_Angle",
            ),
        },
    )


def read_product(root: Element, source: str, image: str) -> Findings:
    """What the product's document says: the time is that at which its datatake began.

    Parameters
    ----------
    root : Element
    source, image : str
        Names of the files.
    """
    info = root.find("General_Info/Product_Info")
    uri, own = text_at(info, "PRODUCT_URI") or "", _TILE.search(f"{image}_")
    stated = _TILE.search(uri)
    if own and stated and own[1] != stated[1]:
        return _of_another(source, stated[1], own[1])
    band = _band(image)
    return find(
        source,
        {
            "sensor": (word(text_at(info, "Datatake/SPACECRAFT_NAME")), "SPACECRAFT_NAME"),
            "level": (text_at(info, "PROCESSING_LEVEL"), "PROCESSING_LEVEL"),
            "datatake": (utc_time(text_at(info, "PRODUCT_START_TIME")), "PRODUCT_START_TIME"),
            "bands": (None if band is None else (band,), "PRODUCT_URI and the image's name"),
            "gsd_m": (_gsd(root, band), "RESOLUTION"),
        },
    )


def _band(image: str) -> str | None:
    found = _BAND.search(image.upper())
    return found[1] if found and found[1] in _BANDS else None


def _level(root: Element) -> str:
    return root.tag.removesuffix("_Tile_ID")


def _of_another(source: str, stated: str, own: str) -> Findings:
    return Findings(notes=(f"{source} is of tile {stated}, the image of {own}: not taken",))


def _gsd(root: Element, band: str | None) -> tuple[float, float] | None:
    """Of the band as level 1C has it; what level 2A resamples has another geotransform."""
    for one in root.iter("Spectral_Information"):
        if band is not None and one.get("bandId") == str(_BANDS.index(band)):
            metres = number(text_at(one, "RESOLUTION"))
            return None if metres is None else (metres, metres)
    return None


def _view(angles: Element | None, band: str | None) -> Element | None:
    """The mean viewing angles of a band."""
    if angles is None or band is None:
        return None
    wanted = str(_BANDS.index(band))
    for one in angles.iter("Mean_Viewing_Incidence_Angle"):
        if one.get("bandId") == wanted:
            return one
    return None
