"""Entries are added, each once: one whose key is there already is passed over.

A chunk of entries is one transaction: a process that ends in the middle leaves whole chunks. Keys
are written in their order, so that two processes that add the same do not wait for one another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from datetime import UTC, datetime
from functools import partial
from itertools import islice
from operator import itemgetter
from typing import Any, TypeVar

from sqlalchemy import Connection, Table, select
from sqlalchemy.sql.dml import ReturningInsert

from acutance.archive.connection import Database, insert_missing
from acutance.archive.correction_notes import has_notes, share_corrections
from acutance.archive.entry import Entry, ImageEntry, Kept, TargetEntry
from acutance.archive.kept_keys import kept_keys
from acutance.archive.possible_values import require_possible
from acutance.archive.rows import EntryRows, image_row, rows_of, target_row
from acutance.archive.runs import complete_runs, ids_of_runs, with_whole_runs
from acutance.archive.tables import directions, documents, images, measurements, runs, targets
from acutance.arguments import require_function, require_whole
from acutance.errors import OptionError
from acutance.targets.measurement import Measurement
from acutance.targets.record import Record

__all__ = ["CHUNK", "add_entries", "add_entry", "record_of"]

CHUNK = 2000
"""Entries of one transaction."""

_Described = TypeVar("_Described", ImageEntry, TargetEntry)


def record_of(measurement: Measurement | Record) -> Record:
    """The record of a measurement.

    Raises
    ------
    OptionError
        If it is none.
    """
    if isinstance(measurement, Measurement):
        return measurement.record
    if isinstance(measurement, Record):
        return measurement
    raise OptionError(
        f"a {type(measurement).__name__} was given: add measurements or their records, those of a "
        "target one by one (result.measurements)"
    )


def add_entry(database: Database, entry: Entry, run: int | None = None) -> Kept:
    """Add one entry.

    Raises
    ------
    ArchiveError
        If it cannot be kept.
    OptionError
        If it holds what no archive, image or target can, or there is no such run.
    """
    rows = _checked_rows(entry)
    added = _write(database, [rows], run)
    number, key = database.read(lambda connection: _place_of(connection, rows))
    return Kept(number, key, bool(added))


def _place_of(connection: Connection, rows: EntryRows) -> tuple[int, str]:
    """Number and key of the row of an entry that is there."""
    key = kept_keys(connection, [rows])[rows.key]
    found = select(measurements.c.id).where(measurements.c.key == key)
    return connection.execute(found).scalar_one(), key


def add_entries(
    database: Database,
    entries: Iterable[Entry],
    run: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> int:
    """Add entries, and count those that were not there.

    Parameters
    ----------
    database : Database
    entries : iterable of Entry
    run : int, optional
        What wrote them, instead of the runs that they name.
    progress : callable, optional
        Called after each transaction with how many entries were read.

    Raises
    ------
    ArchiveError
        If they cannot be kept; chunks before stay.
    OptionError
        If one holds what no archive, image or target can, or there is no such run.
    """
    if isinstance(entries, str) or not isinstance(entries, Iterable):
        raise OptionError(f"entries are {entries!r:.80}: give a list of Entry(...)")
    require_function(progress=progress)
    if run is not None:
        require_whole(0, run=run)
    added, read = 0, 0
    with ThreadPoolExecutor(1) as writer:
        # While one chunk is written, the next is put into rows.
        writing: Future[int] | None = None
        for rows in _chunks(entries):
            if writing is not None:
                added += writing.result()
                _report(progress, read)
            writing, read = writer.submit(_write, database, rows, run), read + len(rows)
        if writing is not None:
            added += writing.result()
            _report(progress, read)
    return added


def _checked_rows(entry: Entry) -> EntryRows:
    require_possible(entry)
    return rows_of(entry)


def _write(database: Database, rows: Sequence[EntryRows], run: int | None) -> int:
    """Write rows in one transaction, in the order of their keys, and count those that are new."""
    by_key = {one.key: one for one in rows}
    chunk = {key: by_key[key] for key in sorted(by_key)}
    return database.write(partial(_add_chunk, chunk=chunk, run=run))


def _report(progress: Callable[[int], None] | None, read: int) -> None:
    if progress is not None:
        progress(read)


def _chunks(entries: Iterable[Entry]) -> Iterator[list[EntryRows]]:
    """Rows of so many entries; no entry is held longer than it takes to make its rows."""
    left = map(_checked_rows, with_whole_runs(entries))
    while chunk := list(islice(left, CHUNK)):
        yield chunk


def _add_chunk(connection: Connection, chunk: Mapping[str, EntryRows], run: int | None) -> int:
    _require_run(connection, run)
    known = kept_keys(connection, list(chunk.values()))
    new = [one for key, one in chunk.items() if key not in known]
    # Entries that are there may still have more of their run, and corrections of their image.
    if run is None:
        complete_runs(connection, [chunk[key].run for key in known])
    _learn_corrections(connection, [rows.image for rows in chunk.values()])
    if not new:
        return 0
    image_ids = _ids(connection, images, image_row, [rows.image for rows in new])
    target_ids = _ids(
        connection, targets, target_row, [rows.target for rows in new if rows.target is not None]
    )
    run_ids = {} if run is not None else ids_of_runs(connection, [rows.run for rows in new])
    now = datetime.now(UTC)
    written = [
        rows.measurement
        | {
            "image_id": image_ids[id(rows.image)],
            "target_id": None if rows.target is None else target_ids[id(rows.target)],
            "run_id": run if rows.run is None or run is not None else run_ids[rows.run.uid],
            "added": now,
        }
        for rows in new
    ]
    inserted = connection.execute(_insert_new(connection, measurements, "key", "id"), written).all()
    ids: dict[str, int] = {row.key: row.id for row in inserted}
    _insert_all(
        connection,
        directions,
        [
            {"measurement_id": ids[rows.key], **row}
            for rows in new
            if rows.key in ids
            for row in rows.directions
        ],
    )
    _insert_all(
        connection,
        documents,
        [
            {"measurement_id": ids[rows.key], "document": rows.document}
            for rows in new
            if rows.key in ids and rows.document is not None
        ],
    )
    return len(ids)


def _insert_all(connection: Connection, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert rows of plain numbers, texts and bytes, which the driver takes as they are."""
    if not rows:
        return
    insert = table.insert().compile(dialect=connection.dialect)
    if insert.positiontup is None:
        connection.exec_driver_sql(insert.string, list(rows))
    else:
        values_of = itemgetter(*insert.positiontup)
        connection.exec_driver_sql(insert.string, [values_of(row) for row in rows])


