"""An entry as a JSON document, ``acutance/archived/1``: nothing is lost on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from datetime import date
from typing import Any

from acutance.archive.dates import as_utc
from acutance.archive.entry import Entry, ImageEntry, RunEntry, TargetEntry
from acutance.archive.identity import key_of
from acutance.archive.packing import plain_json
from acutance.errors import OptionError
from acutance.targets.record import Record
from acutance.targets.target_result import Rejected

__all__ = ["SCHEMA", "entry_document", "entry_of_document"]

SCHEMA = "acutance/archived/1"


def entry_document(entry: Entry) -> dict[str, Any]:
    """The document of an entry; its key is written, also if it was derived."""
    rejected = entry.rejected
    return {
        "schema": SCHEMA,
        "key": key_of(entry),
        "band": entry.band,
        "image": _document(entry.image),
        "target": None if entry.target is None else _document(entry.target),
        "record": None if entry.record is None else dict(entry.record.document),
        "rejected": None if rejected is None else {
            "stage": rejected.stage, "reason": rejected.reason, "values": dict(rejected.values)
        },
        "run": None if entry.run is None else _document(entry.run),
    }  # fmt: skip


def entry_of_document(document: Mapping[str, Any]) -> Entry:
    """The entry that `entry_document` wrote.

    Raises
    ------
    OptionError
        If it is damaged.
    """
    try:
        record, rejected, target = (document[name] for name in ("record", "rejected", "target"))
        return Entry(
            record=None if record is None else Record.from_dict(record),
            rejected=None if rejected is None else Rejected(
                rejected["stage"], rejected["reason"], rejected["values"]
            ),
            image=_image(document["image"]),
            target=None if target is None else _target(target),
            band=document["band"],
            key=document["key"],
            run=None if document.get("run") is None else _run(document["run"]),
        )  # fmt: skip
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, OptionError):
            raise
        raise OptionError(
            f"the document {SCHEMA} cannot be read ({error!r}): give one that acutance wrote"
        ) from error


def _document(entry: ImageEntry | TargetEntry | RunEntry) -> dict[str, Any]:
    found = {one.name: getattr(entry, one.name) for one in fields(entry)}
    if isinstance(entry, ImageEntry) and entry.acquired is not None:
        found["acquired"] = as_utc(entry.acquired, "acquired")
    plain = {
        name: value.isoformat() if isinstance(value, date) else value
        for name, value in found.items()
    }
    return plain_json(plain)


def _image(document: Mapping[str, Any]) -> ImageEntry:
    found = _known(document, ImageEntry)
    gsd_m, acquired = found.pop("gsd_m", None), found.pop("acquired", None)
    return ImageEntry(
        **found,
        gsd_m=None if gsd_m is None else (gsd_m[0], gsd_m[1]),
        acquired=None if acquired is None else as_utc(acquired, "acquired"),
    )


def _target(document: Mapping[str, Any]) -> TargetEntry:
    found = _known(document, TargetEntry)
    for name in ("valid_from", "valid_to"):
        if found.get(name) is not None:
            found[name] = date.fromisoformat(found[name])
    return TargetEntry(**found)


def _run(document: Mapping[str, Any]) -> RunEntry:
    found = _known(document, RunEntry)
    for name in ("started", "ended"):
        if found.get(name) is not None:
            found[name] = as_utc(found[name], name)
    return RunEntry(**found)


def _known(document: Mapping[str, Any], kind: type[Any]) -> dict[str, Any]:
    """Fields that this version has; those of a newer one are passed over."""
    names = {one.name for one in fields(kind)}
    return {name: value for name, value in document.items() if name in names}
