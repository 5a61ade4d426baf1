"""The database of an archive: a file of SQLite, or PostgreSQL by its URL.

Every piece of work is one transaction. One that writes takes SQLite's lock at its beginning, so
that it waits for others and never meets them halfway. What fails for a passing reason (a server
that starts again, transactions that met) is done again until `PATIENCE_S` has passed.
"""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from sqlalchemy import URL, Connection, Engine, Table, create_engine, event, make_url
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError
from sqlalchemy.pool import QueuePool

from acutance.archive.failures import explained, is_passing
from acutance.errors import ArchiveError

__all__ = [
    "PATIENCE_S", "Database", "file_of", "in_chunks", "insert_missing", "is_there", "open_database",
]  # fmt: skip

Done = TypeVar("Done")
Value = TypeVar("Value")

PATIENCE_S = 20.0
"""How long a busy file, or a server that does not answer, is waited for."""

_MOST_VALUES = 2000
"""In one question: databases take some ten thousand."""
_PAUSE_S = 0.1
_MAKING_S = 5.0
"""A new file is empty until its tables are made."""
_CACHE_KB = 65_536
_LOG_PAGES = 8_000
_WRITES = "acutance_writes"
_DRIVER = "postgresql+psycopg"


@dataclass(frozen=True)
class Database:
    """Where an archive is kept.

    Parameters
    ----------
    engine : Engine
    place : str
        The file, or the URL without its password.
    read_only : bool
    """

    engine: Engine
    place: str
    read_only: bool

    @property
    def is_file(self) -> bool:
        """Whether it is a file of SQLite."""
        return self.engine.dialect.name == "sqlite"

    def read(self, work: Callable[[Connection], Done]) -> Done:
        """Do something that only reads, in one transaction.

        Raises
        ------
        ArchiveError
            If the database cannot be used, or not within `PATIENCE_S`.
        """
        return self._done(work, writes=False)

    def write(self, work: Callable[[Connection], Done]) -> Done:
        """Do something that writes, in one transaction: all of it is kept, or nothing.

        It is done again where it failed for a passing reason, so it must not do anything else.

        Raises
        ------
        ArchiveError
            If the archive was opened to be read, cannot be written, or not within `PATIENCE_S`.
        """
        if self.read_only:
            raise ArchiveError(
                f"archive {self.place} was opened to be read: open it without read_only=True"
            )
        return self._done(work, writes=True)

    def use_write_ahead_log(self) -> None:
        """Let readers of a file go on while another process writes."""
        if self.is_file:
            self._done(_set_write_ahead_log, writes=None)

    def _done(self, work: Callable[[Connection], Done], writes: bool | None) -> Done:
        given_up = time.monotonic() + PATIENCE_S
        while True:
            try:
                with self.engine.connect() as connection:
                    connection.execution_options(**{_WRITES: writes})
                    with connection.begin():
                        return work(connection)
            except UnicodeEncodeError as error:
                raise ArchiveError(
                    f"archive {self.place} cannot keep a text with half a character "
                    f"({error.object!r:.60}): correct it"
                ) from error
            except DBAPIError as error:
                if not is_passing(error) or time.monotonic() > given_up:
                    raise explained(error, self.place, PATIENCE_S) from error
            time.sleep(_PAUSE_S)

    def close(self) -> None:
        """Close all connections; the next piece of work opens one again."""
        self.engine.dispose()


def is_there(place: str | os.PathLike[str]) -> bool:
    """Whether a place is a file that exists already, or a server's: those are not made here."""
    file = file_of(place)
    return file is None or file.exists()


def file_of(place: str | os.PathLike[str]) -> Path | None:
    """The file of a place, be it there yet or not; None of a server's."""
    text = _as_text(place)
    if "://" not in text:
        return Path(text)
    url = _url(text)
    return Path(url.database or "") if url.get_backend_name() == "sqlite" else None


def open_database(place: str | os.PathLike[str], *, read_only: bool = False) -> Database:
    """The database of a place; nothing is read yet.

    Parameters
    ----------
    place : path or str
        A file of SQLite, or a URL ``postgresql+psycopg://USER@HOST/DATABASE``.
    read_only : bool, optional

    Raises
    ------
    ArchiveError
        If there can be no archive in that place, or the library for it is not installed.
    """
    text = _as_text(place)
    if "://" not in text:
        return _file_database(Path(text), read_only)
    url = _url(text)
    if url.get_backend_name() == "sqlite":
        if not url.database or url.database == ":memory:":
            raise ArchiveError(f"archive {text} names no file: write sqlite:///FILE, or the file")
        return _file_database(Path(url.database), read_only)
    return _server_database(url, read_only)


