"""Under which key an entry is kept: its own, or one that an older version derived."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sqlalchemy import Connection, select

from acutance.archive.identity import Stated, stated_of
from acutance.archive.packing import unpacked
from acutance.archive.rows import EntryRows
from acutance.archive.tables import documents, measurements
from acutance.targets.record import Record

__all__ = ["kept_keys"]


def kept_keys(connection: Connection, entries: Sequence[EntryRows]) -> dict[str, str]:
    """Keys of entries that are there, each with the key of its row.

    Parameters
    ----------
    connection : Connection
    entries : sequence of EntryRows

    Returns
    -------
    dict of str to str
        A row of an older version is that of an entry if the same was stated for both: its key did
        not depend on it.
    """
    there = select(measurements.c.key).where(measurements.c.key.in_([one.key for one in entries]))
    found = {key: key for key in connection.execute(there).scalars()}
    older = [one for one in entries if one.older_key is not None and one.key not in found]
    if not older:
        return found
    kept = _stated_by_key(connection, {one.older_key for one in older if one.older_key})
    for one in older:
        if one.older_key in kept and _agree(kept[one.older_key], one.stated):
            found[one.key] = one.older_key
    return found


def _stated_by_key(connection: Connection, keys: Iterable[str]) -> dict[str, Stated]:
    """What was stated of measurements that are kept."""
    asked = (
        select(measurements.c.key, documents)
        .join(documents, documents.c.measurement_id == measurements.c.id)
        .where(measurements.c.key.in_(list(keys)))
    )
    rows = connection.execute(asked).all()
    return {row.key: stated_of(Record(unpacked(row.document, row.measurement_id))) for row in rows}


def _agree(kept: Stated, stated: Stated) -> bool:
    """Whether all that both hold is the same."""
    return all(kept[name] == stated[name] for name in kept.keys() & stated.keys())
