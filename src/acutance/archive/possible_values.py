"""What can be known of images and targets: the same for what is added and what is corrected.

Rows that an older version kept may have other values: they are read as they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from numbers import Real
from typing import Any, Final

from acutance.archive.dates import as_utc
from acutance.archive.entry import UNKNOWN_KIND, Entry, ImageEntry, TargetEntry
from acutance.arguments import require_kind
from acutance.errors import OptionError
from acutance.raster.gsd import Gsd
from acutance.raster.metadata.findings import ANGLES
from acutance.raster.metadata.times import is_possible, possible_days
from acutance.targets.kinds import KINDS

__all__ = ["image_faults", "require_possible", "sides_of"]

_PLACES: Final = {"lon": 360.0, "lat": 90.0}
_KINDS: Final = (*KINDS, "scene", UNKNOWN_KIND)


def require_possible(entry: Entry) -> None:
    """Refuse what no image and no target can have, before it is kept.

    Parameters
    ----------
    entry : Entry

    Raises
    ------
    OptionError
        If it has a date, a GSD, an angle, a place or a kind that there cannot be; if it is none.
    """
    require_kind(Entry, entry=entry)
    image, record = entry.image, entry.record
    is_own = record is not None and image.gsd_m == record.image.pixel_gsd_m
    faults = list(image_faults(_values(image), any_size=is_own))
    if entry.target is not None:
        faults += _target_faults(entry.target)
    if faults:
        name = image.path or image.content or "without a path"
        raise OptionError(f"image {name}: {'; '.join(faults)}")


def _values(image: ImageEntry) -> dict[str, Any]:
    return {name: getattr(image, name) for name in ("acquired", "gsd_m", *ANGLES)}


def image_faults(values: Mapping[str, Any], *, any_size: bool = False) -> Iterator[str]:
    """What of an image cannot be, in words.

    Parameters
    ----------
    values : mapping
        Acquired, gsd_m and angles by name; None is not known.
    any_size : bool, optional
        Whether the GSD is that of the measured pixels, which no statement made.
    """
    if values["acquired"] is not None:
        yield from _date_faults(values["acquired"])
    if values["gsd_m"] is not None:
        yield from _gsd_faults(values["gsd_m"], any_size)
    for name, (low, high) in ANGLES.items():
        value = values[name]
        if value is not None and not (_is_number(value) and low <= value <= high):
            yield f"{name} is {value!r}: write degrees from {low:g} to {high:g}"


def sides_of(gsd_m: Any) -> Sequence[Any]:
    """The GSD from row to row and from column to column, of one number or two."""
    if not isinstance(gsd_m, tuple | list):
        return (gsd_m, gsd_m)
    return gsd_m if len(gsd_m) == 2 else (None, None)


def _date_faults(acquired: Any) -> Iterator[str]:
    try:
        when = as_utc(acquired, "acquired")
    except OptionError as error:
        yield str(error)
        return
    if not is_possible(when):
        first, last = possible_days()
        yield f"acquired is {when.date()}: write a date from {first} to {last}"


def _gsd_faults(gsd_m: Any, any_size: bool) -> Iterator[str]:
    sides = sides_of(gsd_m)
    if not all(_is_number(one) and one > 0 for one in sides):
        yield f"gsd_m is {gsd_m!r}: write metres, .7, or two where they differ"
        return
    try:
        if not any_size:
            Gsd.given(Gsd(*sides))
    except OptionError as error:
        yield str(error)


def _target_faults(target: TargetEntry) -> Iterator[str]:
    for name, limit in _PLACES.items():
        value = getattr(target, name)
        if value is not None and not (_is_number(value) and abs(value) <= limit):
            yield (
                f"{name} of target {target.name} is {value!r}: write degrees from {-limit:g} to "
                f"{limit:g}"
            )
    if target.kind not in _KINDS:
        yield (
            f"target {target.name} is of the kind {target.kind!r}, and there are only "
            f"{', '.join(_KINDS)}"
        )


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    return is_number and math.isfinite(value)