def in_chunks(values: Iterable[Value], most: int = _MOST_VALUES) -> Iterator[list[Value]]:
    """Values in lists that are short enough for one question.

    Parameters
    ----------
    values : iterable
    most : int, optional
        Fewer where every answer is large.
    """
    every = list(values)
    for first in range(0, len(every), most):
        yield every[first : first + most]


def insert_missing(
    connection: Connection, table: Table, unique: str
) -> sqlite.Insert | postgresql.Insert:
    """An insert that passes over rows whose unique column is there."""
    insert = sqlite.insert if connection.dialect.name == "sqlite" else postgresql.insert
    return insert(table).on_conflict_do_nothing(index_elements=[unique])


def _as_text(place: str | os.PathLike[str]) -> str:
    try:
        return os.fsdecode(place)
    except TypeError:
        raise ArchiveError(
            f"archive {place!r:.80} names no file: give the path of a file, or "
            f"{_DRIVER}://USER@HOST/DATABASE"
        ) from None


def _url(text: str) -> URL:
    try:
        url = make_url(text)
    except (ArgumentError, ValueError) as error:
        raise ArchiveError(
            f"archive {text} is no URL: write {_DRIVER}://USER@HOST/DATABASE"
        ) from error
    if url.drivername in ("postgres", "postgresql"):
        url = url.set(drivername=_DRIVER)
    if url.drivername not in ("sqlite", "sqlite+pysqlite", _DRIVER):
        raise ArchiveError(
            f"archives are kept by SQLite and PostgreSQL, not by {url.drivername}: give a file, or "
            f"{_DRIVER}://USER@HOST/DATABASE"
        )
    return url


def _file_database(path: Path, read_only: bool) -> Database:
    _require_file_place(path, read_only)
    address = _file_address(path, read_only)

    def connect() -> sqlite3.Connection:
        # Transactions are begun by the listener below, not by the driver.
        connection = sqlite3.connect(
            address, timeout=PATIENCE_S, isolation_level=None, check_same_thread=False, uri=True
        )
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute(f"PRAGMA query_only = {int(read_only)}")
        # The keys of a chunk lie all over their index: pages wait until several chunks are written.
        connection.execute(f"PRAGMA cache_size = {-_CACHE_KB}")
        connection.execute(f"PRAGMA wal_autocheckpoint = {_LOG_PAGES}")
        return connection

    engine = create_engine("sqlite://", creator=connect, poolclass=QueuePool)
    event.listen(engine, "begin", _begin)
    return Database(engine, str(path), read_only)


def _require_file_place(path: Path, read_only: bool) -> None:
    if path.is_dir():
        raise ArchiveError(f"archive {path} is a folder: name a file in it")
    if read_only and not path.exists():
        raise ArchiveError(f"archive {path} is not there: correct its name")
    if path.exists() and _is_empty(path):
        raise ArchiveError(
            f"archive {path} is no archive: the file is empty; remove it, or name another"
        )
    if not path.parent.is_dir():
        raise ArchiveError(
            f"archive {path} cannot be made, there is no folder {path.parent}: make it first"
        )


def _is_empty(path: Path) -> bool:
    """Whether a file holds nothing, and is not just being made by another process."""
    while (about := path.stat()).st_size == 0:
        if not 0 <= time.time() - about.st_mtime < _MAKING_S:
            return True
        time.sleep(_PAUSE_S)
    return False


def _file_address(path: Path, read_only: bool) -> str:
    """The URI of a file: made where there is none, unless it is only read.

    A file that is only read is opened to be written if it may be, or SQLite could not clear away
    the log beside it; `PRAGMA query_only` then refuses writing. Where not even its folder may be
    written, no other process writes it, and no log is needed.
    """
    address = f"file:{quote(str(path))}"
    if not read_only:
        return address
    if os.access(path, os.W_OK) and os.access(path.parent, os.W_OK):
        return f"{address}?mode=rw"
    logged = path.with_name(f"{path.name}-wal").exists()
    return f"{address}?mode=ro{'' if logged else '&immutable=1'}"


def _begin(connection: Connection) -> None:
    writes = connection.get_execution_options().get(_WRITES)
    if writes is not None:
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def _set_write_ahead_log(connection: Connection) -> None:
    connection.exec_driver_sql("PRAGMA journal_mode = WAL")


def _server_database(url: URL, read_only: bool) -> Database:
    waited = {"connect_timeout": max(int(PATIENCE_S / 4), 1)}
    try:
        engine = create_engine(url, connect_args=waited, pool_pre_ping=True)
    except (ModuleNotFoundError, NoSuchModuleError) as error:
        raise ArchiveError(
            "archives in PostgreSQL need psycopg, which is not installed: pip install "
            "'acutance[postgres]'"
        ) from error
    return Database(engine, url.render_as_string(hide_password=True), read_only)
