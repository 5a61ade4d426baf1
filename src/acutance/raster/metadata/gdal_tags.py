"""Tags of the image file itself, as GDAL reads them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from acutance.raster.metadata.findings import Findings, find, number, word
from acutance.raster.metadata.gml import read_gml
from acutance.raster.metadata.times import has_zone, is_day, time_or_day
from acutance.raster.pixels import is_npy
from acutance.raster.restored_tag import OF_RESTORED, RESTORED_TAG

__all__ = ["FileTags", "file_tags", "read_tags"]

_NAMES = {
    "sensor": ("SATELLITEID", "SENSOR", "PLATFORM", "SPACECRAFT_NAME", "SPACECRAFT_ID"),
    "level": ("PROCESSING_LEVEL", "PRODUCT_LEVEL"),
    "acquired": (
        "ACQUISITIONDATETIME", "ACQUISITION_DATETIME", "ACQUISITION_TIME", "SENSING_TIME",
        "NITF_IDATIM", "ACQUISITION_DATE", "DATE_ACQUIRED", "SENSING_DATE",
    ),
    "view_zenith_deg": ("VIEW_ZENITH",),
    "view_azimuth_deg": ("VIEW_AZIMUTH",),
    "sun_elevation_deg": ("SUN_ELEVATION",),
    "sun_azimuth_deg": ("SUN_AZIMUTH",),
}  # fmt: skip
"""Tags that say a field, the first goes before the others."""
_UTC = ("ACQUISITIONDATETIME", "NITF_IDATIM")
"""In UTC by definition: of GDAL's domain IMAGERY, and of the NITF."""
_DOMAINS = ("", "IMAGERY")
_FILE_TIMES = ("TIFFTAG_DATETIME", "NITF_FDT", "EXIF_DateTime")
_NITF_DEFAULT = "20021216151629"
"""What GDAL writes as the time of a NITF image where none was given."""
_GML = ("gml.root-instance", "xml:gml.root-instance")


@dataclass(frozen=True)
class FileTags:
    """What an image file carries beside its pixels.

    Parameters
    ----------
    tags : mapping of str to str
        Of the file, those of GDAL's domain IMAGERY among them.
    band_tags : sequence of mapping
        Of every band.
    descriptions : sequence of (str or None)
        Of every band.
    """

    tags: Mapping[str, str] = field(default_factory=dict)
    band_tags: Sequence[Mapping[str, str]] = ()
    descriptions: Sequence[str | None] = ()


def file_tags(path: str) -> FileTags:
    """The tags of an image file; none of an array.

    Raises
    ------
    ImageError
        If the file cannot be read.
    """
    if is_npy(path):
        return FileTags()
    from acutance.raster.dataset import opened_dataset

    with opened_dataset(path) as dataset:
        tags: dict[str, str] = {}
        for domain in _DOMAINS:
            tags.update(dataset.tags(ns=domain) if domain else dataset.tags())
        tags.update(dataset.tags(ns="xml:gml.root-instance"))
        bands = range(1, dataset.count + 1)
        return FileTags(tags, [dataset.tags(one) for one in bands], list(dataset.descriptions))


def read_tags(found: FileTags, source: str) -> Findings:
    """What the tags say; the time at which the file was written is no time of acquisition.

    Parameters
    ----------
    found : FileTags
    source : str
        Name of the file.
    """
    tags = {name.upper(): text.strip() for name, text in found.tags.items()}
    said: dict[str, tuple[Any, str]] = {}
    for field_name, names in _NAMES.items():
        name = next((one for one in names if tags.get(one)), None)
        if name is not None:
            said[field_name] = (_value(field_name, tags[name]), f"tag {name}")
    said["bands"] = _bands(found)
    gml = next((read_gml(tags[one.upper()], source) for one in _GML if one.upper() in tags), None)
    notes = (*_notes(tags, source, said), *(gml.notes if gml else ()))
    own = find(source, said, notes=notes)
    return Findings({**(gml.values if gml else {}), **own.values}, own.notes)


def _value(name: str, text: str) -> Any:
    if name == "acquired":
        return None if text == _NITF_DEFAULT else time_or_day(text)
    return number(text) if name.endswith("_deg") else text


def _notes(tags: Mapping[str, str], source: str, said: Mapping[str, tuple[Any, str]]) -> list[str]:
    notes = []
    time, place = said.get("acquired", (None, ""))
    name = place.removeprefix("tag ")
    if name and time is None:
        why = "GDAL's default" if tags[name] == _NITF_DEFAULT else "no date"
        notes.append(f"{source}: tag {name}, {tags[name][:40]}, is {why}: not taken")
    elif name and is_day(time):
        notes.append(f"{source}: tag {name} names a day and no time")
    elif name and name not in _UTC and not has_zone(tags[name]):
        notes.append(f"{source}: tag {name} names no time zone: taken as UTC")
    notes.extend(
        f"{source}: tag {name}, {tags[name][:40]}, is when the file was written: not taken"
        for name in _FILE_TIMES
        if tags.get(name)
    )
    if tags.get(RESTORED_TAG):
        notes.append(f"{source}: tag {RESTORED_TAG}, {tags[RESTORED_TAG]}: {OF_RESTORED}")
    return notes


def _bands(found: FileTags) -> tuple[tuple[str, ...] | None, str]:
    """Names of all bands, or of none."""
    described = [word(name) for name in found.descriptions]
    if described and all(described):
        return tuple(str(name) for name in described), "descriptions of the bands"
    tagged = [word(tags.get("BANDNAME")) for tags in found.band_tags]
    if tagged and all(tagged):
        return tuple(str(name) for name in tagged), "tag BANDNAME"
    return None, ""
