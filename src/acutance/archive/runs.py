"""Runs: the batches and imports that wrote into an archive."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, select, update

from acutance.archive.connection import Database, insert_missing
from acutance.archive.dates import as_utc
from acutance.archive.entry import Entry, RunEntry
from acutance.archive.packing import plain_json
from acutance.archive.tables import images, measurements, runs
from acutance.errors import OptionError

__all__ = [
    "complete_runs",
    "end_run",
    "ids_of_runs",
    "kept_keys",
    "named_once",
    "runs_by_id",
    "start_run",
    "with_whole_runs",
]


def start_run(database: Database, plan: Mapping[str, Any]) -> int:
    """Write down that a run began, and its plan; the number of the run."""
    from acutance import __version__

    row = {
        "uid": uuid.uuid4().hex,
        "started": datetime.now(UTC),
        "software": __version__,
        "plan": plain_json(plan),
    }
    new = runs.insert().values(row).returning(runs.c.id)
    return database.write(lambda connection: int(connection.execute(new).scalar_one()))


def end_run(database: Database, run: int, summary: Mapping[str, Any]) -> None:
    """Write down that a run ended, and its summary.

    Raises
    ------
    OptionError
        If there is no such run.
    """
    ended = update(runs).where(runs.c.id == run)
    ended = ended.values(ended=datetime.now(UTC), summary=plain_json(summary))

    def write(connection: Connection) -> None:
        if connection.execute(ended).rowcount == 0:
            raise OptionError(f"there is no run {run} in the archive: start one with start_run()")

    database.write(write)


def kept_keys(
    database: Database, run: int | None = None, contents: list[str] | None = None
) -> set[str]:
    """Keys of what is kept: all, or that of one run, or of images by their contents."""
    asked = select(measurements.c.key)
    if run is not None:
        asked = asked.where(measurements.c.run_id == run)
    if contents is not None:
        asked = asked.join(images).where(images.c.content.in_(contents))
    return database.read(lambda connection: set(connection.execute(asked).scalars()))


def runs_by_id(connection: Connection, ids: Iterable[int | None]) -> dict[int, RunEntry]:
    """Runs by their numbers."""
    wanted = {number for number in ids if number is not None}
    asked = select(runs).where(runs.c.id.in_(wanted))
    return {
        row["id"]: RunEntry(**{name: row[name] for name in _OF_RUN})
        for row in (connection.execute(asked).mappings() if wanted else ())
    }


_OF_RUN = ("uid", "started", "software", "ended", "plan", "summary")
_MOMENTS = ("started", "ended")


def ids_of_runs(connection: Connection, wanted: Sequence[RunEntry | None]) -> dict[str, int]:
    """Numbers of runs that entries name, by their uid; made where there are none.

    A run that was only named before, or had not ended, is completed.
    """
    by_uid = _by_uid(wanted)
    if not by_uid:
        return {}
    rows = [_run_row(by_uid[uid]) for uid in sorted(by_uid)]
    connection.execute(insert_missing(connection, runs, "uid"), rows)
    complete_runs(connection, list(by_uid.values()))
    asked = select(runs.c.uid, runs.c.id).where(runs.c.uid.in_(by_uid))
    return {row.uid: row.id for row in connection.execute(asked)}


def complete_runs(connection: Connection, wanted: Sequence[RunEntry | None]) -> None:
    """Add the plan, end and summary of runs that are there without; others are passed over."""
    by_uid = _by_uid(wanted)
    if not by_uid:
        return
    asked = select(runs).where(runs.c.uid.in_(by_uid)).order_by(runs.c.id)
    for row in connection.execute(asked).mappings().all():
        kept = RunEntry(**{name: row[name] for name in _OF_RUN})
        whole = _joined(kept, by_uid[kept.uid])
        if whole != kept:
            connection.execute(update(runs).where(runs.c.id == row["id"]).values(_run_row(whole)))


def _by_uid(wanted: Iterable[RunEntry | None]) -> dict[str, RunEntry]:
    """Runs with all that is known of them."""
    found: dict[str, RunEntry] = {}
    for run in wanted:
        if run is not None:
            found[run.uid] = _joined(found.get(run.uid, run), run)
    return found


def _joined(run: RunEntry, other: RunEntry) -> RunEntry:
    """A run with what it lacks and another mention of it has; itself where it lacks nothing."""
    if other is run:
        return run
    missing: dict[str, Any] = {
        name: getattr(other, name)
        for name in ("plan", "ended", "summary")
        if not getattr(run, name) and getattr(other, name)
    }
    return replace(run, **missing) if missing else run


def _run_row(run: RunEntry) -> dict[str, Any]:
    row = {name: getattr(run, name) for name in _OF_RUN}
    summary = None if run.summary is None else plain_json(run.summary)
    moments = {name: one and as_utc(one, name) for name, one in row.items() if name in _MOMENTS}
    return {**row, **moments, "plan": plain_json(run.plan), "summary": summary}


def named_once(entries: Iterable[Entry]) -> Iterator[Entry]:
    """The entries, the plan and summary of each run with the first of its entries only."""
    written: set[str] = set()
    for entry in entries:
        run = entry.run
        if run is None or run.uid not in written:
            yield entry
        else:
            yield replace(entry, run=run.named_only)
        if run is not None:
            written.add(run.uid)


def with_whole_runs(entries: Iterable[Entry]) -> Iterator[Entry]:
    """The entries, each with all that was read of its run until then."""
    whole: dict[str, RunEntry] = {}
    for entry in entries:
        # What is no entry is refused where its rows are made.
        run = getattr(entry, "run", None)
        if run is None:
            yield entry
            continue
        known = _joined(whole.get(run.uid, run), run)
        whole[run.uid] = known
        yield entry if known is run else replace(entry, run=known)
