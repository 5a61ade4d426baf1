"""Rejections that hold no longer are removed, as of a file that was missing."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any, Final

from sqlalchemy import Connection, Row, delete, select

from acutance.archive.connection import Database
from acutance.archive.tables import images, measurements

__all__ = ["remove_rejections"]

_CHUNK: Final = 2000
"""Keys of one question: databases take some ten thousand values."""


def remove_rejections(database: Database, keys: Iterable[str]) -> int:
    """Remove rejections by their keys, with images of which nothing else is kept.

    Parameters
    ----------
    database : Database
    keys : iterable of str
        Those of measurements, and those that are not there, are passed over.

    Raises
    ------
    ArchiveError
        If the archive cannot be written.
    """
    wanted, removed = list(keys), 0
    for at in range(0, len(wanted), _CHUNK):
        some = wanted[at : at + _CHUNK]
        # Mostly there are none: other writers are not kept waiting to find that out.
        if database.read(partial(_rejections, keys=some)):
            removed += database.write(partial(_remove, keys=some))
    return removed


def _rejections(connection: Connection, keys: list[str]) -> list[Row[Any]]:
    asked = select(measurements.c.id, measurements.c.image_id)
    asked = asked.where(measurements.c.key.in_(keys), measurements.c.verdict.is_(None))
    return list(connection.execute(asked))


def _remove(connection: Connection, keys: list[str]) -> int:
    found = _rejections(connection, keys)
    connection.execute(delete(measurements).where(measurements.c.id.in_([row.id for row in found])))
    is_used = select(measurements.c.id).where(measurements.c.image_id == images.c.id).exists()
    of_them = images.c.id.in_({row.image_id for row in found})
    connection.execute(delete(images).where(of_them, ~is_used))
    return len(found)
