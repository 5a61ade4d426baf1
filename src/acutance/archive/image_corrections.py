"""What is known of images that are kept is corrected: dates, sensors, levels, GSD, angles, bands.

The row of an image keeps the identity it was added with: a batch that adds to the image later, and
knows it as before, finds the corrected row and measures nothing again. One that knows it otherwise
makes another row of the same content, which shares the corrections (`correction_notes`).
Measurements stay as they are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from functools import partial
from glob import has_magic
from operator import itemgetter
from typing import Any, Final

from sqlalchemy import Connection, Select, func, select

from acutance.archive.band_corrections import name_bands, require_one_band, unnamed_rows
from acutance.archive.connection import Database, in_chunks
from acutance.archive.correction_notes import BAND, next_moment, with_notes, write_rows
from acutance.archive.counted import counted
from acutance.archive.dates import When, as_utc
from acutance.archive.named_images import ImageKey, named_images
from acutance.archive.packing import plain_json
from acutance.archive.possible_values import image_faults, sides_of
from acutance.archive.tables import directions, images, measurements
from acutance.arguments import require_all, require_flags
from acutance.errors import OptionError
from acutance.raster.metadata.findings import ANGLES

__all__ = [
    "CORRECTED",
    "CorrectedImage",
    "ImageCorrection",
    "correct_images",
]

CORRECTED: Final = ("sensor", "level", BAND, "acquired", "gsd_m", *ANGLES)
"""What of an image can be corrected."""
_MEASURES: Final = ("acquired", "gsd_m")
_SAME_GSD: Final = 1e-6


@dataclass(frozen=True, kw_only=True)
class ImageCorrection:
    """What is to be known of an image from now on; ``None`` leaves it as it is.

    Parameters
    ----------
    image : str
        Its path, file name or SHA-256; all rows of the same content are meant. A pattern means all
        images that match: by their file names (``"K3_*.tif"``), with a slash by their paths
        (``"/data/2026/*.tif"``, all below that folder).
    sensor, level : str, optional
    acquired : datetime, date or str, optional
        Without a time zone UTC.
    gsd_m : float or (float, float), optional
        From row to row and from column to column.
    view_zenith_deg, view_azimuth_deg, sun_elevation_deg, sun_azimuth_deg : float, optional
    band : str, optional
        The name of the band, of rows that were added without one: of images that were measured in
        a single band, by its number.
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
    band: str | None = None
    reason: str | None = None

    def __post_init__(self) -> None:
        faults = list(self._faults())
        if faults:
            raise OptionError(f"the correction of {self.image!r}: {'; '.join(faults)}")

    def _faults(self) -> Iterator[str]:
        for name in ("image", "sensor", "level", BAND, "reason"):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, str) and value):
                yield f"{name} is {value!r}: write a text"
        yield from image_faults({name: getattr(self, name) for name in (*_MEASURES, *ANGLES)})
        if all(getattr(self, name) is None for name in CORRECTED):
            yield f"nothing is corrected: give one of {', '.join(CORRECTED)}"

    @property
    def columns(self) -> dict[str, Any]:
        """Columns of the table of images, and the band of their rows, with their new values."""
        found = {name: getattr(self, name) for name in ("sensor", "level", BAND, *ANGLES)}
        if self.acquired is not None:
            found["acquired"] = as_utc(self.acquired, "acquired")
        if self.gsd_m is not None:
            found["gsd_row_m"], found["gsd_col_m"] = (float(one) for one in sides_of(self.gsd_m))
        return {name: value for name, value in found.items() if value is not None}


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
    measurements, rejections : int
        Of the image.
    other_gsd : int
        Directions of them with numbers in metres by another GSD than the corrected one: they stay
        as they were measured.
    """

    id: int
    image: str
    changes: Mapping[str, tuple[Any, Any]]
    measurements: int
    other_gsd: int
    rejections: int = 0

    def __repr__(self) -> str:
        return f"<CorrectedImage: {self.summary}>"

    @property
    def summary(self) -> str:
        """The changes in one line."""
        listed = ", ".join(
            f"{name} {_word(before)} → {_word(after)}"
            for name, (before, after) in self.changes.items()
        )
        return f"{self.image}: {listed} ({', '.join(self._rows)})"

    @property
    def _rows(self) -> list[str]:
        """Measurements and rejections with their numbers; those that there are none of left out."""
        each = (("measurement", self.measurements), ("rejection", self.rejections))
        return [counted(count, name) for name, count in each if count]

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        changes = {name: list(pair) for name, pair in self.changes.items()}
        return plain_json({**{one.name: getattr(self, one.name) for one in fields(self)},
                           "changes": changes})  # fmt: skip


def _word(value: Any) -> str:
    if isinstance(value, datetime):
        time = value.astimezone(UTC)
        return f"{time:%Y-%m-%d %H:%M:%S}" if time.second else f"{time:%Y-%m-%d %H:%M}"
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
        Change nothing, only return what would change.

    Returns
    -------
    list of CorrectedImage
        Images of which something changes.

    Raises
    ------
    OptionError
        If a correction means no image, a file name that several have, or names the band of an
        image that was measured in several; if two give one image two values under different names:
        nothing is changed.
    ArchiveError
        If the archive cannot be written.
    """
    require_flags(dry_run=dry_run)
    listed = require_all(ImageCorrection, "corrections", corrections)
    # Names are matched before the archive is locked for others.
    named = database.read(partial(named_images, names=[one.image for one in listed]))
    _require_one_value(listed, named)
    wanted: dict[ImageKey, _Wanted] = {}
    for one in listed:
        for key in named[one.image]:
            values, reasons = wanted.setdefault(key, ({}, {}))
            values |= one.columns
            reasons |= dict.fromkeys(one.columns, one.reason)
    work = partial(_correct, wanted=wanted, dry_run=dry_run)
    return database.read(work) if dry_run else database.write(work)


