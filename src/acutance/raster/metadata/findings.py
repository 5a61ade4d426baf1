"""What one source says of an image: values by field, each with its place in the source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from acutance.raster.gsd import GSD_RANGE_M
from acutance.raster.metadata.times import is_possible

__all__ = ["ANGLES", "FIELDS", "Findings", "Stated", "find", "lon_lat", "number", "word"]

Value = TypeVar("Value", covariant=True)

FIELDS = (
    "sensor", "level", "acquired", "bands", "gsd_m",
    "view_zenith_deg", "view_azimuth_deg", "sun_elevation_deg", "sun_azimuth_deg",
)  # fmt: skip
"""What may be said of an image."""

ANGLES = {
    "view_zenith_deg": (0.0, 90.0),
    "view_azimuth_deg": (-180.0, 360.0),
    "sun_elevation_deg": (-90.0, 90.0),
    "sun_azimuth_deg": (-180.0, 360.0),
}
"""Angles of view and sun, with their least and greatest degrees."""


@dataclass(frozen=True)
class Stated(Generic[Value]):
    """A value, and who said it.

    Parameters
    ----------
    value : object
    source : str
        File and place in it: "LC08_MTL.txt: SUN_ELEVATION".
    """

    value: Value
    source: str


@dataclass(frozen=True)
class Findings:
    """What one source says.

    Parameters
    ----------
    values : mapping of str to Stated
        By field (`FIELDS`); what is not said is not there.
    notes : tuple of str
        What was not taken, and why.
    centre : (float, float) or None
        Longitude and latitude of the image's middle in degrees.
    """

    values: Mapping[str, Stated[Any]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    centre: tuple[float, float] | None = None


def find(
    source: str,
    said: Mapping[str, tuple[Any, str]],
    *,
    notes: tuple[str, ...] = (),
    centre: tuple[float, float] | None = None,
) -> Findings:
    """The findings of a source; what is None is left out, what is out of range becomes a note.

    Parameters
    ----------
    source : str
        Name of the file.
    said : mapping of str to (value, place)
        By field.
    notes : tuple of str, optional
    centre : (float, float), optional
    """
    values, refused = {}, []
    for name, (value, place) in said.items():
        if value is None:
            continue
        if _is_possible(name, value):
            values[name] = Stated(_tidy(name, value), f"{source}: {place}")
        else:
            refused.append(f"{source}: {place} is {value}, which no image has: not taken")
    return Findings(values, (*notes, *refused), centre)


def _is_possible(name: str, value: Any) -> bool:
    if name == "gsd_m":
        return all(GSD_RANGE_M[0] <= one <= GSD_RANGE_M[1] for one in value)
    if name == "acquired":
        return is_possible(value)
    low, high = ANGLES.get(name, (None, None))
    return low is None or high is None or low <= value <= high


def _tidy(name: str, value: Any) -> Any:
    """Azimuths from 0 to 360 degrees."""
    return value % 360.0 if name.endswith("azimuth_deg") else value


def number(text: Any) -> float | None:
    """A finite number of a text; None if there is none."""
    try:
        value = float(text)
    except (TypeError, ValueError, OverflowError):
        return None
    return value if math.isfinite(value) else None


def word(*texts: Any, joined: str = "-") -> str | None:
    """Texts as one word, on one line; None if one of them is missing or empty."""
    known = [str(text) if isinstance(text, str | int | float) else "" for text in texts]
    parts = [" ".join(text.split()) for text in known]
    return joined.join(parts) if parts and all(parts) else None


def lon_lat(lon: Any, lat: Any) -> tuple[float, float] | None:
    """A place in degrees; None unless both are there and on the Earth."""
    east, north = number(lon), number(lat)
    if east is None or north is None or abs(east) > 360.0 or abs(north) > 90.0:
        return None
    return east, north
