"""One metric of one sensor through time, as columns: what trends and specifications read."""

from __future__ import annotations

from calendar import isleap
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import MAXYEAR, UTC, date, datetime, timedelta
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.archive.counted import counted
from acutance.archive.dates import as_utc
from acutance.arguments import require_numbers, require_types
from acutance.curves.grid import Floats
from acutance.curves.metric_words import metric_words
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError

__all__ = ["Event", "Series", "date_of", "decimal_year", "moment_of"]


_LAST = datetime.max.replace(tzinfo=UTC) - timedelta(seconds=1)


def decimal_year(when: datetime | date | str) -> float:
    """A moment (UTC) as a year with decimals: 2 July 2023, noon, is 2023.5."""
    moment = as_utc(when)
    begin = datetime(moment.year, 1, 1, tzinfo=UTC)
    return moment.year + (moment - begin) / _length(moment.year)


def moment_of(year: float) -> datetime:
    """The moment (UTC) of a year with decimals."""
    if year > MAXYEAR + 1 - 1e-10:
        # What a float makes of the last moments there are.
        return _LAST
    return datetime(int(year), 1, 1, tzinfo=UTC) + (year % 1) * _length(int(year))


def date_of(year: float) -> date:
    """The day of a year with decimals, 1 to 9999.

    Raises
    ------
    OptionError
        If there is no such year.
    """
    require_numbers(year=year)
    if not 1 <= year <= MAXYEAR + 1:
        raise OptionError(f"year is {year:g}: give one from 1 to {MAXYEAR}, with decimals")
    # Half a second more: midnight stays on its day.
    return (min(moment_of(year), _LAST) + timedelta(seconds=0.5)).date()


def _length(year: int) -> timedelta:
    return timedelta(days=365 + isleap(year))


@dataclass(frozen=True)
class Event:
    """Something that may have changed the sensor at a known date.

    Parameters
    ----------
    when : datetime, date or str
    name : str
        "refocus", "new processor".
    changes_drift : bool, optional
        Whether the drift may be another one afterwards, too.

    Raises
    ------
    OptionError
        If one of them is of another kind, or there is no such date.
    """

    when: datetime | date | str
    name: str
    changes_drift: bool = False

    def __post_init__(self) -> None:
        require_types(self)
        as_utc(self.when, f"the date of {self.name or 'an event'}")

    @property
    def year(self) -> float:
        """The date as a year with decimals."""
        return decimal_year(self.when)


@dataclass(frozen=True, eq=False, kw_only=True)
class Series(ShortRepr):
    """Measurements of one metric, one a place of the arrays.

    Parameters
    ----------
    metric : str
        "mtf_nyquist".
    when : (n,) array
        Years with decimals (`decimal_year`); ``nan`` where the date is not known.
    value : (n,) array
    std : (n,) array
        Random part of the stated standard deviation; ``nan`` where none was stated.
    image : (n,) int array
        Which image: measurements of one image share its atmosphere.
    systematic_std : (n,) array, optional
        Part that all measurements of this sensor and method share: it does not average out.
    target, site : (n,) int array, optional
        Which target and which site, from 0 on; below 0 where it is not known. What comes again in
        several images has an effect of its own (`acutance.archive.trends.target_effects`).
    gsd_m : (n,) array, optional
        GSD along the direction of the metric; ``nan`` where it is not known.
    image_names : mapping of int to str, optional
        What an image is called in messages.
    name : str, optional
        What was measured: "QB02, pan, across".
    notes : tuple of str, optional
        What has to be known of the measurements, in sentences.

    Raises
    ------
    OptionError
        If the arrays differ in length, or nothing can be used.
    """

    metric: str
    when: Floats
    value: Floats
    std: Floats
    image: NDArray[np.int64]
    systematic_std: Floats | None = None
    gsd_m: Floats | None = None
    target: NDArray[np.int64] | None = None
    site: NDArray[np.int64] | None = None
    image_names: Mapping[int, str] = field(default_factory=dict)
    name: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        arrays = (self.when, self.std, self.image, self.systematic_std, self.gsd_m, self.target,
                  self.site)  # fmt: skip
        sizes = {np.shape(array) for array in arrays if array is not None}
        if sizes - {np.shape(self.value)}:
            raise OptionError(
                f"the columns of a series have the shapes {sorted(sizes)} and "
                f"{np.shape(self.value)}: give one number a measurement in each"
            )

    @property
    def size(self) -> int:
        """Number of measurements."""
        return int(self.value.size)

    @property
    def title(self) -> str:
        """Metric and what was measured."""
        label = metric_words(self.metric).label
        return f"{label} of {self.name}" if self.name else label

    def of(self, rows: NDArray[np.bool_]) -> Series:
        """The measurements of a mask."""
        optional: dict[str, Any] = {
            name: None if (array := getattr(self, name)) is None else array[rows]
            for name in ("systematic_std", "gsd_m", "target", "site")
        }
        return replace(
            self, when=self.when[rows], value=self.value[rows], std=self.std[rows],
            image=self.image[rows], **optional,
        )  # fmt: skip

    def known(self) -> Series:
        """The measurements whose value exists."""
        return self.of(np.isfinite(self.value))

    def dated(self) -> Series:
        """The measurements whose value and date exist.

        Raises
        ------
        OptionError
            If there are none.
        """
        found = self.of(np.isfinite(self.value) & np.isfinite(self.when))
        if found.size == 0:
            lacks = "a value: choose another metric; numbers on the ground need the GSD"
            if np.isfinite(self.value).any():
                lacks = "a date and a value: state when the images were acquired"
            raise OptionError(f"{self.title}: none of {self.size} measurements has {lacks}")
        return found

    def summary(self) -> str:
        """Metric, number of measurements and images, first and last date."""
        found = self.when[np.isfinite(self.when)]
        span = f", {date_of(found.min())} to {date_of(found.max())}" if found.size else ""
        images = np.unique(self.image).size
        return (
            f"{self.title}, {counted(self.size, 'measurement')} in {counted(images, 'image')}{span}"
        )