def _require_one_value(
    corrections: Iterable[ImageCorrection], named: Mapping[str, Sequence[ImageKey]]
) -> None:
    """Refuse two values of one image under two of its names, of which none is a pattern.

    A pattern may be followed by an image that is an exception to it, and a name by itself again.
    """
    stated: dict[tuple[ImageKey, str], tuple[str, Any]] = {}
    for one in corrections:
        if has_magic(one.image) and len(named[one.image]) > 1:
            continue
        for key in named[one.image]:
            for name, value in one.columns.items():
                other, before = stated.get((key, name), (one.image, value))
                if other != one.image and before != value:
                    raise OptionError(
                        f"nothing is corrected: {other} and {one.image} are one image, and its "
                        f"{name} is to be {_word(before)} and {_word(value)}: leave one of them"
                    )
                stated[key, name] = one.image, value


_Wanted = tuple[dict[str, Any], dict[str, str | None]]
"""New values and the reasons of them, by column."""


def _correct(
    connection: Connection, wanted: Mapping[ImageKey, _Wanted], dry_run: bool
) -> list[CorrectedImage]:
    changed = []
    rows = _kept_rows(connection, wanted, lock=not dry_run)
    bands = {row["id"]: band for row in rows if (band := _wanted_of(row, wanted)[0].get(BAND))}
    require_one_band(connection, [row for row in rows if row["id"] in bands])
    unnamed = unnamed_rows(connection, bands)
    for row in rows:
        values, reasons = _wanted_of(row, wanted)
        before = {**row, BAND: None if row["id"] in unnamed else values.get(BAND)}
        changes = {name: (before[name], new) for name, new in values.items() if before[name] != new}
        if changes:
            changed.append((row, changes, reasons))
    ids = [row["id"] for row, _, _ in changed]
    counts = _counts(connection, ids)
    other_gsd = _other_gsd(connection, {row["id"]: _gsd_after(row, new) for row, new, _ in changed})
    if not dry_run:
        now = next_moment(row for row, _, _ in changed)
        write_rows(connection, [with_notes(row, new, why, now) for row, new, why in changed])
        name_bands(connection, {number: bands[number] for number in unnamed})
    return [
        CorrectedImage(
            row["id"], row["path"] or row["content"] or f"image {row['id']}", changes,
            counts[row["id"], True], other_gsd[row["id"]], counts[row["id"], False],
        )
        for row, changes, _ in changed
    ]  # fmt: skip


def _wanted_of(row: Mapping[str, Any], wanted: Mapping[ImageKey, _Wanted]) -> _Wanted:
    return wanted[row["content"] or row["id"]]


def _kept_rows(
    connection: Connection, keys: Iterable[ImageKey], *, lock: bool
) -> list[dict[str, Any]]:
    """All rows of images, in the order of their numbers; locked, no other process writes them."""
    contents = [key for key in keys if isinstance(key, str)]
    ids = [key for key in keys if not isinstance(key, str)]
    asked = [select(images).where(images.c.content.in_(some)) for some in in_chunks(contents)]
    asked += [select(images).where(images.c.id.in_(some)) for some in in_chunks(ids)]
    if lock:
        asked = [one.with_for_update(key_share=True) for one in asked]
    found = [dict(row) for one in asked for row in connection.execute(one).mappings()]
    return sorted(found, key=itemgetter("id"))


def _counts(connection: Connection, ids: Sequence[int]) -> Counter[tuple[int, bool]]:
    """Rows by image, and by whether they are measurements; others are rejections."""
    found: Counter[tuple[int, bool]] = Counter()
    for some in in_chunks(ids):
        own, verdict = measurements.c.image_id, measurements.c.verdict
        asked = select(own, verdict, func.count()).where(own.in_(some)).group_by(own, verdict)
        for number, word, count in connection.execute(asked):
            found[number, word is not None] += count
    return found


def _gsd_after(
    row: Mapping[str, Any], changes: Mapping[str, tuple[Any, Any]]
) -> tuple[float, float] | None:
    """The GSD of an image where it is corrected."""
    names = ("gsd_row_m", "gsd_col_m")
    if not any(name in changes for name in names):
        return None
    row_m, col_m = (changes[name][1] if name in changes else row[name] for name in names)
    return row_m, col_m


def _other_gsd(
    connection: Connection, after: Mapping[int, tuple[float, float] | None]
) -> Counter[int]:
    """Directions with numbers in metres by another GSD than the corrected one, by image."""
    found: Counter[int] = Counter()
    for some in in_chunks([number for number, sides in after.items() if sides is not None]):
        for number, gsd_m, count in connection.execute(_gsds_of(some)):
            sides = after[number] or (gsd_m, gsd_m)
            # A direction between the axes has a GSD between those of rows and columns.
            if not min(sides) * (1 - _SAME_GSD) <= gsd_m <= max(sides) * (1 + _SAME_GSD):
                found[number] += count
    return found


def _gsds_of(ids: Sequence[int]) -> Select[Any]:
    """How many directions of images have which GSD."""
    columns = measurements.c.image_id, directions.c.gsd_m
    asked = select(*columns, func.count()).select_from(directions.join(measurements))
    asked = asked.where(measurements.c.image_id.in_(ids), directions.c.gsd_m.is_not(None))
    return asked.group_by(*columns)
