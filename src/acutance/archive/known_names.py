"""Names that occur in an archive: what a filter can select, and what it cannot."""

from __future__ import annotations

from sqlalchemy import Connection, select

from acutance.archive.connection import Database
from acutance.archive.selection import Selection, names_of
from acutance.archive.tables import measurements
from acutance.errors import NothingSelectedError

__all__ = ["require_known_names", "unknown_names"]

_MANY = 20


def require_known_names(database: Database, selection: Selection) -> None:
    """Refuse names that occur nowhere in the archive, all of them at once, and an empty archive.

    Parameters
    ----------
    database : Database
    selection : Selection

    Raises
    ------
    NothingSelectedError
        Tells the names that occur, or that there is nothing at all.
    """
    if database.read(_is_empty):
        raise NothingSelectedError(
            f"archive {database.place} is empty: add measurements to it (acutance archive import, "
            "acutance batch, Archive.add)"
        )
    found = unknown_names(database, selection)
    if found:
        raise NothingSelectedError(f"archive {database.place}: {found}")


def unknown_names(database: Database, selection: Selection) -> str:
    """Which names of a selection occur nowhere, and which do; "" where all occur.

    Parameters
    ----------
    database : Database
    selection : Selection
    """
    return "; ".join(database.read(lambda connection: _unknown(connection, selection)))


def _is_empty(connection: Connection) -> bool:
    return connection.execute(select(measurements.c.id).limit(1)).first() is None


def _unknown(connection: Connection, selection: Selection) -> list[str]:
    found = []
    for name, column, wanted in selection.by_name():
        if wanted is None:
            continue
        known = sorted(connection.execute(
            select(column).where(column.is_not(None)).distinct()
        ).scalars())  # fmt: skip
        missing = [repr(one) for one in dict.fromkeys(names_of(wanted)) if one and one not in known]
        if missing:
            found.append(f"no {name} is called {' or '.join(missing)}, {_listed(known)}")
    return found


def _listed(known: list[str]) -> str:
    if not known:
        return "none is known"
    more = len(known) - _MANY
    return f"only {', '.join(known[:_MANY])}" + (f" and {more} more" if more > 0 else "")
