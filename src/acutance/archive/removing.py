"""What holds no longer is removed: rejections, and images whose file has other content now."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from sqlalchemy import Connection, Row, delete, select

from acutance.archive.connection import Database, in_chunks
from acutance.archive.named_images import ImageKey, named_images
from acutance.archive.tables import images, measurements
from acutance.arguments import require_flags, require_texts

__all__ = ["earlier_contents", "remove_images", "remove_rejections"]


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
    removed = 0
    for some in in_chunks(keys):
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


def earlier_contents(database: Database, now: Mapping[str, str]) -> dict[str, list[str]]:
    """Other contents that the archive has of paths.

    Parameters
    ----------
    database : Database
    now : mapping of str to str
        By path the SHA-256 of the file as it is.
    """
    found: dict[str, list[str]] = {}
    contents = set(now.values())
    for some in in_chunks(now):
        asked = select(images.c.path, images.c.content).where(
            images.c.path.in_(some), images.c.content.is_not(None)
        )
        for path, content in database.read(partial(_pairs, asked=asked.distinct())):
            # A copy that took the name of another of these files is no earlier content.
            if content not in contents:
                found.setdefault(path, []).append(content)
    return {path: sorted(found[path]) for path in now if path in found}


def _pairs(connection: Connection, asked: Any) -> list[Any]:
    return list(connection.execute(asked))


def remove_images(database: Database, names: Sequence[str], *, dry_run: bool = False) -> int:
    """Remove images with all their measurements and rejections, and count these.

    Parameters
    ----------
    database : Database
    names : sequence of str
        Paths, file names, SHA-256 or patterns.
    dry_run : bool, optional
        Change nothing, count what would go.

    Raises
    ------
    OptionError
        If a name means no image, or a file name that several have: nothing is removed.
    ArchiveError
        If the archive cannot be written.
    """
    require_flags(dry_run=dry_run)
    names = require_texts("images", names)
    named = database.read(partial(named_images, names=names, done="removed"))
    keys = list(dict.fromkeys(key for some in named.values() for key in some))
    work = partial(_remove_images, keys=keys, dry_run=dry_run)
    return database.read(work) if dry_run else database.write(work)


def _remove_images(connection: Connection, keys: Sequence[ImageKey], dry_run: bool) -> int:
    count = 0
    for some in in_chunks(keys):
        contents = [key for key in some if isinstance(key, str)]
        numbers = [key for key in some if not isinstance(key, str)]
        wanted = images.c.content.in_(contents) | images.c.id.in_(numbers)
        ids = list(connection.execute(select(images.c.id).where(wanted)).scalars())
        rows = select(measurements.c.id).where(measurements.c.image_id.in_(ids))
        count += len(connection.execute(rows).all())
        if not dry_run:
            # Numbers and documents go with their measurements.
            connection.execute(delete(measurements).where(measurements.c.image_id.in_(ids)))
            connection.execute(delete(images).where(images.c.id.in_(ids)))
    return count
