"""Errors of the database in words: what happened to the archive, and what to do."""

from __future__ import annotations

from typing import Any

from sqlalchemy.exc import DBAPIError, OperationalError

from acutance.errors import ArchiveError

__all__ = ["explained", "is_passing"]

_PASSING = ("08", "40", "57P", "55P03", "53300")
"""Beginnings of PostgreSQL's codes for what may work a moment later: a connection that is lost or
not to be had, transactions that met, a server that stops or starts."""

_SQLITE = {
    "SQLITE_NOTADB": "is no archive: the file is not a database of SQLite",
    "SQLITE_CORRUPT": "is damaged: take a copy of it, and try sqlite3 FILE .recover",
    "SQLITE_FULL": "cannot be written, the disk is full: nothing of this step was kept; make room "
    "and do it again",
    "SQLITE_READONLY": "cannot be written, it is read-only: give the right to write to the file "
    "and its folder, or open it with read_only=True",
    "SQLITE_BUSY": "is in use by another program, which has not ended its writing in {patience:g} "
    "s: do it again later",
    "SQLITE_LOCKED": "is in use by another program: do it again later",
    "SQLITE_CANTOPEN": "cannot be opened: it takes the right to read and write the file and its "
    "folder",
    "SQLITE_IOERR": "cannot be read or written, the disk reports an error: nothing of this step "
    "was kept",
}
_POSTGRES = {
    "53100": "cannot be written, the server's disk is full: nothing of this step was kept",
    "25006": "cannot be written, the server is read-only",
    "42501": "cannot be used: the user lacks the right ({reason})",
    "3D000": "is not there: create the database first (createdb)",
    "28": "cannot be opened: the server refuses the user ({reason})",
}
_REFUSALS = {
    'FATAL:  database "': "3D000",
    "authentication failed": "28P01",
    'FATAL:  role "': "28000",
    "no pg_hba.conf entry": "28000",
}


def is_passing(error: DBAPIError) -> bool:
    """Whether the same may work a moment later."""
    code = _code(error)
    if code.startswith("SQLITE"):
        return code.startswith(("SQLITE_BUSY", "SQLITE_LOCKED"))
    if code:
        return code.startswith(_PASSING)
    # A connection that was not made, and not refused for one of the reasons below.
    of_server = type(error.orig).__module__.startswith("psycopg")
    return of_server and isinstance(error, OperationalError)


def explained(error: DBAPIError, place: str, patience_s: float) -> ArchiveError:
    """The error as a message: the archive, what happened to it, and what to do.

    Parameters
    ----------
    error : DBAPIError
    place : str
        Of the archive, without a password.
    patience_s : float
        How long was waited.
    """
    code, reason = _code(error), _reason(error)
    if is_passing(error) and not code.startswith("SQLITE"):
        return ArchiveError(
            f"archive {place} cannot be reached for {patience_s:g} s ({reason}): start the server, "
            "or correct the address; what was reported as kept is kept"
        )
    for beginning, words in (_SQLITE | _POSTGRES).items():
        if code.startswith(beginning):
            told = words.format(patience=patience_s, reason=reason)
            return ArchiveError(f"archive {place} {told}")
    return ArchiveError(f"archive {place} cannot be used: {reason}")


def _code(error: DBAPIError) -> str:
    """The name of SQLite's, or the SQLSTATE of PostgreSQL's error; empty where there is none."""
    orig: Any = error.orig
    code = getattr(orig, "sqlite_errorname", None) or getattr(orig, "sqlstate", None)
    if code:
        return str(code)
    # What is refused while a connection is made has words only.
    reason = str(orig)
    return next((code for words, code in _REFUSALS.items() if words in reason), "")


def _reason(error: DBAPIError) -> str:
    """The first line of what the database says."""
    lines = str(error.orig).strip().splitlines()
    return lines[0] if lines else type(error.orig).__name__
