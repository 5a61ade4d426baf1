"""The schema of an archive: made where the database is empty, brought forward where it is older.

Every step of `STEPS` leads from one version to the next. All of them, and the new number, are one
transaction: an archive is of one version or of another, whenever a process ends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, inspect, select, text, update

from acutance.archive.connection import Database
from acutance.archive.packing import unpacked
from acutance.archive.systematic import systematic_stds
from acutance.archive.tables import (
    APPLICATION,
    METADATA,
    SCHEMA_VERSION,
    about,
    directions,
    documents,
    systematic_columns,
)
from acutance.errors import ArchiveError

__all__ = ["STEPS", "Step", "ensure_schema"]

Step = Callable[[Connection], None]

_SOME = 500


def _add_systematic_stds(connection: Connection) -> None:
    """Columns of what does not average out, read from the documents that are there."""
    for name in systematic_columns():
        added = f"ALTER TABLE directions ADD COLUMN {name} DOUBLE PRECISION"
        connection.execute(text(added))
    ids = connection.execute(select(documents.c.measurement_id)).scalars().all()
    for first in range(0, len(ids), _SOME):
        some = documents.c.measurement_id.in_(ids[first : first + _SOME])
        for number, stored in connection.execute(select(documents).where(some)).all():
            # Of a damaged document nothing is known: the others are brought forward.
            with suppress(ArchiveError):
                _fill_systematic_stds(connection, number, unpacked(stored, number))


def _fill_systematic_stds(connection: Connection, number: int, document: Mapping[str, Any]) -> None:
    for orientation in ("across", "along"):
        row = (directions.c.measurement_id == number) & (directions.c.orientation == orientation)
        found = systematic_stds(document, orientation)
        connection.execute(update(directions).where(row).values(found))


STEPS: Mapping[int, Step] = {1: _add_systematic_stds}
"""By version: what leads from it to the next."""

_LOCK = 0x61637574
"""Of PostgreSQL: one process at a time makes or changes the tables."""


def ensure_schema(database: Database) -> None:
    """Make the tables of an empty database; bring those of an older version forward.

    Raises
    ------
    ArchiveError
        If the database is of another program, newer than this version, or has to be changed but
        was opened to be read.
    """
    version = database.read(lambda connection: _version(connection, database))
    if version == SCHEMA_VERSION:
        return
    if database.read_only:
        raise ArchiveError(
            f"archive {database.place} is empty: add measurements first"
            if version is None
            else f"archive {database.place} has tables of version {version}, this is version "
            f"{SCHEMA_VERSION}: open it once to be written, which brings them forward"
        )
    if version is None:
        database.use_write_ahead_log()
    database.write(lambda connection: _make_or_migrate(connection, database))


def _version(connection: Connection, database: Database) -> int | None:
    """The version of the tables; None of an empty database.

    Raises
    ------
    ArchiveError
        If they are of another program, or newer than this version.
    """
    present = set(inspect(connection).get_table_names())
    if about.name not in present:
        # A server may keep tables of others beside an archive, a file keeps an archive only.
        strangers = present if database.is_file else present & set(METADATA.tables)
        if strangers:
            raise ArchiveError(
                f"{database.place} is no archive of acutance: it has tables of another program "
                f"({', '.join(sorted(strangers)[:5])}); give another file or database"
            )
        return None
    found = connection.execute(select(about.c.application, about.c.schema_version)).all()
    if [application for application, _ in found] != [APPLICATION]:
        raise ArchiveError(f"{database.place} is no archive of acutance: {about.name} is damaged")
    version = int(found[0].schema_version)
    if version > SCHEMA_VERSION:
        raise ArchiveError(
            f"archive {database.place} was written by a newer version of acutance (tables of "
            f"version {version}, this one knows {SCHEMA_VERSION}): update acutance"
        )
    return version


def _make_or_migrate(connection: Connection, database: Database) -> None:
    from acutance import __version__

    if not database.is_file:
        connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": _LOCK})
    # Another process may have been first.
    version = _version(connection, database)
    if version is None:
        METADATA.create_all(connection)
        connection.execute(
            about.insert().values(
                application=APPLICATION,
                schema_version=SCHEMA_VERSION,
                software=__version__,
                created=datetime.now(UTC),
            )
        )
        return
    for older in range(version, SCHEMA_VERSION):
        STEPS[older](connection)
    connection.execute(update(about).values(schema_version=SCHEMA_VERSION))
