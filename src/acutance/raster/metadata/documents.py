"""From a file beside an image to what it says: its content decides which reader knows it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from acutance.errors import ImageError
from acutance.raster.metadata import (
    digital_globe,
    dimap,
    gaofen,
    kompsat,
    landsat,
    planetscope,
    sentinel2,
    stac_item,
)
from acutance.raster.metadata.findings import Findings
from acutance.raster.metadata.odl import parse_odl
from acutance.raster.metadata.xml_document import parse_xml

__all__ = ["read_document"]

_MAX_BYTES = 64 * 2**20
_GDAL_OWN = ("PAMDataset", "VRTDataset")


def read_document(path: Path, image: str, *, stated: bool = False) -> Findings:
    """What a document says of an image; one that cannot be read, or is of another, is a note.

    Parameters
    ----------
    path : Path
    image : str
        Name of the image file.
    stated : bool, optional
        The user named the document: it is of this image, whatever names stand in it.

    Raises
    ------
    ImageError
        If the user named it, and there is no such file.
    """
    source = path.name
    if stated and not path.is_file():
        raise ImageError(
            f"{path} was named as a document of {image}, and there is no such file: correct its "
            "name (metadata, --metadata), or name none"
        )
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise ValueError("it is far larger than metadata are")
        content = path.read_bytes()
        return _read(content, source, image, stated)
    except (OSError, ValueError, RecursionError) as error:
        return Findings(notes=(f"{source} cannot be read ({_reason(error)}): it is left out",))


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error)[:160] or type(error).__name__


def _read(content: bytes, source: str, image: str, stated: bool) -> Findings:
    begin = content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    if begin == b"{" or source.lower().endswith(".json"):
        return _read_json(content, source, image, stated)
    if begin == b"<" or content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return _read_xml(parse_xml(content), source, image, stated)
    groups = parse_odl(content)
    if digital_globe.is_imd(groups):
        return digital_globe.read_imd(groups, source)
    if any(name in groups for name in landsat.ROOTS):
        return landsat.read_mtl(groups, source, image)
    return _unknown(source)


def _read_json(content: bytes, source: str, image: str, stated: bool) -> Findings:
    document = json.loads(content.decode("utf-8-sig"))
    if not isinstance(document, Mapping):
        return _unknown(source)
    if any(name in document for name in landsat.ROOTS):
        return landsat.read_mtl(document, source, image)
    if not stac_item.is_stac_item(document):
        return _unknown(source)
    if not stated and not stac_item.names_image(document, image) and not _same(source, image):
        return Findings(notes=(f"{source} is a STAC item without an asset {image}: not taken",))
    return stac_item.read_stac_item(document, source, image)


def _same(source: str, image: str) -> bool:
    """Whether a document is called as the image is."""
    return source.partition(".")[0].lower() == image.partition(".")[0].lower()


def _read_xml(root: Element, source: str, image: str, stated: bool) -> Findings:
    if root.tag in _GDAL_OWN:
        return Findings()
    if root.tag == "Dimap_Document":
        names = dimap.image_names(root)
        stems = {Path(name).stem.lower() for name in names}
        own = Path(image).stem.lower()
        if not (stated or own in stems or not names or _same(source, image)):
            return Findings(notes=(f"{source} is about {names[0]}, not {image}: not taken",))
        return dimap.read_dimap(root, source)
    if root.tag == "isd":
        return digital_globe.read_imd(digital_globe.imd_of_xml(root), source)
    if root.tag in landsat.ROOTS:
        return landsat.read_mtl(landsat.groups_of_xml(root), source, image)
    reader = _BY_NAME.get(root.tag)
    if reader is not None:
        return reader(root, source, image)
    return _unknown(source)


_BY_NAME: dict[str, Callable[[Any, str, str], Findings]] = {
    "Auxiliary": kompsat.read_kompsat,
    "EarthObservation": lambda root, source, _: planetscope.read_planetscope(root, source),
    "ProductMetaData": lambda root, source, _: gaofen.read_gaofen(root, source),
    **dict.fromkeys(sentinel2.TILE_ROOTS, sentinel2.read_tile),
    **dict.fromkeys(sentinel2.PRODUCT_ROOTS, sentinel2.read_product),
}


def _unknown(source: str) -> Findings:
    return Findings(notes=(f"{source} is of a kind that is not known: it is left out",))
