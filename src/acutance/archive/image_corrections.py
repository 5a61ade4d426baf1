"""What is known of images that are kept already is corrected: dates, sensors, levels, GSD, angles.

The row of an image keeps the identity it was added with: a batch that adds to the image later, and
knows it as before, finds the corrected row and measures nothing again. One that knows it otherwise
makes another row of the same content: the corrections are carried over to it. Measurements stay as
they are; what was there before, and since when it is another, stands in the sources of the image.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from fnmatch import fnmatchcase
from functools import partial
from glob import has_magic
from typing import Any, Final

from sqlalchemy import Connection, RowMapping, func, select, update

from acutance.archive.connection import Database
from acutance.archive.counted import counted
from acutance.archive.dates import When, as_utc
from acutance.archive.packing import plain_json
from acutance.archive.tables import directions, images, measurements
from acutance.errors import OptionError

__all__ = [
    "CORRECTED",
    "CorrectedImage",
    "ImageCorrection",
    "correct_images",
    "with_corrections",
]

ANGLES: Final = (
    "view_zenith_deg", "view_azimuth_deg", "sun_elevation_deg", "sun_azimuth_deg",
)  # fmt: skip
CORRECTED: Final = ("sensor", "level", "acquired", "gsd_m", *ANGLES)
"""What of an image can be corrected."""
_LIMITS: Final = {
    "view_zenith_deg": (0.0, 90.0), "view_azimuth_deg": (-180.0, 360.0),
    "sun_elevation_deg": (-90.0, 90.0), "sun_azimuth_deg": (-180.0, 360.0),
}  # fmt: skip
_NOTED: Final = "corrections"
_SAME_GSD: Final = 1e-6


@dataclass(frozen=True, kw_only=True)
class ImageCorrection:
    """What is to be known of an image from now on; ``None`` leaves it as it is.

    Parameters
    ----------
    image : str
        Its path, file name or SHA-256; a pattern (``"K3_*.tif"``) means all that match.
    sensor, level : str, optional
    acquired : datetime, date or str, optional
        Without a time zone UTC.
    gsd_m : float or (float, float), optional
        From row to row and from column to column.
    view_zenith_deg, view_azimuth_deg, sun_elevation_deg, sun_azimuth_deg : float, optional
    reason : str, optional
        Kept with the correction.

    Raises
    ------
    OptionError
        If a value cannot be one, or nothing is corrected.

    Examples
    --------
    >>> wrong = ImageCorrection(image="scene.tif", acquired="2026-05-01", reason="clock")
    >>> archive.correct_images([wrong], dry_run=True)  # doctest: +SKIP
    """

    image: str
    sensor: str | None = None
    level: str | None = None
    acquired: When | None = None
    gsd_m: float | tuple[float, float] | None = None
    view_zenith_deg: float | None = None
    view_azimuth_deg: float | None = None
    sun_elevation_deg: float | None = None
    sun_azimuth_deg: float | None = None
    reason: str | None = None

    def __post_init__(self) -> None:
        faults = list(self._faults())
        if faults:
            raise OptionError(f"the correction of {self.image!r}: {'; '.join(faults)}")

    def _faults(self) -> Iterator[str]:
        for name in ("image", "sensor", "level", "reason"):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, str) and value):
                yield f"{name} is {value!r}: write a text"
        if self.acquired is not None:
            try:
                as_utc(self.acquired, "acquired")
            except OptionError as error:
                yield str(error)
        if self.gsd_m is not None and not all(_is_number(one) and one > 0 for one in self._sides()):
            yield f"gsd_m is {self.gsd_m!r}: write metres, .7, or two where they differ"
        for name, (low, high) in _LIMITS.items():
            value = getattr(self, name)
            if value is not None and not (_is_number(value) and low <= value <= high):
                yield f"{name} is {value!r}: write degrees from {low:g} to {high:g}"
        if all(getattr(self, name) is None for name in CORRECTED):
            yield f"nothing is corrected: give one of {', '.join(CORRECTED)}"

    def _sides(self) -> Sequence[Any]:
        sides = self.gsd_m
        if not isinstance(sides, tuple | list):
            return (sides, sides)
        return sides if len(sides) == 2 else (None, None)

    @property
    def columns(self) -> dict[str, Any]:
        """Columns of the table of images with their new values."""
        found = {name: getattr(self, name) for name in ("sensor", "level", *ANGLES)}
        if self.acquired is not None:
            found["acquired"] = as_utc(self.acquired, "acquired")
        if self.gsd_m is not None:
            found["gsd_row_m"], found["gsd_col_m"] = (float(one) for one in self._sides())
        return {name: value for name, value in found.items() if value is not None}


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and math.isfinite(value)


@dataclass(frozen=True)
class CorrectedImage:
    """What a correction changed, or would change, of an image.

    Attributes
    ----------
    id : int
        Number of its row.
    image : str
        Its path, else its SHA-256.
    changes : dict of str to (before, after)
        By column; only what differs.
    measurements : int
        Of the image.
    other_gsd : int
        Directions of them whose numbers in metres were computed with another GSD than the
        corrected one: they stay as they were measured.
    """

    id: int
    image: str
    changes: Mapping[str, tuple[Any, Any]]
    measurements: int
    other_gsd: int

    @property
    def summary(self) -> str:
        """The changes in one line."""
        listed = ", ".join(
            f"{name} {_word(before)} → {_word(after)}"
            for name, (before, after) in self.changes.items()
        )
        return f"{self.image}: {listed} ({counted(self.measurements, 'measurement')})"

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        changes = {name: list(pair) for name, pair in self.changes.items()}
        return plain_json({**{one.name: getattr(self, one.name) for one in fields(self)},
                           "changes": changes})  # fmt: skip


def _word(value: Any) -> str:
    if isinstance(value, datetime):
        return f"{value.astimezone(UTC):%Y-%m-%d %H:%M}"
    return "–" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def correct_images(
    database: Database, corrections: Iterable[ImageCorrection], *, dry_run: bool = False
) -> list[CorrectedImage]:
    """Correct images, all of them in one transaction; later corrections go before earlier ones.

    Parameters
    ----------
    database : Database
    corrections : iterable of ImageCorrection
    dry_run : bool, optional
        Only tell what would change.

    Returns
    -------
    list of CorrectedImage
        Images of which something changes.

    Raises
    ------
    OptionError
        If a correction means no image, or a file name that several have: nothing is changed.
    ArchiveError
        If the archive cannot be written.
    """
    listed = list(corrections)
    work = partial(_correct, corrections=listed, dry_run=dry_run)
    return database.read(work) if dry_run else database.write(work)


def _correct(
    connection: Connection, corrections: Sequence[ImageCorrection], dry_run: bool
) -> list[CorrectedImage]:
    kept = list(connection.execute(select(images).order_by(images.c.id)).mappings())
    wanted = _wanted(kept, corrections)
    counts = _counts(connection)
    now = datetime.now(UTC)
    found = []
    for row in kept:
        values, reasons = wanted.get(row["id"], ({}, {}))
        changes = {name: (row[name], value) for name, value in values.items() if row[name] != value}
        if not changes:
            continue
        if not dry_run:
            sources = _noted(row["sources"], changes, reasons, now)
            new = {name: value for name, (_, value) in changes.items()}
            changed = update(images).where(images.c.id == row["id"])
            connection.execute(changed.values(**new, sources=sources))
        found.append(
            CorrectedImage(
                row["id"], row["path"] or row["content"] or f"image {row['id']}", changes,
                counts.get(row["id"], 0), _other_gsd(connection, row["id"], changes),
            )
        )  # fmt: skip
    return found


def _wanted(
    kept: Sequence[RowMapping], corrections: Sequence[ImageCorrection]
) -> dict[int, tuple[dict[str, Any], dict[str, str | None]]]:
    """New values, and the reasons of them, by the number of the image."""
    places: dict[str, list[RowMapping]] = {}
    for row in kept:
        for word in {row["path"], row["name"], row["content"]} - {None}:
            places.setdefault(word, []).append(row)
    found: dict[int, tuple[dict[str, Any], dict[str, str | None]]] = {}
    faults = []
    for one in corrections:
        meant = places.get(one.image, [])
        if not meant and has_magic(one.image):
            meant = [row for row in kept if _matches(row, one.image)]
        elif len({row["content"] or row["path"] for row in meant}) > 1:
            faults.append(f"{one.image} names several images: give paths, SHA-256, or a pattern")
            continue
        if not meant:
            faults.append(f"there is no image {one.image}")
        for row in meant:
            values, reasons = found.setdefault(row["id"], ({}, {}))
            values |= one.columns
            reasons |= dict.fromkeys(one.columns, one.reason)
    if faults:
        more = f"; and {len(faults) - 10} more" if len(faults) > 10 else ""
        raise OptionError(f"nothing is corrected: {'; '.join(faults[:10])}{more}")
    return found


def _matches(row: RowMapping, pattern: str) -> bool:
    return any(fnmatchcase(row[name] or "", pattern) for name in ("path", "name"))


def _counts(connection: Connection) -> dict[int, int]:
    """Measurements and rejections, by image."""
    asked = select(measurements.c.image_id, func.count()).group_by(measurements.c.image_id)
    return {row[0]: row[1] for row in connection.execute(asked)}


def _other_gsd(
    connection: Connection, number: int, changes: Mapping[str, tuple[Any, Any]]
) -> int:  # fmt: skip
    new = [pair[1] for name, pair in changes.items() if name in ("gsd_row_m", "gsd_col_m")]
    if not new:
        return 0
    # A direction between the axes has a GSD between those of rows and columns.
    row = connection.execute(
        select(images.c.gsd_row_m, images.c.gsd_col_m).where(images.c.id == number)
    ).one()
    after = [changes[name][1] if name in changes else one
             for name, one in zip(("gsd_row_m", "gsd_col_m"), row, strict=True)]  # fmt: skip
    low, high = min(after) * (1 - _SAME_GSD), max(after) * (1 + _SAME_GSD)
    own = directions.c.gsd_m
    asked = (
        select(func.count())
        .select_from(directions.join(measurements))
        .where(measurements.c.image_id == number, own.is_(None) | (own < low) | (own > high))
    )
    return int(connection.execute(asked).scalar_one())


def _noted(
    sources: Mapping[str, Any], changes: Mapping[str, tuple[Any, Any]],
    reasons: Mapping[str, str | None], now: datetime,
) -> dict[str, Any]:  # fmt: skip
    """Sources with what was corrected, what it was before and who had said so."""
    notes = list(sources.get(_NOTED, ()))
    said = dict(sources)
    for name, (before, after) in changes.items():
        word = "gsd_m" if name.startswith("gsd_") else name
        note = {"column": name, "before": before, "after": after, "on": now,
                "source_before": sources.get(word), "reason": reasons.get(name)}  # fmt: skip
        notes.append({key: value for key, value in note.items() if value is not None})
        said[word] = f"corrected on {now:%Y-%m-%d}"
    return plain_json({**said, _NOTED: notes})


def with_corrections(
    connection: Connection, rows: Sequence[Mapping[str, Any]]
) -> list[Mapping[str, Any]]:
    """Rows of images to be added, with what was corrected of images of the same content.

    Parameters
    ----------
    connection : Connection
    rows : sequence of mapping
    """
    contents = [row["content"] for row in rows if row["content"] is not None]
    asked = select(images).where(images.c.content.in_(contents)).order_by(images.c.id)
    corrected = {
        kept["content"]: kept
        for kept in connection.execute(asked).mappings()
        if _NOTED in kept["sources"]
    }
    return [_carried_over(row, corrected.get(row["content"])) for row in rows]


def _carried_over(row: Mapping[str, Any], kept: RowMapping | None) -> Mapping[str, Any]:
    if kept is None:
        return row
    notes = kept["sources"][_NOTED]
    names = [note["column"] for note in notes]
    words = ("gsd_m" if name.startswith("gsd_") else name for name in names)
    said = {word: kept["sources"][word] for word in words}
    return {**row, **{name: kept[name] for name in names},
            "sources": {**row["sources"], **said, _NOTED: notes}}  # fmt: skip
