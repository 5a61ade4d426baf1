"""Which rows are meant: filters on everything, named as the options of the command line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any, TypedDict

from sqlalchemy import Column, ColumnElement, or_

from acutance.archive.dates import When, as_utc, end_of
from acutance.archive.tables import VERDICTS, directions, images, measurements, targets
from acutance.arguments import require_whole
from acutance.curves import METRICS
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

__all__ = ["Limits", "Selection", "SelectionWords", "names_of"]

Names = str | Sequence[str]
"""A name, or several any of which may be the one; an empty one is that of rows without."""

_KINDS = (*KINDS, "scene")

Limits = Mapping[str, tuple[float | None, float | None]]
"""By metric the least and the largest value; ``None`` where there is no limit."""


class SelectionWords(TypedDict, total=False):
    """The fields of `Selection` as keywords."""

    sensor: Names | None
    band: Names | None
    level: Names | None
    site: Names | None
    target: Names | None
    kind: Names | None
    method: Names | None
    orientation: Names | None
    since: When | None
    until: When | None
    verdict: str | None
    image: Names | None
    run: int | None
    limits: Limits | None


@dataclass(frozen=True, kw_only=True)
class Selection:
    """Filters, all of which a row passes; ``None`` lets every row pass.

    Parameters
    ----------
    sensor, band, level, site, target, kind, method, orientation : str or sequence of str, optional
        Whole names, as they were written; of several, any. ``""`` selects what has no name.
    since, until : datetime, date or str, optional
        Of the acquisition, both included; a day is all of the day, and without a zone UTC. What has
        no date does not pass.
    verdict : {"good", "usable", "doubtful", "invalid"}, optional
        At least.
    image : str or sequence of str, optional
        Path, file name, or SHA-256 of the content.
    run : int, optional
    limits : mapping of str to (float or None, float or None), optional
        Least and largest value of metrics, both included.
    """

    sensor: Names | None = None
    band: Names | None = None
    level: Names | None = None
    site: Names | None = None
    target: Names | None = None
    kind: Names | None = None
    method: Names | None = None
    orientation: Names | None = None
    since: When | None = None
    until: When | None = None
    verdict: str | None = None
    image: Names | None = None
    run: int | None = None
    limits: Limits | None = field(default=None)

    @classmethod
    def of(cls, words: Mapping[str, Any]) -> Selection:
        """The selection of some keywords.

        Raises
        ------
        OptionError
            If there is no such filter, or a value it cannot have.
        """
        known = [one.name for one in fields(cls)]
        unknown = [name for name in words if name not in known]
        if unknown:
            raise OptionError(
                f"{', '.join(map(repr, unknown))} is no filter: there are {', '.join(known)}"
            )
        found = cls(**words)
        found.require_values()
        return found

    def require_values(self) -> None:
        """Refuse values that no row can have.

        Raises
        ------
        OptionError
            Names the filter, and what it can be.
        """
        if self.verdict is not None and str(self.verdict) not in VERDICTS:
            raise OptionError(
                f"verdict is {self.verdict!r}: it is one of {', '.join(reversed(VERDICTS))}"
            )
        for name in names_of(() if self.kind is None else self.kind):
            if name not in _KINDS:
                raise OptionError(f"kind is {name!r}: it is one of {', '.join(_KINDS)}")
        for name in names_of(() if self.orientation is None else self.orientation):
            if name not in ("across", "along"):
                raise OptionError(f"orientation is {name!r}: it is across or along")
        if self.run is not None:
            require_whole(0, run=self.run)
        if not isinstance(self.limits, Mapping | None):
            raise OptionError(
                f"limits are {self.limits!r:.80}: give a dict, {{'mtf_nyquist': (0.1, None)}}"
            )
        for metric, limits in (self.limits or {}).items():
            if metric not in METRICS:
                raise OptionError(f"there is no metric {metric!r}, only {', '.join(METRICS)}")
            _require_limits(metric, limits)
        since = None if self.since is None else as_utc(self.since, "since")
        until = None if self.until is None else end_of(self.until, "until")
        if since is not None and until is not None and since > until:
            raise OptionError(f"since ({since:%Y-%m-%d}) is later than until ({until:%Y-%m-%d})")

    def of_measurements(self) -> Iterator[ColumnElement[bool]]:
        """Conditions on rows of measurements, with their directions."""
        yield from self.of_entries()
        yield from self.of_directions()

    def of_directions(self) -> Iterator[ColumnElement[bool]]:
        """Conditions on rows of directions alone."""
        if self.orientation is not None:
            yield directions.c.orientation.in_(names_of(self.orientation))
        for metric, (low, high) in (self.limits or {}).items():
            # SQLite compares no numbers of numpy.
            if low is not None:
                yield directions.c[metric] >= float(low)
            if high is not None:
                yield directions.c[metric] <= float(high)

    def of_entries(self) -> Iterator[ColumnElement[bool]]:
        """Conditions on measurements and rejections, with their images and targets."""
        for _, column, wanted in self.by_name():
            if wanted is not None:
                yield _is_named(column, names_of(wanted))
        if self.since is not None:
            yield images.c.acquired >= as_utc(self.since)
        if self.until is not None:
            yield images.c.acquired <= end_of(self.until)
        if self.verdict is not None:
            yield measurements.c.verdict >= VERDICTS.index(self.verdict)
        if self.image is not None:
            named = names_of(self.image)
            columns = (images.c.path, images.c.name, images.c.content)
            yield or_(*(column.in_(named) for column in columns))
        if self.run is not None:
            yield measurements.c.run_id == int(self.run)

    def by_name(self) -> Iterator[tuple[str, Column[Any], Names | None]]:
        """Filters by whole names: what each is called, its column, and what is wanted."""
        yield "sensor", images.c.sensor, self.sensor
        yield "level", images.c.level, self.level
        yield "band", measurements.c.band, self.band
        yield "site", targets.c.site, self.site
        yield "target", targets.c.name, self.target
        yield "kind", measurements.c.kind, self.kind
        yield "method", measurements.c.method, self.method


def _is_named(column: Column[Any], names: list[str]) -> ColumnElement[bool]:
    """Whether a row has one of some names; the empty one is that of rows without."""
    named = column.in_(names)
    return or_(named, column.is_(None)) if "" in names else named


def _require_limits(metric: str, limits: Any) -> None:
    two = isinstance(limits, tuple | list) and len(limits) == 2
    if not (two and all(one is None or isinstance(one, Real) for one in limits)):
        raise OptionError(
            f"limits of {metric} are {limits!r}: give the least and the largest value, (0.4, None)"
        )


def names_of(wanted: Names) -> list[str]:
    """The names of a filter as a list.

    Raises
    ------
    OptionError
        If they are no texts.
    """
    found = [wanted] if isinstance(wanted, str) or not isinstance(wanted, Iterable) else [*wanted]
    for name in found:
        if not isinstance(name, str):
            raise OptionError(f"{name!r} is a {type(name).__name__}: select by names, as texts")
    return found