def _insert_new(
    connection: Connection, table: Table, unique: str, also: str
) -> ReturningInsert[Any]:
    """Insert rows unless their unique column is there, and return those that were inserted."""
    columns = table.c[unique], table.c[also]
    return insert_missing(connection, table, unique).returning(*columns)


def _learn_corrections(connection: Connection, described: Sequence[ImageEntry]) -> None:
    """Write corrections that images come with to rows of the same content that are there."""
    noted = [one for one in described if has_notes(one.sources)]
    rows = [image_row(one) for one in {id(one): one for one in noted}.values()]
    if rows:
        share_corrections(connection, rows)


def _ids(
    connection: Connection,
    table: Table,
    row_of: Callable[[_Described], Mapping[str, Any]],
    described: Sequence[_Described],
) -> dict[int, int]:
    """The numbers of the rows of images or targets, made where there are none, by `id`."""
    each = {id(one): row_of(one) for one in {id(one): one for one in described}.values()}
    rows = {row["identity"]: row for row in each.values()}
    found = _found_ids(connection, table, list(rows))
    missing = [rows[identity] for identity in sorted(set(rows) - set(found))]
    if missing:
        if table is images:
            missing = share_corrections(connection, missing)
        connection.execute(_insert_new(connection, table, "identity", "id"), missing)
        found = _found_ids(connection, table, list(rows))
    return {place: found[row["identity"]] for place, row in each.items()}


def _found_ids(connection: Connection, table: Table, identities: Sequence[str]) -> dict[str, int]:
    asked = select(table.c.identity, table.c.id).where(table.c.identity.in_(identities))
    return {row.identity: row.id for row in connection.execute(asked)}


def _require_run(connection: Connection, run: int | None) -> None:
    if run is None:
        return
    if connection.execute(select(runs.c.id).where(runs.c.id == run)).first() is None:
        raise OptionError(f"there is no run {run} in the archive: start one with start_run()")
