"""Runs: the batches and imports that wrote into an archive."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, select, update
from sqlalchemy.dialects import postgresql, sqlite

from acutance.archive.connection import Database
from acutance.archive.entry import Entry, RunEntry
from acutance.archive.packing import plain_json
from acutance.archive.tables import images, measurements, runs
from acutance.errors import OptionError

__all__ = [
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


def ids_of_runs(connection: Connection, wanted: Sequence[RunEntry | None]) -> dict[str, int]:
    """Numbers of runs that entries name, by their uid; made where there are none.

    A run that was only named before, or had not ended, is completed.
    """
    by_uid: dict[str, RunEntry] = {}
    for run in wanted:
        if run is not None and (run.uid not in by_uid or run.plan):
            by_uid[run.uid] = run
    if not by_uid:
        return {}
    insert = sqlite.insert if connection.dialect.name == "sqlite" else postgresql.insert
    new = insert(runs).on_conflict_do_nothing(index_elements=["uid"])
    connection.execute(new, [_run_row(by_uid[uid]) for uid in sorted(by_uid)])
    found = {}
    asked = select(runs).where(runs.c.uid.in_(by_uid))
    for row in connection.execute(asked).mappings().all():
        run = by_uid[row["uid"]]
        found[run.uid] = int(row["id"])
        is_fuller = bool(run.plan) and not row["plan"]
        has_ended = run.ended is not None and row["ended"] is None
        if is_fuller or has_ended:
            connection.execute(update(runs).where(runs.c.id == row["id"]).values(_run_row(run)))
    return found


def _run_row(run: RunEntry) -> dict[str, Any]:
    row = {name: getattr(run, name) for name in _OF_RUN}
    summary = None if run.summary is None else plain_json(run.summary)
    return {**row, "plan": plain_json(run.plan), "summary": summary}


def named_once(entries: Iterable[Entry]) -> Iterator[Entry]:
    """The entries, the plan and summary of each run with the first of its entries only."""
    told: set[str] = set()
    for entry in entries:
        run = entry.run
        if run is None or run.uid not in told:
            yield entry
        else:
            yield replace(entry, run=run.named_only)
        if run is not None:
            told.add(run.uid)


def with_whole_runs(entries: Iterable[Entry]) -> Iterator[Entry]:
    """The entries, runs that are only named as an earlier entry has told them."""
    whole: dict[str, RunEntry] = {}
    for entry in entries:
        # What is no entry is refused where its rows are made.
        run = getattr(entry, "run", None)
        if run is None:
            yield entry
            continue
        if run.plan:
            whole[run.uid] = run
        yield entry if run.plan or run.uid not in whole else replace(entry, run=whole[run.uid])
