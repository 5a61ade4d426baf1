"""Finished windows in a file, so that an interrupted scan goes on where it was.

The file is a database (SQLite): a window is there whole or not at all, whatever ends the process.
Its numbers are arrays without pickled objects, so that a file of others can do no harm.
"""

from __future__ import annotations

import io
import json
import os
import sqlite3
import zipfile
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from acutance.arguments import require_path
from acutance.errors import OptionError
from acutance.scan.scan_identity import difference
from acutance.scan.window_edges import UsedEdge, WindowEdges

__all__ = ["KeptWindows"]

_APPLICATION = 0x4D544653
"""Marks the database as one of ours."""
_TABLES = (
    "CREATE TABLE scan (identity TEXT NOT NULL)",
    "CREATE TABLE windows (place INTEGER, band INTEGER, content BLOB, PRIMARY KEY (place, band))",
)


class KeptWindows:
    """The finished windows of one scan; use it as a context.

    Parameters
    ----------
    path : path
        Made if it does not exist; its folder has to.
    identity : mapping
        Of the scan (`acutance.scan.scan_identity`): the file of another one is refused.

    Attributes
    ----------
    path : Path
    done : dict of int to list of WindowEdges
        Windows that were finished earlier, by their place: the edges of every band.

    Raises
    ------
    OptionError
        If the file is of another scan, no such file, used by another process, or cannot be
        written.
    """

    def __init__(self, path: str | os.PathLike[str], identity: Mapping[str, Any]) -> None:
        require_path(keep=path)
        self.path = Path(path)
        bands = len(identity["images"])
        try:
            self._database = sqlite3.connect(self.path, timeout=0, isolation_level=None)
        except sqlite3.Error as error:
            raise OptionError(self._refusal(error)) from error
        try:
            # Until the file is closed no other process gets in.
            self._database.execute("PRAGMA locking_mode = EXCLUSIVE")
            self._database.execute("BEGIN EXCLUSIVE")
            self._require_same(json.loads(json.dumps(identity)))
            self._database.execute("COMMIT")
            self.done = self._read(bands)
        except BaseException as error:
            self._database.close()
            if isinstance(error, sqlite3.Error):
                raise OptionError(self._refusal(error)) from error
            raise

    def _require_same(self, identity: dict[str, Any]) -> None:
        """Make the tables of a new file; refuse one of another scan.

        Raises
        ------
        OptionError
            If it is.
        """
        (mark,) = self._database.execute("PRAGMA application_id").fetchone()
        (tables,) = self._database.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if tables == 0:
            for table in _TABLES:
                self._database.execute(table)
            self._database.execute(f"PRAGMA application_id = {_APPLICATION}")
            self._database.execute("INSERT INTO scan VALUES (?)", (json.dumps(identity),))
            return
        if mark != _APPLICATION:
            raise OptionError(f"{self.path} is a database of another program: name another file")
        (text,) = self._database.execute("SELECT identity FROM scan").fetchone()
        other = difference(identity, json.loads(text))
        if other is not None:
            raise OptionError(
                f"{self.path} keeps the windows of another scan: {other} differs. Name another "
                "file, or remove this one"
            )

    def _read(self, bands: int) -> dict[int, list[WindowEdges]]:
        """All windows that are there in every band; what cannot be read is scanned again."""
        found: dict[int, dict[int, WindowEdges]] = {}
        for place, band, content in self._database.execute("SELECT * FROM windows"):
            try:
                found.setdefault(place, {})[band] = _unpacked(content)
            except (ValueError, KeyError, TypeError, OSError, zipfile.BadZipFile):
                continue
        return {
            place: [own[band] for band in range(bands)]
            for place, own in found.items()
            if len(own) == bands
        }

    def keep(self, place: int, found: list[WindowEdges]) -> None:
        """Keep a finished window.

        Raises
        ------
        OptionError
            If the file cannot be written.
        """
        rows = [(place, band, _packed(one)) for band, one in enumerate(found)]
        try:
            self._database.execute("BEGIN")
            self._database.executemany("INSERT OR REPLACE INTO windows VALUES (?, ?, ?)", rows)
            self._database.execute("COMMIT")
        except sqlite3.Error as error:
            raise OptionError(self._refusal(error)) from error

    def __enter__(self) -> KeptWindows:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._database.close()

    def _refusal(self, error: sqlite3.Error) -> str:
        if "locked" in str(error):
            return f"{self.path} is in use by another scan: wait for it, or name another file"
        if "not a database" in str(error):
            return f"{self.path} is no file of kept windows: name another file"
        if not self.path.parent.is_dir():
            return (
                f"finished windows cannot be kept in {self.path}: the folder {self.path.parent} "
                "does not exist, make it first"
            )
        return f"finished windows cannot be kept in {self.path} ({error}): name another file"


def _packed(found: WindowEdges) -> bytes:
    """The edges of a window as a .npz file: rows as JSON, of every array those of all edges."""
    rows = json.dumps(found.rows, default=_plain).encode()
    arrays: dict[str, Any] = {"rows": np.frombuffer(rows, np.uint8)}
    for name in _FIELDS:
        each = [np.asarray(getattr(one, name)) for one in found.used]
        arrays[f"{name}.shape"] = np.array([one.shape for one in each], np.int64)
        if each:
            arrays[name] = np.concatenate([one.ravel() for one in each])
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


_FIELDS = tuple(one.name for one in fields(UsedEdge))


def _plain(value: Any) -> Any:
    """A number of numpy as one that JSON has."""
    return value.item()


def _unpacked(content: bytes) -> WindowEdges:
    """The edges of a window; any of the errors of a file that is something else."""
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        rows = json.loads(arrays["rows"].tobytes())
        columns = {name: _split(arrays, name) for name in _FIELDS}
    used = [
        UsedEdge(**dict(zip(columns, values, strict=True)))
        for values in zip(*columns.values(), strict=True)
    ]
    return WindowEdges(rows, used)


def _split(arrays: Any, name: str) -> list[Any]:
    """The arrays of one field, one an edge; numbers as such."""
    shapes = arrays[f"{name}.shape"]
    if not len(shapes):
        return []
    ends = np.cumsum(shapes.prod(axis=1))[:-1]
    parts = np.split(arrays[name], ends.astype(int))
    return [
        part.item() if not shape.size else part.reshape(shape)
        for part, shape in zip(parts, shapes, strict=True)
    ]
