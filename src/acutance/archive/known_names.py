"""Names that occur in an archive: what a filter can select, and what it cannot."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sqlalchemy import Connection, select

from acutance.archive.connection import Database
from acutance.archive.selection import Selection, names_of
from acutance.errors import NothingSelectedError

__all__ = ["require_known_names"]

_MANY = 20


def require_known_names(database: Database, selections: Iterable[Selection]) -> None:
    """Refuse names that occur nowhere in the archive, all of them at once.

    Parameters
    ----------
    database : Database
    selections : iterable of Selection

    Raises
    ------
    NothingSelectedError
        Tells the names that occur.
    """
    several = list(selections)
    found = database.read(lambda connection: _unknown(connection, several))
    if found:
        raise NothingSelectedError(f"archive {database.place}: {'; '.join(found)}")


def _unknown(connection: Connection, selections: list[Selection]) -> list[str]:
    asked: dict[str, tuple[Any, dict[str, None]]] = {}
    for one in selections:
        for name, column, wanted in one.by_name():
            if wanted is not None:
                asked.setdefault(name, (column, {}))[1].update(dict.fromkeys(names_of(wanted)))
    found = []
    for name, (column, names) in asked.items():
        known = sorted(connection.execute(
            select(column).where(column.is_not(None)).distinct()
        ).scalars())  # fmt: skip
        missing = [repr(one) for one in names if one and one not in known]
        if missing:
            found.append(f"no {name} is called {' or '.join(missing)}, {_listed(known)}")
    return found


def _listed(known: list[str]) -> str:
    if not known:
        return "none is known"
    more = len(known) - _MANY
    return f"only {', '.join(known[:_MANY])}" + (f" and {more} more" if more > 0 else "")
