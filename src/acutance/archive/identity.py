"""What makes an entry, an image or a target the same as one that is kept already.

The key of an entry is a digest of its image, band, region, target, kind, method and options, of
where in the region the target was found, to whole pixels (a region may hold several edges), and of
what was stated about image and target: the axis along track, the GSD, the width of a pulse. The
image counts by its content. Where that is not known, its file name without folders and the main
numbers of the measurement stand for it: many images have the same name. The numbers count, too,
where more than one image is measured. When the measurement was made, and by which version, does not
count.

Keys of version 0.1 did not hold what was stated. Archives and documents have them still: an entry
is there under such a key as well (`Keys.older`) if that measurement has the same statements.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from datetime import date
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any, NamedTuple

import numpy as np

from acutance.archive.dates import as_utc
from acutance.archive.entry import Entry, ImageEntry, TargetEntry
from acutance.curves import METRICS
from acutance.targets.record import Record

__all__ = [
    "Keys", "Stated", "file_name", "image_identity", "key_of", "keys_of", "stated_of",
    "target_identity",
]  # fmt: skip

Stated = Mapping[str, Any]
"""By name: what was stated of a measurement, and what tells it apart if its image does not."""

_DIGITS = 6
"""Significant digits of the numbers that identify a measurement whose image is not known."""
_OF_SEVERAL_IMAGES = ("biresolution", "combined")


class Keys(NamedTuple):
    """The key of an entry, and the one that version 0.1 would have given it, if that is another."""

    own: str
    older: str | None = None


def key_of(entry: Entry) -> str:
    """The key of an entry: its own, or a digest of 64 hexadecimal digits."""
    return keys_of(entry).own


def keys_of(entry: Entry) -> Keys:
    """The keys of an entry: the one it states, unless that was derived by an older version."""
    parts = _parts(entry)
    older = _digest(parts)
    if entry.record is None:
        return Keys(older if entry.key is None else entry.key)
    own = _digest(parts | {"stated": stated_of(entry.record)})
    return Keys(own, older) if entry.key in (None, own, older) else Keys(entry.key)


def stated_of(record: Record) -> Stated:
    """What tells measurements of one region, method and options apart, of one image.

    What a document of an older version does not hold is left out.
    """
    document, image = record.document, record.image
    gsd = image.pixel_gsd_m
    found: dict[str, Any] = {
        "along_track": image.along_track,
        "gsd_m": None if gsd is None else [_short(side) for side in gsd],
        "linearized": image.linearized,
    }
    if document.get("stated_width_px") is not None:
        fitted = document.get("width_px") or {}
        found["width_px"] = _short(document["stated_width_px"]), bool(fitted.get("std"))
    if document.get("star") is not None:
        found["cycles"] = document["star"].get("cycles")
    if record.kind == "points" and document.get("sources"):
        found["sources"] = _where(document["sources"])
    if record.kind in _OF_SEVERAL_IMAGES:
        found["numbers"] = _main_numbers(record)
    return found


def _where(sources: Sequence[Mapping[str, Any]]) -> list[int]:
    """How many sources there are, and about which place and how far, to whole pixels."""
    places = np.array([[one[axis]["value"] for axis in ("row", "col")] for one in sources])
    middle, reach = places.mean(axis=0), places.std(axis=0)
    return [len(sources), *map(round, [*middle.tolist(), *reach.tolist()])]


def _parts(entry: Entry) -> dict[str, Any]:
    """What identifies an entry apart from what was stated."""
    image, record, rejected = entry.image, entry.record, entry.rejected
    parts: dict[str, Any] = {
        "image": image.content,
        "band": entry.band,
        "target": None if entry.target is None else [entry.target.name, entry.target.kind],
    }
    if record is not None:
        parts |= _record_parts(record)
        if image.content is None:
            path = image.path if image.path is not None else record.image.path
            parts |= {"file": file_name(path), "numbers": _main_numbers(record)}
    if rejected is not None:
        values = {name: one for name, one in rejected.values.items() if name != "path"}
        parts |= {"rejected": rejected.stage, "values": values}
        if image.content is None:
            parts |= {"file": file_name(image.path), "reason": rejected.reason}
    return parts


def image_identity(image: ImageEntry) -> str:
    """A digest of all that is known of an image."""
    return _digest(_all_fields(image))


def target_identity(target: TargetEntry) -> str:
    """A digest of all that is known of a target."""
    return _digest(_all_fields(target))


def file_name(path: str | None) -> str | None:
    """The name of a file without its folders, of either notation."""
    if path is None:
        return None
    return PureWindowsPath(path).name if "\\" in path else PurePosixPath(path).name


def _record_parts(record: Record) -> dict[str, Any]:
    document = record.document
    image, line = document["image"], document.get("line")
    return {
        "band_number": image.get("band", 1),
        "roi": image["roi"],
        "kind": record.kind,
        "method": record.method,
        "options": record.options,
        "place": None if line is None else [
            round(line[name]) for name in ("row", "col", "normal_deg")
        ],
    }  # fmt: skip


def _main_numbers(record: Record) -> list[str | None]:
    document = record.document
    parts = [document] if "orientation" in document else [document["across"], document["along"]]
    found = (part.get(name) for part in parts for name in METRICS)
    values = (None if one is None else one["value"] for one in found)
    return [None if value is None else _short(value) for value in values]


def _short(number: float) -> str:
    return f"{number:.{_DIGITS}g}"


def _all_fields(entry: ImageEntry | TargetEntry) -> dict[str, Any]:
    found = {one.name: getattr(entry, one.name) for one in fields(entry)}
    if found.get("acquired") is not None:
        found["acquired"] = as_utc(found["acquired"])
    return found


def _digest(parts: Mapping[str, Any]) -> str:
    text = json.dumps(parts, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    """What JSON does not have: mappings of other classes, dates."""
    if isinstance(value, Mapping):
        return dict(value)
    return value.isoformat() if isinstance(value, date) else str(value)
