"""What was found out about image files, so that they need not be read to know them again.

A small database in the user's cache folder. It holds nothing that is not found out again: where it
cannot be written or is damaged, files are read once more.
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterable, Mapping
from contextlib import closing
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from acutance.batch.image_list import ImageFile
from acutance.batch.path_text import path_as_text

__all__ = ["KnownImage", "RememberedImages"]

_TABLE = (
    "CREATE TABLE IF NOT EXISTS images_1 "
    "(path TEXT PRIMARY KEY, stamp TEXT NOT NULL, known TEXT NOT NULL)"
)
_PATIENCE_S = 2.0


@dataclass(frozen=True)
class KnownImage:
    """What is known of an image file.

    Parameters
    ----------
    content : str
        SHA-256 of its bytes.
    bands : tuple of (number, name), or None
        None where the image has not been opened, empty where it cannot be.
    day : str or None
        Of the acquisition.
    by_rpc : bool
        Whether its RPC locate it, and need the height of the ground.
    stated : str
        Digest of the statement of the plan by which bands and day were found out.
    facts : mapping
        What the image says of itself, with the documents beside it.
    """

    content: str
    bands: tuple[tuple[int, str | None], ...] | None = None
    day: str | None = None
    by_rpc: bool = False
    stated: str = ""
    facts: Mapping[str, Any] = field(default_factory=dict)

    def under(self, stated: str) -> KnownImage:
        """What is known of it under a statement: its content alone, if that is another."""
        return self if stated == self.stated else KnownImage(self.content)


class RememberedImages:
    """Images by their paths, with their stamps.

    Parameters
    ----------
    place : Path, optional
        The database; in the user's cache folder without it.
    """

    def __init__(self, place: Path | None = None) -> None:
        self.place = place or _cache_folder() / "images.db"

    def known(self, files: Iterable[ImageFile]) -> dict[str, KnownImage]:
        """What is remembered of files that have not changed, by path."""
        try:
            with closing(self._opened()) as database:
                read = database.execute("SELECT path, stamp, known FROM images_1")
                rows = {path: (stamp, text) for path, stamp, text in read}
        except (sqlite3.Error, OSError):
            return {}
        found = {}
        for file in files:
            stamp, text = rows.get(_name(file), ("", ""))
            if file.stamp and stamp == file.stamp:
                known = _known_image(text)
                if known is not None:
                    found[file.path] = known
        return found

    def remember(self, images: Mapping[ImageFile, KnownImage]) -> None:
        """Write down what was found out."""
        rows = [
            (_name(file), file.stamp, json.dumps(asdict(known)))
            for file, known in images.items()
            if file.stamp
        ]
        try:
            with closing(self._opened()) as database, database:
                database.executemany("INSERT OR REPLACE INTO images_1 VALUES (?, ?, ?)", rows)
        except (sqlite3.Error, OSError):
            return

    def _opened(self) -> sqlite3.Connection:
        self.place.parent.mkdir(parents=True, exist_ok=True)
        database = sqlite3.connect(self.place, timeout=_PATIENCE_S)
        # What a sudden end of the machine loses is found out again.
        database.execute("PRAGMA synchronous = OFF")
        database.execute(_TABLE)
        return database


def _name(file: ImageFile) -> str:
    return path_as_text(os.path.realpath(file.path))


def _cache_folder() -> Path:
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "acutance"


def _known_image(text: str) -> KnownImage | None:
    try:
        found = json.loads(text)
        bands = found["bands"]
        named = None if bands is None else tuple((int(one), name) for one, name in bands)
        by_rpc, stated, facts = bool(found["by_rpc"]), str(found["stated"]), found.get("facts")
        if facts is None:
            # Earlier versions did not write them down: the image is opened once more.
            return KnownImage(str(found["content"]))
        return KnownImage(str(found["content"]), named, found["day"], by_rpc, stated, facts)
    except (ValueError, KeyError, TypeError):
        return None
