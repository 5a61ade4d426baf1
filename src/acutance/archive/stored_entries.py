"""Rows become entries again, as they were added."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import partial

from sqlalchemy import Connection, RowMapping, exists, select

from acutance.archive.connection import Database
from acutance.archive.entry import Entry, ImageEntry, RunEntry, TargetEntry
from acutance.archive.packing import unpacked
from acutance.archive.runs import runs_by_id
from acutance.archive.selection import Selection
from acutance.archive.tables import directions, documents, images, measurements, targets
from acutance.errors import ArchiveError
from acutance.targets.record import Record
from acutance.targets.target_result import Rejected

__all__ = ["select_ids", "stored_entries", "undamaged_entries"]

_SOME = 500

_OF_TARGET = ("name", "kind", "definition", "site", "valid_from", "valid_to", "lon", "lat")
_OF_IMAGE = (
    "path", "content", "sensor", "level", "acquired", "view_zenith_deg", "view_azimuth_deg",
    "sun_elevation_deg", "sun_azimuth_deg", "sources",
)  # fmt: skip


def stored_entries(
    database: Database, ids: Sequence[int], damaged: Callable[[ArchiveError], None] | None = None
) -> Iterator[Entry]:
    """Entries by their numbers, read some hundred at a time.

    Parameters
    ----------
    database : Database
    ids : sequence of int
    damaged : callable, optional
        Called with the error of each damaged document, which is passed over then.

    Raises
    ------
    ArchiveError
        If a document is damaged and nothing was given to be called.
    """
    for first in range(0, len(ids), _SOME):
        for row, run in database.read(partial(_read, ids=ids[first : first + _SOME])):
            try:
                entry = _entry(row, run)
            except ArchiveError as error:
                if damaged is None:
                    raise
                damaged(error)
            else:
                yield entry


def undamaged_entries(database: Database, ids: Sequence[int]) -> Iterator[Entry]:
    """Entries by their numbers; at the end a warning names damaged ones, which are left out."""
    damaged: list[ArchiveError] = []
    yield from stored_entries(database, ids, damaged.append)
    if damaged:
        more = f" (and {len(damaged) - 1} more)" if len(damaged) > 1 else ""
        warnings.warn(f"left out: {damaged[0]}{more}", stacklevel=2)


def select_ids(database: Database, selection: Selection) -> list[int]:
    """Numbers of the entries that a selection means, in the order of the numbers.

    A measurement is meant if one of its directions is. Rejections have neither directions nor
    verdicts: they are meant where the selection asks for none.
    """
    joined = measurements.join(images).outerjoin(targets, measurements.c.target_id == targets.c.id)
    asked = select(measurements.c.id).select_from(joined).where(*selection.of_entries())
    of_directions = tuple(selection.of_directions())
    if of_directions:
        own = directions.c.measurement_id == measurements.c.id
        asked = asked.where(exists().where(own, directions.c.measured, *of_directions))
    asked = asked.order_by(measurements.c.id)
    return database.read(lambda connection: list(connection.execute(asked).scalars()))


def _read(connection: Connection, ids: Sequence[int]) -> list[tuple[RowMapping, RunEntry | None]]:
    """Rows of entries, and the runs that wrote them."""
    joined = (
        measurements.join(images)
        .outerjoin(targets, measurements.c.target_id == targets.c.id)
        .outerjoin(documents, documents.c.measurement_id == measurements.c.id)
    )
    asked = select(
        *(measurements.c[name] for name in ("key", "band", "stage", "reason", "rejected_values")),
        measurements.c.id,
        measurements.c.run_id,
        documents.c.document,
        images.c.gsd_row_m,
        images.c.gsd_col_m,
        *(images.c[name].label(f"image_{name}") for name in _OF_IMAGE),
        *(targets.c[name].label(f"target_{name}") for name in _OF_TARGET),
    )
    asked = asked.select_from(joined).where(measurements.c.id.in_(ids)).order_by(measurements.c.id)
    rows = connection.execute(asked).mappings().all()
    runs = runs_by_id(connection, (row["run_id"] for row in rows))
    return [(row, runs.get(row["run_id"])) for row in rows]


def _entry(row: RowMapping, run: RunEntry | None) -> Entry:
    gsd_m = None if row["gsd_row_m"] is None else (row["gsd_row_m"], row["gsd_col_m"])
    image = ImageEntry(gsd_m=gsd_m, **{name: row[f"image_{name}"] for name in _OF_IMAGE})
    target = None
    if row["target_name"] is not None:
        target = TargetEntry(**{name: row[f"target_{name}"] for name in _OF_TARGET})
    record, rejected = None, None
    if row["document"] is not None:
        record = Record(unpacked(row["document"], row["id"]))
    else:
        rejected = Rejected(row["stage"], row["reason"], row["rejected_values"])
    return Entry(
        record=record, rejected=rejected, image=image, target=target, band=row["band"],
        key=row["key"], run=run,
    )  # fmt: skip
