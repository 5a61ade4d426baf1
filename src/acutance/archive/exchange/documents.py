"""What measuring commands print with ``--json``, and what exports wrote, read as entries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from acutance.archive.entry import UNKNOWN_KIND, Entry, ImageEntry, TargetEntry
from acutance.archive.exchange import entry_document
from acutance.archive.restored_images import restored_sources
from acutance.errors import OptionError
from acutance.targets.record import SCHEMA, Record
from acutance.targets.target_result import Rejected

__all__ = ["Stated", "entries_of"]

_OF_MEASUREMENTS = ("acutance/target/1", "acutance/comparison/1")
_OF_RESULTS = ("acutance/regions/1", "acutance/bands/1")
_MARKS = ("band", "region")
"""What such documents mark every result with."""


@dataclass(frozen=True, kw_only=True)
class Stated:
    """What is stated of documents that do not know it themselves.

    Parameters
    ----------
    sensor, level, band : str, optional
    acquired : datetime, optional
    target : TargetEntry or str, optional
    """

    sensor: str | None = None
    level: str | None = None
    band: str | None = None
    acquired: datetime | None = None
    target: TargetEntry | str | None = field(default=None)

    def __post_init__(self) -> None:
        if not isinstance(self.target, TargetEntry | str | None):
            raise OptionError(
                f"target is a {type(self.target).__name__}: give a name or a TargetEntry"
            )


def entries_of(document: Any, stated: Stated) -> Iterator[Entry]:
    """Entries of a document: of a measurement, of many, or of an export.

    Parameters
    ----------
    document : mapping, or list of them
    stated : Stated
        Of measurements; what was exported has its own image and target.

    Raises
    ------
    OptionError
        If it is none of them.
    """
    yield from _entries(document, stated, {})


def _entries(document: Any, stated: Stated, marks: Mapping[str, Any]) -> Iterator[Entry]:
    """Entries of a document, or of a part of one that is marked with its band and region."""
    if isinstance(document, list):
        for one in document:
            yield from _entries(one, stated, marks)
        return
    if isinstance(document, Mapping):
        own = {name: document[name] for name in _MARKS if document.get(name) is not None}
        marks = {**marks, **own}
    schema = document.get("schema") if isinstance(document, Mapping) else None
    if schema == entry_document.SCHEMA:
        yield entry_document.entry_of_document(document)
    elif schema == SCHEMA:
        yield _measured({**document, **marks}, stated)
    elif schema in _OF_MEASUREMENTS or schema in _OF_RESULTS:
        name = "measurements" if schema in _OF_MEASUREMENTS else "results"
        yield from _entries(_part(document, name), stated, marks)
        yield from (_rejected(one, stated, marks) for one in _part(document, "rejected"))
    else:
        raise OptionError(
            f"its schema is {schema!r}: give what a measuring command printed with --json, or what "
            "acutance archive export wrote"
        )


def _part(document: Mapping[str, Any], name: str) -> list[Any]:
    part = document.get(name)
    if not isinstance(part, list):
        raise OptionError(f"the document lacks {name}: it was cut or changed")
    return part


def _measured(document: Mapping[str, Any], stated: Stated) -> Entry:
    record = Record.from_dict(document)
    image = ImageEntry(
        path=record.image.path,
        sensor=stated.sensor,
        level=stated.level,
        acquired=stated.acquired,
        gsd_m=record.image.pixel_gsd_m,
        sources=restored_sources(record),
    )
    named = document.get("region") or record.image.region
    target = stated.target if stated.target is not None else named
    if isinstance(target, str):
        target = TargetEntry(name=target, kind=record.kind)
    # The same name whether bands were measured one by one or together; documents of several bands
    # of an array number them.
    names = (stated.band, record.image.band_name, document.get("band"))
    band = next((one for one in names if one is not None), record.image.band_told_apart)
    return Entry(record=record, image=image, target=target, band=band)


def _rejected(document: Mapping[str, Any], stated: Stated, marks: Mapping[str, Any]) -> Entry:
    try:
        values = {**marks, **document["values"]}
        rejected = Rejected(document["stage"], document["reason"], values)
        path, region = rejected.values.get("path"), rejected.values.get("region")
    except (AttributeError, KeyError, TypeError) as error:
        raise OptionError(f"a rejection of the document is damaged ({error!r})") from error
    image = ImageEntry(
        path=path, sensor=stated.sensor, level=stated.level, acquired=stated.acquired
    )
    target = stated.target if stated.target is not None else region
    if isinstance(target, str):
        target = TargetEntry(name=target, kind=UNKNOWN_KIND)
    names = (stated.band, rejected.values.get("band_name"), rejected.values.get("band"))
    band = next((one for one in names if one is not None), None)
    return Entry(rejected=rejected, image=image, target=target, band=band)
