"""IMD files of DigitalGlobe and Maxar (QuickBird, WorldView, GeoEye), as text and in their XML."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number
from acutance.raster.metadata.times import utc_time

__all__ = ["imd_of_xml", "is_imd", "read_imd"]

_BANDS = {
    "P": ("P",),
    "N": ("N",),
    "RGB": ("R", "G", "B"),
    "NRG": ("N", "R", "G"),
    "BGRN": ("B", "G", "R", "N"),
    "MS1": ("B", "G", "R", "N"),
    "MS2": ("C", "Y", "RE", "N2"),
    "MULTI": ("C", "B", "G", "Y", "R", "RE", "N", "N2"),
}
"""What a bandId stands for, in the order of the file (Imagery Support Data, ISD)."""
_CORNERS = ("UL", "UR", "LR", "LL")


def is_imd(groups: Mapping[str, Any]) -> bool:
    """Whether a text of groups is an IMD file."""
    return "BANDID" in groups or "IMAGE_1" in groups


def read_imd(groups: Mapping[str, Any], source: str) -> Findings:
    """What an IMD file says, as a mean over the product.

    Parameters
    ----------
    groups : mapping
        As `parse_odl` returns them.
    source : str
        Name of the file.
    """
    image: Mapping[str, Any] = next(
        (group for name, group in sorted(groups.items()) if name.startswith("IMAGE_")), {}
    )
    bands, notes = _bands(groups, source)
    elevation = number(image.get("MEANSATEL"))
    gsd, gsd_place = _gsd(groups, image)
    return find(
        source,
        {
            "sensor": (image.get("SATID"), "satId"),
            "level": (groups.get("PRODUCTLEVEL"), "productLevel"),
            "acquired": _time(groups, image),
            "bands": (bands, "bandId"),
            "gsd_m": (gsd, gsd_place),
            "view_zenith_deg": (None if elevation is None else 90.0 - elevation, "meanSatEl"),
            "view_azimuth_deg": (number(image.get("MEANSATAZ")), "meanSatAz"),
            "sun_elevation_deg": (number(image.get("MEANSUNEL")), "meanSunEl"),
            "sun_azimuth_deg": (number(image.get("MEANSUNAZ")), "meanSunAz"),
        },
        notes=notes,
        centre=_centre(groups),
    )


def _time(groups: Mapping[str, Any], image: Mapping[str, Any]) -> tuple[Any, str]:
    """Of the first line; of a mosaic on a map its earliest acquisition."""
    product = groups.get("MAP_PROJECTED_PRODUCT", {})
    for group, name in (
        (image, "firstLineTime"),
        (image, "TLCTime"),
        (product, "earliestAcqTime"),
    ):
        found = utc_time(group.get(name.upper()) if isinstance(group, Mapping) else None)
        if found is not None:
            return found, name
    return None, ""


def _bands(
    groups: Mapping[str, Any], source: str
) -> tuple[tuple[str, ...] | None, tuple[str, ...]]:
    """The bands in the order of the file.

    The groups BAND_x stand in that order too, and decide; an eight-band product of an older
    version has the same bandId as one of four.
    """
    found = tuple(
        name.removeprefix("BAND_") for name, one in groups.items()
        if name.startswith("BAND_") and isinstance(one, Mapping)
    )  # fmt: skip
    name = str(groups.get("BANDID", "")).upper()
    if found:
        return found, ()
    if name and name not in _BANDS:
        return None, (f"{source}: bandId {name} is not known: bands stay empty",)
    return _BANDS.get(name), ()


def _gsd(groups: Mapping[str, Any], image: Mapping[str, Any]) -> tuple[Any, str]:
    """Of the product's pixels, rows and columns; the collected ones are those before resampling."""
    product = groups.get("MAP_PROJECTED_PRODUCT", {})
    spacing = number(product.get("PRODUCTGSD")) if isinstance(product, Mapping) else None
    if spacing is not None:
        return (spacing, spacing), "productGSD"
    row = number(image.get("MEANPRODUCTROWGSD"))
    col = number(image.get("MEANPRODUCTCOLGSD"))
    if row is not None and col is not None:
        return (row, col), "meanProductRowGSD, meanProductColGSD"
    return None, ""


def _centre(groups: Mapping[str, Any]) -> tuple[float, float] | None:
    """The mean of the first band's corners."""
    band = next((one for name, one in groups.items() if name.startswith("BAND_")), None)
    if not isinstance(band, Mapping):
        return None
    corners = [lon_lat(band.get(f"{one}LON"), band.get(f"{one}LAT")) for one in _CORNERS]
    known = [one for one in corners if one is not None]
    # The mean of longitudes on both sides of the antimeridian is nowhere.
    if len(known) < len(_CORNERS) or max(known)[0] - min(known)[0] > 180.0:
        return None
    return sum(lon for lon, _ in known) / 4, sum(lat for _, lat in known) / 4


def imd_of_xml(root: Element) -> dict[str, Any]:
    """The part IMD of the XML that has the same content, as groups."""
    found = root.find("IMD")
    return {} if found is None else _groups(found)


def _groups(element: Element) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in element:
        name = "IMAGE_1" if one.tag == "IMAGE" else one.tag.upper()
        found.setdefault(name, _groups(one) if len(one) else (one.text or "").strip())
    return found
