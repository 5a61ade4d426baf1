"""Auxiliary documents of KOMPSAT-2, 3 and 3A."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.times import utc_time
from acutance.raster.metadata.xml_document import text_at
from acutance.raster.restored_tag import OF_RESTORED

__all__ = ["read_kompsat"]


def read_kompsat(root: Element, source: str, image: str) -> Findings:
    """What an Auxiliary document says of one of its images, at its middle line.

    Parameters
    ----------
    root : Element
        Auxiliary.
    source, image : str
        Names of the files; of several images in the document the one of that name.
    """
    level = text_at(root, "General/ProductLevel")
    general = {
        "sensor": (word(text_at(root, "General/Satellite")), "Satellite"),
        "level": (level, "ProductLevel"),
    }
    block = _block(root, image)
    if block is None:
        return find(source, general, notes=(f"{source} has no image of the name {image}",))
    time = utc_time(text_at(block, "ImagingTime/ImagingCenterTime/UTC"))
    on_map = level is not None and level.strip().upper().endswith("G")
    gsd_place = "ImageGSD" if on_map else "CollectedGSD"
    row, col = (number(text_at(block, f"{gsd_place}/{one}")) for one in ("Row", "Column"))
    zenith = number(text_at(block, "Angle/Incidence"))
    return find(
        source,
        {
            **general,
            "acquired": (time, f"{block.tag}/ImagingCenterTime"),
            "bands": (word(text_at(block, "ImageColor")) and (str(block.tag),), "Image"),
            "gsd_m": (None if not (row and col) else (row, col), f"{block.tag}/{gsd_place}"),
            "view_zenith_deg": (zenith, f"{block.tag}/Incidence"),
            "view_azimuth_deg": (number(text_at(block, "Angle/Azimuth")), f"{block.tag}/Azimuth"),
        },
        notes=_notes(root, source),
        centre=lon_lat(
            text_at(block, "ImagingCoordinates/ImageGeogCenter/Longitude"),
            text_at(block, "ImagingCoordinates/ImageGeogCenter/Latitude"),
        ),
    )  # fmt: skip


def _block(root: Element, image: str) -> Element | None:
    """The part of the document about an image; the only one, whatever the image is called."""
    blocks = [one for one in root.findall("Image/*") if one.find("ImageFileName") is not None]
    stem = image.rpartition(".")[0].lower()
    own = [
        one
        for one in blocks
        if (text_at(one, "ImageFileName") or "").rpartition(".")[0].lower() == stem
    ]
    return own[0] if own else blocks[0] if len(blocks) == 1 else None


def _notes(root: Element, source: str) -> tuple[str, ...]:
    """What is not taken, and what was done to the pixels."""
    notes = []
    if root.find(".//MetadataBlock/SunAngle") is not None:
        notes.append(
            f"{source}: SunAngle is that of the point below the satellite, not of the image: the "
            "sun's angles stay empty"
        )
    if (text_at(root, "General/ApplyMTFC") or "").lower() == "true":
        notes.append(f"{source}: ApplyMTFC is true: {OF_RESTORED}")
    return tuple(notes)
