"""What all sources of an image say together: the first word on each field, and contradictions."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date, datetime
from typing import Any

from acutance.arguments import require_choice, require_whole
from acutance.curves.short_repr import ShortRepr
from acutance.raster.metadata.findings import FIELDS, Findings, Stated
from acutance.raster.metadata.sun import sun_angles
from acutance.raster.metadata.times import is_day

__all__ = ["ImageStatement", "state"]

_TIME_S = 300.0
"""A scene takes a minute, a product states its beginning, its middle or its end."""
_ANGLE_DEG = 2.0
_GSD_SHARE = 0.02
_ALIASES = {
    "wv01": "worldview1", "wv02": "worldview2", "wv03": "worldview3", "wv04": "worldview4",
    "qb02": "quickbird2", "ge01": "geoeye1", "phr1a": "pleiades1a", "phr1b": "pleiades1b",
}  # fmt: skip
"""Two names of one satellite."""


@dataclass(frozen=True, eq=False)
class ImageStatement(ShortRepr):
    """What an image and the documents beside it say of it; None where none of them does.

    Parameters
    ----------
    path : str
    sensor, level : Stated of str, or None
    acquired : Stated of datetime or date, or None
        In UTC; a date where no time is stated.
    bands : Stated of tuple of str, or None
        Names in the order of the file.
    gsd_m : Stated of (row, col), or None
        Metres.
    view_zenith_deg, view_azimuth_deg : Stated of float, or None
        Of the direction from the ground to the sensor; azimuth from north over east.
    sun_elevation_deg, sun_azimuth_deg : Stated of float, or None
    conflicts : tuple of str
        What sources say differently.
    notes : tuple of str
        What was not taken, and why.
    """

    path: str
    sensor: Stated[str] | None = None
    level: Stated[str] | None = None
    acquired: Stated[datetime | date] | None = None
    bands: Stated[tuple[str, ...]] | None = None
    gsd_m: Stated[tuple[float, float]] | None = None
    view_zenith_deg: Stated[float] | None = None
    view_azimuth_deg: Stated[float] | None = None
    sun_elevation_deg: Stated[float] | None = None
    sun_azimuth_deg: Stated[float] | None = None
    conflicts: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def stated(self) -> dict[str, Stated[Any]]:
        """All fields that are stated, by name."""
        every = ((name, getattr(self, name)) for name in FIELDS)
        return {name: one for name, one in every if one is not None}

    def value(self, name: str) -> Any:
        """The value of a field; None if it is not stated.

        Raises
        ------
        OptionError
            If there is no such field.
        """
        require_choice(FIELDS, name=name)
        found = getattr(self, name)
        return None if found is None else found.value

    def band_name(self, band: int) -> str | None:
        """The name of a band by its number, from 1.

        Raises
        ------
        OptionError
            If it is no whole number.
        """
        require_whole(0, band=band)
        names = () if self.bands is None else self.bands.value
        return names[band - 1] if 1 <= band <= len(names) else None

    def to_dict(self) -> dict[str, Any]:
        """All values with their sources, for JSON."""
        return {
            "path": self.path,
            **{
                name: {"value": _plain(one.value), "source": one.source}
                for name, one in self.stated.items()
            },
            "conflicts": list(self.conflicts),
            "notes": list(self.notes),
        }

    def summary(self) -> str:
        """Values in the order of the fields."""
        return ", ".join(f"{name} {_plain(one.value)}" for name, one in self.stated.items())


def state(
    path: str, sources: Sequence[Findings], place: tuple[float, float] | None = None
) -> ImageStatement:
    """What sources say together; of several that say a field the first counts.

    Parameters
    ----------
    path : str
        Of the image.
    sources : sequence of Findings
        In the order in which they are believed.
    place : (float, float), optional
        Longitude and latitude of the image by its own geolocation.
    """
    values: dict[str, Stated[Any]] = {}
    conflicts: list[str] = []
    for name in FIELDS:
        said = [one.values[name] for one in sources if name in one.values]
        if not said:
            continue
        values[name] = _timed(said) if name == "acquired" else said[0]
        conflicts.extend(_contradictions(name, said))
    centre = place or next((one.centre for one in sources if one.centre is not None), None)
    notes = tuple(dict.fromkeys(note for one in sources for note in one.notes))
    conflicts.extend(_sun_contradiction(values, centre))
    return ImageStatement(path, **values, conflicts=tuple(conflicts), notes=notes)


def _timed(said: Sequence[Stated[Any]]) -> Stated[Any]:
    """The first word on the date; where it is a day, the first time of that day."""
    first = said[0]
    if not is_day(first.value):
        return first
    times = (one for one in said if not is_day(one.value))
    return next((one for one in times if _same_time(first.value, one.value)), first)


def _contradictions(name: str, said: Sequence[Stated[Any]]) -> list[str]:
    first, *others = said
    agree = _AGREE.get(name, _same_angle)
    return [
        f"{name}: {_plain(first.value)} ({first.source}), but {_plain(one.value)} ({one.source})"
        for one in others
        if not agree(first.value, one.value)
    ]


def _sun_contradiction(
    values: Mapping[str, Stated[Any]], centre: tuple[float, float] | None
) -> list[str]:
    """Whether the sun stood where it is stated, at the stated time and place."""
    if centre is None or not {"acquired", "sun_elevation_deg"} <= set(values):
        return []
    if is_day(values["acquired"].value):
        return []
    stated = values["sun_elevation_deg"]
    elevation, azimuth = sun_angles(values["acquired"].value, *centre)
    aside = values.get("sun_azimuth_deg")
    turned = 0.0
    if aside is not None:
        turn = (aside.value - azimuth + 180.0) % 360.0 - 180.0
        turned = abs(turn) * math.cos(math.radians(elevation))
    if abs(elevation - stated.value) <= _ANGLE_DEG and turned <= _ANGLE_DEG:
        return []
    return [
        f"sun: at the stated time and place it stood {elevation:.1f} degrees high at azimuth "
        f"{azimuth:.1f}, but {stated.source} says {stated.value:.1f}"
        + ("" if aside is None else f" and {aside.value:.1f}")
        + ": time, its zone, angle or place is wrong"
    ]


def _same_name(one: str, other: str) -> bool:
    return _letters(one) == _letters(other)


def _letters(name: str) -> str:
    plain = re.sub(r"[^a-z0-9]", "", name.lower())
    return _ALIASES.get(plain, plain)


def _same_level(one: str, other: str) -> bool:
    return _letters(one).replace("level", "l") == _letters(other).replace("level", "l")


def _same_time(one: datetime | date, other: datetime | date) -> bool:
    if not (isinstance(one, datetime) and isinstance(other, datetime)):
        return f"{one:%Y-%m-%d}" == f"{other:%Y-%m-%d}"
    return abs((one - other).total_seconds()) <= _TIME_S


def _same_bands(one: Sequence[str], other: Sequence[str]) -> bool:
    return [name.lower() for name in one] == [name.lower() for name in other]


def _same_gsd(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return all(abs(a / b - 1.0) <= _GSD_SHARE for a, b in zip(one, other, strict=True))


def _same_angle(one: float, other: float) -> bool:
    return abs((one - other + 180.0) % 360.0 - 180.0) <= _ANGLE_DEG


_AGREE: dict[str, Callable[[Any, Any], bool]] = {
    "sensor": _same_name,
    "level": _same_level,
    "acquired": _same_time,
    "bands": _same_bands,
    "gsd_m": _same_gsd,
}


def _plain(value: Any) -> Any:
    """A value as JSON has it, with no more digits than it deserves."""
    if isinstance(value, datetime):
        return value.isoformat(timespec="milliseconds").replace("+00:00", "Z")
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, float):
        return round(value, 6)
    return [_plain(one) for one in value] if isinstance(value, tuple) else value
