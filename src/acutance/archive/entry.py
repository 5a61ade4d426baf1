"""What an archive keeps at a time: a measurement or a rejection, its image, target and run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date, datetime
from numbers import Real
from typing import Any

from acutance.errors import OptionError
from acutance.targets.record import Record
from acutance.targets.target_result import Rejected

__all__ = ["UNKNOWN_KIND", "Entry", "ImageEntry", "Kept", "RunEntry", "TargetEntry"]

UNKNOWN_KIND = "unknown"
"""Of targets whose rejection does not name it."""


@dataclass(frozen=True, kw_only=True)
class ImageEntry:
    """What is known of an image; what is not known is ``None``.

    Parameters
    ----------
    path : str, optional
        The file it was read from.
    content : str, optional
        SHA-256 of the file's bytes, in hexadecimal digits: the identity of the image, whatever
        folder it lies in.
    sensor, level : str, optional
        Which sensor took it, and the level of the product.
    acquired : datetime, optional
        When. Without a time zone it is UTC.
    gsd_m : (float, float), optional
        GSD from row to row and from column to column; one number is both.
    view_zenith_deg, view_azimuth_deg, sun_elevation_deg, sun_azimuth_deg : float, optional
    sources : mapping, optional
        Which file each value is from.

    Raises
    ------
    OptionError
        If a name is no text, or the GSD neither one number nor two.
    """

    path: str | None = None
    content: str | None = None
    sensor: str | None = None
    level: str | None = None
    acquired: datetime | None = None
    gsd_m: tuple[float, float] | None = None
    view_zenith_deg: float | None = None
    view_azimuth_deg: float | None = None
    sun_elevation_deg: float | None = None
    sun_azimuth_deg: float | None = None
    sources: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _require_texts(self, "path", "content", "sensor", "level")
        _take_empty_for_none(self, "sensor", "level")
        if self.gsd_m is not None:
            object.__setattr__(self, "gsd_m", _two_sides(self.gsd_m))


@dataclass(frozen=True, kw_only=True)
class TargetEntry:
    """A target on the ground.

    Parameters
    ----------
    name : str
    kind : str
        "edge", "pulse", "points", "biresolution", "bars", "star", "scene", "combined"; "unknown".
    definition : mapping, optional
        The GeoJSON feature as it was given.
    site : str, optional
        Where it lies, by name.
    valid_from, valid_to : date, optional
        First and last day it was there.
    lon, lat : float, optional
        In degrees (WGS 84).
    """

    name: str
    kind: str
    definition: Mapping[str, Any] = field(default_factory=dict)
    site: str | None = None
    valid_from: date | None = None
    valid_to: date | None = None
    lon: float | None = None
    lat: float | None = None

    def __post_init__(self) -> None:
        _require_texts(self, "name", "kind", "site")
        _take_empty_for_none(self, "site")


@dataclass(frozen=True, kw_only=True)
class RunEntry:
    """The batch or import that wrote something.

    Parameters
    ----------
    uid : str
        Of this run among those of all archives.
    started : datetime
    software : str
        Version of acutance.
    ended : datetime, optional
    plan : mapping, optional
        Empty where only the run is named: files of many entries have it once.
    summary : mapping, optional

    Raises
    ------
    OptionError
        If a value is none that a run can have.
    """

    uid: str
    started: datetime
    software: str
    ended: datetime | None = None
    plan: Mapping[str, Any] = field(default_factory=dict)
    summary: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        if not self.uid:
            raise OptionError("a run has no uid: give the one it was started with")
        _require(self, str, "a text", "uid", "software")
        _require(self, datetime, "a datetime", "started")
        _require(self, datetime | None, "a datetime", "ended")
        _require(self, Mapping, "a mapping", "plan")
        _require(self, Mapping | None, "a mapping", "summary")

    @property
    def named_only(self) -> RunEntry:
        """The same without plan, summary and end."""
        return RunEntry(uid=self.uid, started=self.started, software=self.software)


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A measurement, or the reason why there is none, with its image and target.

    Parameters
    ----------
    record : Record, optional
    rejected : Rejected, optional
        Exactly one of the two.
    image : ImageEntry, optional
    target : TargetEntry, optional
    band : str, optional
        The name of the spectral band, "pan" or "B04"; its number is in the record.
    key : str, optional
        What makes the entry the same as one that is kept already; derived from the rest without
        it (`acutance.archive.identity`).
    run : RunEntry, optional
        What wrote it; it makes no other entry of it.

    Raises
    ------
    OptionError
        If there is neither a record nor a rejection, or both; if a field is of another kind.
    """

    record: Record | None = None
    rejected: Rejected | None = None
    image: ImageEntry = field(default_factory=ImageEntry)
    target: TargetEntry | None = None
    band: str | None = None
    key: str | None = None
    run: RunEntry | None = None

    def __post_init__(self) -> None:
        if (self.record is None) == (self.rejected is None):
            found = "neither" if self.record is None else "both"
            raise OptionError(
                f"an entry has either a record or a rejection, this one has {found}: give one"
            )
        _require(self, Record | None, "m.record of a measurement", "record")
        _require(self, Rejected | None, "Rejected(...)", "rejected")
        _require(self, ImageEntry, "ImageEntry(...)", "image")
        _require(self, TargetEntry | None, "TargetEntry(...)", "target")
        _require(self, RunEntry | None, "RunEntry(...)", "run")
        _require_texts(self, "band", "key")
        _take_empty_for_none(self, "band")
        if self.key == "":
            raise OptionError("the key of an entry is empty: give one, or none to have it derived")


@dataclass(frozen=True)
class Kept:
    """Where a measurement is kept.

    Attributes
    ----------
    id : int
        The number of its row.
    key : str
    new : bool
        Whether it was added now; false if it was there already.
    """

    id: int
    key: str
    new: bool


def _require_texts(entry: ImageEntry | TargetEntry | Entry, *names: str) -> None:
    """Refuse names that are no texts: one database would turn them into some, another not."""
    _require(entry, str | None, "a text", *names)


def _require(entry: object, kind: Any, needed: str, *names: str) -> None:
    for name in names:
        value = getattr(entry, name)
        if not isinstance(value, kind):
            raise OptionError(
                f"{type(entry).__name__}: {name} is {value!r:.60}, a {type(value).__name__}: give "
                f"{needed}"
            )


def _take_empty_for_none(entry: ImageEntry | TargetEntry | Entry, *names: str) -> None:
    """Names without a letter are none: filters take '' for what has no name."""
    for name in names:
        if getattr(entry, name) == "":
            object.__setattr__(entry, name, None)


def _two_sides(gsd_m: Any) -> tuple[Any, Any]:
    sides = (gsd_m, gsd_m) if isinstance(gsd_m, Real) else gsd_m
    if not isinstance(sides, tuple | list) or len(sides) != 2:
        raise OptionError(
            f"ImageEntry: gsd_m is {gsd_m!r:.60}: give metres, .7, or (ROW, COLUMN) where they "
            "differ"
        )
    return sides[0], sides[1]
