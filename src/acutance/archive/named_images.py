"""Which images are meant by a name: a path, a file name, a SHA-256, or a pattern."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fnmatch import translate
from glob import has_magic
from typing import Any

from sqlalchemy import Connection, Row, select

from acutance.archive.tables import images
from acutance.errors import OptionError

__all__ = ["ImageKey", "named_images"]

_Kept = Row[Any, Any, Any, Any]
ImageKey = str | int
"""The content of an image; the number of its row where that is not known."""

_MAX_LISTED = 10


def named_images(
    connection: Connection, names: Iterable[str], done: str = "corrected"
) -> dict[str, list[ImageKey]]:
    """The images of every name.

    Parameters
    ----------
    connection : Connection
    names : iterable of str
        In a pattern ``*``, ``?`` and ``[...]``. One with a slash is of whole paths, and ``*`` is
        any number of folders there; any other is of file names.
    done : str, optional
        What is not done where a name is wrong.

    Raises
    ------
    OptionError
        If a name means no image, or is a file name that several have.
    """
    columns = images.c.id, images.c.content, images.c.path, images.c.name
    kept = connection.execute(select(*columns).order_by(images.c.id)).all()
    places: dict[str, list[_Kept]] = {}
    for row in kept:
        for word in {row.path, row.name, row.content} - {None}:
            places.setdefault(word, []).append(row)
    found, faults = {}, []
    for name in dict.fromkeys(names):
        rows = places.get(name, [])
        if not rows and has_magic(name):
            rows = _matching(kept, name)
        elif len({row.content or row.path for row in rows}) > 1:
            faults.append(f"{name} names several images: give paths, SHA-256, or a pattern")
        if not rows:
            faults.append(f"there is no image {name}")
        found[name] = list(dict.fromkeys(row.content or row.id for row in rows))
    if faults:
        more = len(faults) - _MAX_LISTED
        listed = "; ".join(faults[:_MAX_LISTED]) + (f"; and {more} more" if more > 0 else "")
        raise OptionError(f"nothing is {done}: {listed}")
    return found


def _matching(kept: Sequence[_Kept], pattern: str) -> list[_Kept]:
    matches = re.compile(translate(pattern)).match
    if re.search(r"[/\\]", pattern):
        return [row for row in kept if row.path is not None and matches(row.path)]
    return [row for row in kept if row.name is not None and matches(row.name)]
