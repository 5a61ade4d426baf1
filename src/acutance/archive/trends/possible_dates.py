"""Dates that no image can have, of rows that are kept: they are taken as not known, and named."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.columns import Columns
from acutance.archive.counted import counted
from acutance.raster.metadata.times import possible_days

__all__ = ["impossible_date_notes", "possible_dates"]

_NAMED: Final = 5


def possible_dates(acquired: NDArray[np.datetime64]) -> NDArray[np.datetime64]:
    """Dates without those that no image can have; not a time is left as it is.

    Parameters
    ----------
    acquired : (n,) datetime64 array
    """
    found = acquired.copy()
    found[_impossible(acquired)] = np.datetime64("NaT")
    return found


def impossible_date_notes(rows: Columns, mask: NDArray[np.bool_]) -> Iterator[str]:
    """The images of some rows whose dates are none, or to come, in sentences.

    Parameters
    ----------
    rows : Columns
    mask : (m,) bool array
    """
    at = np.flatnonzero(mask)[_impossible(rows["acquired"][mask])]
    names: dict[Any, str] = {}
    for one in at.tolist():
        day = str(rows["acquired"][one].astype("datetime64[D]"))
        names.setdefault(rows["image_id"][one], f"{rows['image'][one] or 'an image'} ({day})")
    if names:
        first, last = possible_days()
        several = list(names.values())
        more = len(several) - _NAMED
        listed = ", ".join(several[:_NAMED]) + (f" and {more} more" if more > 0 else "")
        yield (
            f"The dates of {counted(len(several), 'image')} are not from {first} to {last}, and "
            f"taken as not known: {listed}. Correct them."
        )
    ahead = np.datetime64(datetime.now(UTC).date() + timedelta(days=2))
    later = {rows["image_id"][one] for one in np.flatnonzero(mask & (rows["acquired"] >= ahead))}
    later -= names.keys()
    if later:
        have = "has a date" if len(later) == 1 else "have dates"
        yield f"{counted(len(later), 'image')} {have} to come: a simulation, or wrong."


def _impossible(acquired: NDArray[np.datetime64]) -> NDArray[np.bool_]:
    first, last = (np.datetime64(one) for one in possible_days())
    # What is not a time is neither.
    return (acquired < first) | (acquired >= last + np.timedelta64(1, "D"))
