"""What makes an entry, an image or a target the same as one that is kept already.

The key of an entry is a digest of its image, band, region, target, kind, method and options, and
of where in the region the target was found, to whole pixels: a region may hold several edges. The
image counts by its content. Where that is not known, its file name without folders and the main
numbers of the measurement stand for it: many images have the same name. When the measurement was
made, and by which version, does not count.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields
from datetime import date
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any

from acutance.archive.dates import as_utc
from acutance.archive.entry import Entry, ImageEntry, TargetEntry
from acutance.curves import METRICS
from acutance.targets.record import Record

__all__ = ["file_name", "image_identity", "key_of", "target_identity"]

_DIGITS = 6
"""Significant digits of the numbers that identify a measurement whose image is not known."""


def key_of(entry: Entry) -> str:
    """The key of an entry: its own, or a digest of 64 hexadecimal digits."""
    if entry.key is not None:
        return entry.key
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
    return _digest(parts)


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
    return [None if value is None else f"{value:.{_DIGITS}g}" for value in values]


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
