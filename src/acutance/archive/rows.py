"""An entry as the rows of the tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from acutance.archive.dates import as_utc
from acutance.archive.entry import Entry, ImageEntry, RunEntry, TargetEntry
from acutance.archive.identity import (
    Stated,
    file_name,
    image_identity,
    keys_of,
    stated_of,
    target_identity,
)
from acutance.archive.packing import packed, plain_json
from acutance.archive.systematic import systematic_stds
from acutance.archive.tables import VERDICTS
from acutance.curves import METRICS
from acutance.errors import OptionError
from acutance.geometry.angles import wrap_axis
from acutance.targets.record import Record

__all__ = ["EntryRows", "image_row", "rows_of", "target_row"]

Row = dict[str, Any]

_UNKNOWN: Mapping[str, None] = {"value": None, "std": None}


@dataclass(frozen=True)
class EntryRows:
    """What becomes of an entry.

    Parameters
    ----------
    key : str
    image : ImageEntry
    target : TargetEntry or None
    measurement : dict
        The row of measurements, without the numbers of other rows.
    directions : tuple of dict
    document : bytes or None
        The document as it is stored.
    run : RunEntry or None
    older_key : str or None
        Under which an older version may have kept the same.
    stated : mapping
        What tells it apart from others of that key.
    """

    key: str
    image: ImageEntry
    target: TargetEntry | None
    measurement: Row
    directions: tuple[Row, ...]
    document: bytes | None
    run: RunEntry | None
    older_key: str | None = None
    stated: Stated = field(default_factory=dict)


def rows_of(entry: Entry) -> EntryRows:
    """The rows of an entry.

    Raises
    ------
    OptionError
        If it holds what no table can: its message names the entry.
    """
    if not isinstance(entry, Entry):
        raise OptionError(f"a {type(entry).__name__} was given: add entries, Entry(record=...)")
    record, rejected, target = entry.record, entry.rejected, entry.target
    key, older_key = keys_of(entry)
    row: Row = dict.fromkeys(
        ("kind", "method", "verdict", "snr", "measured_at", "stage", "reason", "rejected_values")
    )
    row |= {"key": key, "band": entry.band}
    if rejected is not None:
        row |= {
            "kind": None if target is None else target.kind,
            "method": rejected.values.get("method"),
            "stage": rejected.stage,
            "reason": rejected.reason,
            "rejected_values": plain_json(rejected.values),
        }
        return EntryRows(key, entry.image, target, row, (), None, entry.run)
    assert record is not None
    row |= {
        "kind": record.kind,
        "method": record.method,
        "verdict": VERDICTS.index(_verdict_word(record)),
        "snr": _finite(record.document["snr"]),
        "measured_at": as_utc(record.document["measured_at"], "measured_at"),
    }
    directions = tuple(_direction_rows(record))
    return EntryRows(
        key, entry.image, target, row, directions, packed(record.document), entry.run, older_key,
        {} if older_key is None else stated_of(record),
    )  # fmt: skip


def image_row(image: ImageEntry) -> Row:
    """The row of an image."""
    row_m, col_m = (None, None) if image.gsd_m is None else image.gsd_m
    return {
        "identity": image_identity(image),
        "content": image.content,
        "path": image.path,
        "name": file_name(image.path),
        "sensor": image.sensor,
        "level": image.level,
        "acquired": _moment(image.acquired),
        "gsd_row_m": _finite(row_m),
        "gsd_col_m": _finite(col_m),
        "view_zenith_deg": _finite(image.view_zenith_deg),
        "view_azimuth_deg": _finite(image.view_azimuth_deg),
        "sun_elevation_deg": _finite(image.sun_elevation_deg),
        "sun_azimuth_deg": _finite(image.sun_azimuth_deg),
        "sources": plain_json(image.sources),
    }


def target_row(target: TargetEntry) -> Row:
    """The row of a target."""
    return {
        "identity": target_identity(target),
        "name": target.name,
        "kind": target.kind,
        "site": target.site,
        "valid_from": target.valid_from,
        "valid_to": target.valid_to,
        "lon": _finite(target.lon),
        "lat": _finite(target.lat),
        "definition": plain_json(target.definition),
    }


def _direction_rows(record: Record) -> Iterator[Row]:
    document = record.document
    measured = record.measured_directions
    for name, one in record.directions.items():
        part = one.document
        yield {
            "orientation": name,
            "measured": name in measured,
            "angle_deg": _angle_deg(document, name),
            "gsd_m": _finite(part.get("gsd_m")),
            **_numbers(part),
            **systematic_stds(document, name),
        }


def _numbers(part: Mapping[str, Any]) -> Row:
    found: Row = {}
    for name in METRICS:
        number = part.get(name) or _UNKNOWN
        found[name], found[f"{name}_std"] = _finite(number["value"]), _finite(number["std"])
    return found


def _angle_deg(document: Mapping[str, Any], orientation: str) -> float:
    """Direction of the numbers, from the column axis (0) towards the row axis, -90 to 90."""
    line = document.get("line")
    if line is not None:
        return float(wrap_axis(line["normal_deg"]))
    across_deg = 0.0 if document["image"].get("along_track", "y") == "y" else 90.0
    return across_deg if orientation == "across" else 90.0 - across_deg


def _verdict_word(record: Record) -> str:
    """The verdict that was written; of older documents it follows from the checks."""
    written = record.document.get("verdict")
    word = record.verdict.word if written is None else written["word"]
    if word not in VERDICTS:
        raise OptionError(f"the verdict of the document is {word!r}, none of {VERDICTS}")
    return str(word)


def _moment(when: datetime | None) -> datetime | None:
    return None if when is None else as_utc(when, "acquired")


def _finite(number: float | None) -> float | None:
    """A number for a column; what is not finite is missing, as in the documents."""
    if number is None:
        return None
    try:
        found = float(number)
    except OverflowError:
        return None
    return found if math.isfinite(found) else None
