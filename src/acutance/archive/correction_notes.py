"""What was corrected of an image: notes in its sources, which all rows of its content share.

A note has the column, the values before and after, when it was corrected, and why. Of a content the
latest note on a column decides, whichever archive it was written in.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from typing import Any, Final

from sqlalchemy import Connection, bindparam, select, update

from acutance.archive.dates import as_utc
from acutance.archive.packing import plain_json
from acutance.archive.tables import images
from acutance.raster.metadata.findings import ANGLES

__all__ = [
    "BAND", "COLUMNS", "has_notes", "next_moment", "share_corrections", "with_notes", "write_rows",
]  # fmt: skip

COLUMNS: Final = ("sensor", "level", "acquired", "gsd_row_m", "gsd_col_m", *ANGLES)
"""Columns of the table of images that can be corrected."""

BAND: Final = "band"
"""What is corrected of the rows of an image: no column of its own."""

_NOTES: Final = "corrections"
_TEXTS: Final = ("sensor", "level", BAND)
_NOTED: Final = (*COLUMNS, BAND)

Row = Mapping[str, Any]
Note = Mapping[str, Any]


def has_notes(sources: Any) -> bool:
    """Whether something of an image was corrected, by its sources."""
    return isinstance(sources, Mapping) and bool(_notes_of(sources))


def with_notes(
    row: Row,
    changes: Mapping[str, tuple[Any, Any]],
    reasons: Mapping[str, str | None],
    now: datetime,
) -> Row:
    """The row of an image with new values, and notes of what was there before and its source."""
    sources = row["sources"]
    notes = [
        {"column": name, "before": before, "after": after, "on": now,
         "source_before": sources.get(_source_word(name)), "reason": reasons.get(name)}
        for name, (before, after) in changes.items()
    ]  # fmt: skip
    known = [{key: one for key, one in note.items() if one is not None} for note in notes]
    all_notes = [*_notes_of(sources), *plain_json({_NOTES: known})[_NOTES]]
    words = {_source_word(name): f"corrected on {now:%Y-%m-%d}" for name in changes}
    values = {name: after for name, (_, after) in changes.items()}
    return {**row, **values, "sources": {**sources, **words, _NOTES: all_notes}}


def next_moment(rows: Iterable[Row]) -> datetime:
    """Now; or just after the latest note of the rows, where another clock is ahead."""
    noted = [_moment_of(note) for row in rows for note in _notes_of(row["sources"])]
    now = datetime.now(UTC)
    return max(now, max(noted) + timedelta(microseconds=1)) if noted else now


def share_corrections(connection: Connection, rows: Sequence[Row]) -> list[Row]:
    """Rows of images with all that was corrected of their contents.

    Rows of the same contents that are kept get what they lack. Images without a content (SHA-256)
    share nothing.

    Parameters
    ----------
    connection : Connection
    rows : sequence of mapping
        Of images that are added, or are there already.
    """
    contents = {row["content"] for row in rows} - {None}
    asked = select(images).where(images.c.content.in_(contents)).order_by(images.c.id)
    # Another process must not write its notes between this reading and the writing.
    found = connection.execute(asked.with_for_update(key_share=True)).mappings()
    kept: list[Row] = [dict(row) for row in found]
    noted: dict[str, list[Row]] = {}
    for row in (*kept, *rows):
        if row["content"] is not None and has_notes(row["sources"]):
            noted.setdefault(row["content"], []).append(row["sources"])
    notes = {content: _joined(several) for content, several in noted.items()}
    shared = [_corrected(row, notes.get(row["content"])) for row in kept]
    write_rows(connection, [new for new, old in zip(shared, kept, strict=True) if new != old])
    return [_corrected(row, notes.get(row["content"])) for row in rows]


def write_rows(connection: Connection, rows: Sequence[Row]) -> None:
    """Write what can be corrected of rows of images, by their numbers."""
    if not rows:
        return
    written = (*COLUMNS, "sources")
    changed = update(images).where(images.c.id == bindparam("number"))
    changed = changed.values({name: bindparam(f"new_{name}") for name in written})
    connection.execute(
        changed,
        [{"number": row["id"], **{f"new_{name}": row[name] for name in written}} for row in rows],
    )


def _corrected(row: Row, notes: Sequence[Note] | None) -> Row:
    """A row with the values of its notes, which are in the order of their dates."""
    if notes is None:
        return row
    own = [note for note in notes if note["column"] != BAND]
    values = {note["column"]: _value_of(note) for note in own}
    sources = {
        _source_word(note["column"]): f"corrected on {_moment_of(note):%Y-%m-%d}" for note in own
    }
    return {**row, **values, "sources": {**row["sources"], **sources, _NOTES: list(notes)}}


def _joined(several: Iterable[Row]) -> list[Note]:
    """Notes of several sources, each once, in the order of their dates."""
    notes = (note for sources in several for note in _notes_of(sources))
    each = {json.dumps(note, sort_keys=True): note for note in notes}

    def order(text: str) -> tuple[datetime, int, str]:
        return _moment_of(each[text]), _NOTED.index(each[text]["column"]), text

    return [each[text] for text in sorted(each, key=order)]


def _notes_of(sources: Row) -> list[Note]:
    """The notes of an image. Sources are free: what has not the form of a note is none."""
    found = sources.get(_NOTES)
    return [one for one in found if _is_note(one)] if isinstance(found, list) else []


def _is_note(found: Any) -> bool:
    try:
        _moment_of(found)
        _value_of(found)
    except (KeyError, TypeError, ValueError):
        return False
    return True


def _moment_of(note: Note) -> datetime:
    return _moment(note["on"])


@lru_cache
def _moment(text: str) -> datetime:
    """The date of a correction: thousands of images have the same."""
    return as_utc(text, "the date of a correction")


def _value_of(note: Note) -> Any:
    """The value of a note as its column has it."""
    name, value = note["column"], note["after"]
    if name == "acquired":
        return as_utc(value, name)
    if name not in _NOTED or not isinstance(value, str if name in _TEXTS else int | float):
        raise TypeError(f"{value!r} is no {name}")
    return value if name in _TEXTS else float(value)


def _source_word(column: str) -> str:
    """What sources call a column."""
    return "gsd_m" if column.startswith("gsd_") else column
