"""Measurements and rejections of an archive as columns."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Column, ColumnElement, Connection, Select, func, select

from acutance.archive.columns import Columns
from acutance.archive.connection import Database, in_chunks
from acutance.archive.counted import counted
from acutance.archive.packing import unpacked
from acutance.archive.restored_images import RESTORED_COLUMN
from acutance.archive.selection import Selection
from acutance.archive.tables import (
    VERDICTS,
    directions,
    documents,
    images,
    measurements,
    metric_columns,
    systematic_columns,
    targets,
)
from acutance.errors import OptionError
from acutance.targets.record import Record

__all__ = ["Measurements", "Rejections", "read_records", "select_measurements", "select_rejections"]

_MANY = 500

Load = Callable[[Sequence[int]], list[Record]]


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(Columns):
    """Measurements as columns: a row for each measurement and direction, oldest first.

    Columns: ``id`` (of the measurement, the same in all its directions), ``sensor``, ``level``,
    ``band``, ``site``, ``target``, ``kind``, ``method``, ``orientation``, ``acquired``, ``image``
    (its file name), ``image_id`` (equal for all rows of one image, and for its rejections, whatever
    is selected), ``run``, ``verdict``, ``snr``, ``normal_deg`` (the direction of the numbers, from
    the column axis towards the row axis, -90 to 90; ``angle_deg`` is the same, as tables were first
    written), ``gsd_m`` (along the direction), ``gsd_row_m`` and ``gsd_col_m`` (the sides of the
    image's pixels, along a column and along a row), ``view_zenith_deg``, ``sun_elevation_deg``,
    ``measured_at``, ``restored`` (whether the image was restored or sharpened before, by its
    notes), and every metric with its standard deviation (``mtf_nyquist``, ``mtf_nyquist_std``,
    ...). Of the three main numbers also what of it does not average out over images
    (``rer_systematic_std``, `acutance.archive.systematic`).

    Parameters
    ----------
    columns : mapping of str to (n,) array
    load : callable
        Reads the records of some measurements by their numbers.
    """

    load: Load = field(repr=False, compare=False)
    whole = ("run",)
    shown: ClassVar[tuple[str, ...]] = (
        "id", "sensor", "band", "target", "kind", "method", "orientation", "acquired", "verdict",
        "mtf_nyquist", "mtf_nyquist_std", "rer", "rer_std", "fwhm_px", "fwhm_px_std",
    )  # fmt: skip

    def record(self, i: int) -> Record:
        """The record of row `i`, with its curves and their covariance.

        Raises
        ------
        OptionError
            If there is no such row.
        """
        try:
            number = int(self.columns["id"][operator.index(i)])
        except (IndexError, TypeError):
            raise OptionError(
                f"row {i!r:.80} was requested of {counted(len(self), 'row')}, numbered from 0: "
                'record() takes the number of a row, Archive.entry() one of the column "id"'
            ) from None
        return self.load([number])[0]

    def records(self) -> list[Record]:
        """The records of all rows, each measurement once, in the order of the rows."""
        return self.load(list(dict.fromkeys(self.columns["id"].tolist())))

    def summary(self) -> str:
        """How many measurements, of which sensors."""
        sensors = sorted({name for name in self.columns["sensor"].tolist() if name is not None})
        number = len(set(self.columns["id"].tolist()))
        count = f"{counted(number, 'measurement')}, {counted(len(self), 'row')}"
        return f"{count}, {', '.join(sensors)}" if sensors else count


@dataclass(frozen=True, eq=False, repr=False)
class Rejections(Columns):
    """What was not measured as columns: where, at which stage, and why, oldest first."""

    whole = ("run",)
    shown: ClassVar[tuple[str, ...]] = (
        "id", "sensor", "band", "target", "kind", "acquired", "image", "stage", "reason",
    )  # fmt: skip

    def summary(self) -> str:
        """How many."""
        return f"{len(self)} rejected"


_SAME: Final = images.alias("same_content")
_IMAGE_ID: Final = func.coalesce(
    select(func.min(_SAME.c.id))
    .where(_SAME.c.content == images.c.content, _SAME.c.content != "")
    .scalar_subquery(),
    images.c.id,
)
"""One number for all rows of an image: the first in the archive of its content, if that is known.

Not the first that is selected, which measurements and rejections may have different ones of.
"""
_SHARED: tuple[tuple[str, ColumnElement[Any]], ...] = (
    ("id", measurements.c.id),
    ("sensor", images.c.sensor),
    ("level", images.c.level),
    ("band", measurements.c.band),
    ("site", targets.c.site),
    ("target", targets.c.name),
    ("kind", measurements.c.kind),
    ("method", measurements.c.method),
    ("acquired", images.c.acquired),
    ("image", images.c.name),
    ("image_id", _IMAGE_ID),
    ("run", measurements.c.run_id),
    ("view_zenith_deg", images.c.view_zenith_deg),
    ("sun_elevation_deg", images.c.sun_elevation_deg),
)
_MEASURED: tuple[tuple[str, ColumnElement[Any]], ...] = (
    ("orientation", directions.c.orientation),
    ("verdict", measurements.c.verdict),
    ("snr", measurements.c.snr),
    ("normal_deg", directions.c.angle_deg),
    ("angle_deg", directions.c.angle_deg),
    ("gsd_m", directions.c.gsd_m),
    ("gsd_row_m", images.c.gsd_row_m),
    ("gsd_col_m", images.c.gsd_col_m),
    ("measured_at", measurements.c.measured_at),
    ("restored", RESTORED_COLUMN),
    *((name, directions.c[name]) for name in (*metric_columns(), *systematic_columns())),
)
_REJECTED: tuple[tuple[str, Column[Any]], ...] = (
    ("stage", measurements.c.stage),
    ("reason", measurements.c.reason),
    ("values", measurements.c.rejected_values),
)
_TEXTS = frozenset(
    ("sensor", "level", "band", "site", "target", "kind", "method", "image", "orientation",
     "stage", "reason", "values")
)  # fmt: skip
_MOMENTS = frozenset(("acquired", "measured_at"))
_WHOLE = frozenset(("id", "image_id"))
_WORDS = np.array(VERDICTS, object)


def select_measurements(database: Database, selection: Selection) -> Measurements:
    """The measurements that a selection means, in the directions that their targets showed."""
    columns = (*_SHARED, *_MEASURED)
    asked = select(*(column.label(name) for name, column in columns))
    asked = _with_images(asked).join(directions, directions.c.measurement_id == measurements.c.id)
    asked = asked.where(directions.c.measured, *selection.of_measurements())
    found = _read_columns(database, asked, [name for name, _ in columns])
    found["verdict"] = _WORDS[found["verdict"].astype(int)]
    order = _oldest_first(found, found["orientation"] == "along")
    return Measurements(
        {name: column[order] for name, column in found.items()},
        lambda ids: read_records(database, ids),
    )


def select_rejections(database: Database, selection: Selection) -> Rejections:
    """What a selection means of what was not measured.

    Raises
    ------
    OptionError
        If the selection is one of directions, verdicts or numbers, which rejections do not have.
    """
    for name in ("orientation", "verdict", "limits"):
        if getattr(selection, name) is not None:
            raise OptionError(f"what was rejected has no {name}: select by other filters")
    columns = (*_SHARED, *_REJECTED)
    asked = _with_images(select(*(column.label(name) for name, column in columns)))
    asked = asked.where(measurements.c.stage.is_not(None), *selection.of_entries())
    found = _read_columns(database, asked, [name for name, _ in columns])
    order = _oldest_first(found, np.zeros(len(found["id"])))
    return Rejections({name: column[order] for name, column in found.items()})


def read_records(database: Database, ids: Sequence[int]) -> list[Record]:
    """The records of measurements by their numbers, in the order that is given.

    Raises
    ------
    OptionError
        If there is no measurement of a number.
    ArchiveError
        If the document of one is damaged.
    """
    stored: dict[int, bytes] = {}
    for some in in_chunks(ids, _MANY):
        asked = select(documents).where(documents.c.measurement_id.in_(some))
        stored |= database.read(partial(_by_number, asked=asked))
    missing = [number for number in ids if number not in stored]
    if missing:
        raise OptionError(f"there is no measurement {missing[0]} in the archive")
    return [Record(unpacked(stored[number], number)) for number in ids]


def _by_number(connection: Connection, asked: Select[Any]) -> dict[int, bytes]:
    return {row.measurement_id: row.document for row in connection.execute(asked)}


def _with_images(asked: Select[Any]) -> Select[Any]:
    joined = measurements.join(images).outerjoin(targets, measurements.c.target_id == targets.c.id)
    return asked.select_from(joined)


def _read_columns(
    database: Database, asked: Select[Any], names: Sequence[str]
) -> dict[str, NDArray[Any]]:
    rows = database.read(lambda connection: connection.execute(asked).all())
    listed: Iterable[Sequence[Any]] = zip(*rows, strict=True) if rows else [()] * len(names)
    return {name: _column(name, values) for name, values in zip(names, listed, strict=True)}


def _column(name: str, values: Sequence[Any]) -> NDArray[Any]:
    if name in _TEXTS:
        texts = np.empty(len(values), object)
        texts[:] = values
        return texts
    if name in _MOMENTS:
        return np.array([_without_zone(one) for one in values], "datetime64[us]")
    if name == "restored":
        return np.array(values, bool)
    return np.array(values, np.int64 if name in _WHOLE else float)


def _without_zone(when: datetime | None) -> datetime | None:
    return None if when is None else when.replace(tzinfo=None)


def _oldest_first(found: dict[str, NDArray[Any]], direction: NDArray[Any]) -> NDArray[np.intp]:
    return np.lexsort((direction, found["id"], found["acquired"]))
