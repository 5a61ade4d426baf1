"""Runs: the batches and imports that wrote into an archive."""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, select, update

from acutance.archive.connection import Database
from acutance.archive.packing import plain_json
from acutance.archive.tables import images, measurements, runs
from acutance.errors import OptionError

__all__ = ["end_run", "kept_keys", "start_run"]


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
