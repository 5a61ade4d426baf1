"""DIMAP documents of Airbus: Pleiades, Pleiades Neo, SPOT 6 and 7."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.times import time_or_day
from acutance.raster.metadata.xml_document import text_at
from acutance.raster.restored_tag import OF_RESTORED

__all__ = ["image_names", "read_dimap"]


def read_dimap(root: Element, source: str) -> Findings:
    """What a DIMAP document says of its product, at the product's centre.

    Parameters
    ----------
    root : Element
        Dimap_Document.
    source : str
        Name of the file.
    """
    strip = root.find(".//Strip_Source")
    centre = _centre(root)
    sun, angles = "Solar_Incidences/", "Acquisition_Angles/"
    time, place = text_at(centre, "TIME"), "TIME (Center)"
    if time is None:
        time, place = _strip_time(strip)
    gsd, gsd_place = _gsd(root, centre)
    zenith = number(text_at(centre, angles + "INCIDENCE_ANGLE"))
    return find(
        source,
        {
            "sensor": (
                word(text_at(strip, "MISSION"), text_at(strip, "MISSION_INDEX"), joined=""),
                "MISSION, MISSION_INDEX",
            ),
            "level": (text_at(root, ".//Product_Settings/PROCESSING_LEVEL"), "PROCESSING_LEVEL"),
            "acquired": (time_or_day(time), place),
            "bands": (_bands(root), "BAND_ID"),
            "gsd_m": (gsd, gsd_place),
            "view_zenith_deg": (zenith, "INCIDENCE_ANGLE"),
            "sun_elevation_deg": (number(text_at(centre, sun + "SUN_ELEVATION")), "SUN_ELEVATION"),
            "sun_azimuth_deg": (number(text_at(centre, sun + "SUN_AZIMUTH")), "SUN_AZIMUTH"),
        },
        notes=_notes(root, centre, source),
        centre=lon_lat(
            text_at(root, ".//Dataset_Extent/Center/LON"),
            text_at(root, ".//Dataset_Extent/Center/LAT"),
        ),
    )  # fmt: skip


def image_names(root: Element) -> list[str]:
    """The image files the document is of."""
    found = (one.get("href") for one in root.iter("DATA_FILE_PATH"))
    return [name.replace("\\", "/").rpartition("/")[2] for name in found if name]


def _centre(root: Element) -> Element | None:
    """The geometric values at the product's centre."""
    for one in root.iter("Located_Geometric_Values"):
        if (text_at(one, "LOCATION_TYPE") or "").lower() == "center":
            return one
    return None


def _strip_time(strip: Element | None) -> tuple[str | None, str]:
    """Of a strip without a time the day."""
    day, time = text_at(strip, "IMAGING_DATE"), text_at(strip, "IMAGING_TIME")
    if time is None:
        return day, "IMAGING_DATE"
    return word(day, time, joined="T"), "IMAGING_DATE, IMAGING_TIME"


def _notes(root: Element, centre: Element | None, source: str) -> tuple[str, ...]:
    """What is not taken, and what was done to the pixels."""
    notes = []
    if text_at(centre, "Acquisition_Angles/AZIMUTH_ANGLE") is not None:
        notes.append(
            f"{source}: AZIMUTH_ANGLE is the direction of the scan, not of the satellite: "
            "the view azimuth stays empty"
        )
    for name in ("PAN_RESTORATION", "MS_RESTORATION"):
        if (text_at(root, f".//MTF_Settings/{name}") or "").lower() == "true":
            notes.append(f"{source}: {name} is true: {OF_RESTORED}")
    return tuple(notes)


def _bands(root: Element) -> tuple[str, ...] | None:
    """The bands in the order of the file: the one of a single band, or as stated by index."""
    indexed = [
        (int(index), name)
        for one in root.iter("Raster_Index")
        if (index := text_at(one, "BAND_INDEX") or "").isdecimal()
        and (name := text_at(one, "BAND_ID")) is not None
    ]
    if indexed:
        return tuple(name for _, name in sorted(indexed))
    names = dict.fromkeys(text_at(one, ".") for one in root.iter("BAND_ID"))
    alone = [name for name in names if name]
    return tuple(alone) if len(alone) == 1 else None


def _gsd(root: Element, centre: Element | None) -> tuple[tuple[float, float] | None, str]:
    """Of the map grid; of an image in sensor geometry at the centre, rows being along track."""
    insert = root.find(".//Geoposition_Insert")
    row, col = number(text_at(insert, "YDIM")), number(text_at(insert, "XDIM"))
    if row and col and _is_in_metres(root):
        return (abs(row), abs(col)), "YDIM, XDIM"
    distance = None if centre is None else centre.find("Ground_Sample_Distance")
    row = number(text_at(distance, "GSD_ALONG_TRACK"))
    col = number(text_at(distance, "GSD_ACROSS_TRACK"))
    if insert is None and row and col:
        return (row, col), "GSD_ALONG_TRACK, GSD_ACROSS_TRACK"
    return None, ""


def _is_in_metres(root: Element) -> bool:
    return root.find(".//Projected_CRS") is not None
