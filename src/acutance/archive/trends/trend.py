"""A trend: what a series of measurements says of a sensor through time."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np

from acutance.archive.dates import When
from acutance.archive.trends.bands import TrendBands, mixture_quantiles
from acutance.archive.trends.changes import Change, EventEffect, event_effects, found_changes
from acutance.archive.trends.crossing import Crossing, find_crossing
from acutance.archive.trends.design import SEASON
from acutance.archive.trends.documents import posterior_document, read_posterior
from acutance.archive.trends.images import ImageMeans
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.posterior import TrendPosterior
from acutance.archive.trends.relative import is_told_from_zero
from acutance.archive.trends.scatter import with_scatter
from acutance.archive.trends.series import date_of, decimal_year
from acutance.archive.trends.tuned import MIN_IMAGES_BY_STEPS
from acutance.archive.trends.words import trend_text
from acutance.arguments import require_finite, require_flags, require_floats, require_numbers
from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.metric_bounds import limit_fault, lowest_of
from acutance.curves.metric_words import metric_words
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.targets.document_fields import refuse_damaged, require_document

__all__ = ["SCHEMA", "BadDay", "Trend"]

SCHEMA: Final = "acutance/trend/1"
_REQUIRED: Final = ("metric", "name", "measurements", "images", "posterior", "bad_days", "notes")
_LEVELS: Final = (0.5, 0.95)
_DATES: Final = 121
_HORIZON_YEARS: Final = 20.0
_MAX_YEARS: Final = 1000.0
_LESS_IS_SHARPER: Final = ("fwhm", "half_extent", "overshoot", "undershoot", "giqe_h")


@dataclass(frozen=True)
class BadDay:
    """An image far from the trend.

    Attributes
    ----------
    date : date
    image : str
        What it is called; "" where it has no name.
    value, expected : float
    scales : float
        How far it is off, in units of the scatter.
    """

    date: datetime.date
    image: str
    value: float
    expected: float
    scales: float

    def to_dict(self) -> dict[str, Any]:
        """All fields, the date in ISO 8601."""
        return {**vars(self), "date": self.date.isoformat()}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> BadDay:
        """What `to_dict` wrote."""
        return cls(**{**document, "date": datetime.date.fromisoformat(document["date"])})


@dataclass(frozen=True, eq=False, kw_only=True)
class Trend(ShortRepr):
    """Level, drift, steps, events and season of a metric, with the scatter between images.

    Every number is read from one posterior (`posterior`): intervals are those of its density, and
    the standard deviation of an `Estimate` is the one whose 95 % interval is that of the density.

    Parameters
    ----------
    metric : str
    name : str
        What was measured: "QB02, pan, across".
    measurements : int
    images : ImageMeans
        One mean an image, in the order of time; years with decimals.
    posterior : TrendPosterior
    bad_days : tuple of BadDay
    notes : tuple of str
        What has to be known to read the numbers.

    Examples
    --------
    >>> trend = archive.trend("mtf_nyquist", sensor="QB02", orientation="across")  # doctest: +SKIP
    >>> print(trend.rate_per_year, trend.changes, trend.at("2027-01-01"))  # doctest: +SKIP
    """

    metric: str
    name: str
    measurements: int
    images: ImageMeans
    posterior: TrendPosterior
    bad_days: tuple[BadDay, ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def _drifting(self) -> TrendPosterior:
        return self.posterior.drifting()

    @property
    def title(self) -> str:
        """Metric and what was measured."""
        label = metric_words(self.metric).label
        return f"{label} of {self.name}" if self.name else label

    @property
    def first(self) -> datetime.date:
        """Day of the first image."""
        return date_of(self.images.first)

    @property
    def last(self) -> datetime.date:
        """Day of the last image."""
        return date_of(self.images.last)

    @cached_property
    def level(self) -> Estimate:
        """The sensor's mean on the day of the last image, without the season."""
        return self._estimate(self.mean(self.images.last, season=False))

    @cached_property
    def rate(self) -> NormalMixture:
        """The posterior of the drift per year at the end of the series."""
        return self._drifting.rate(self.images.last)

    @cached_property
    def rate_per_year(self) -> Estimate:
        """Drift per year, in the units of the metric; steps and events are no part of it."""
        return self.rate.estimate()

    @cached_property
    def relative_rate_per_year(self) -> Estimate:
        """Drift per year over the level; ``nan`` where that may be 0."""
        if not self.has_scale:
            return Estimate(np.nan, np.nan)
        return self.rate.times(1 / self.level.value).estimate()

    @cached_property
    def relative_scatter(self) -> float:
        """Scatter between images over the level; ``nan`` where that may be 0."""
        return self.scatter.value / abs(self.level.value) if self.has_scale else np.nan

    @cached_property
    def has_scale(self) -> bool:
        """Whether the level is told from 0, of which changes have no per cent."""
        return is_told_from_zero(self.mean(self.images.last, season=False))

    @property
    def steps_are_sought(self) -> bool:
        """Whether there are images enough to seek a step at an unknown date."""
        return self.images.size >= MIN_IMAGES_BY_STEPS[0]

    @cached_property
    def step_probability(self) -> float:
        """Probability of one or more steps at unknown dates; 0 where none is sought."""
        return float(self.posterior.step_probability[1:].sum())

    @property
    def steady_probability(self) -> float:
        """Probability that the sensor neither drifts nor has had a step; events apart."""
        return self.posterior.steady_probability

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """Steps at unknown dates, in the order of time; those that are probable enough."""
        return found_changes(self.posterior, self.images)

    @cached_property
    def events(self) -> tuple[EventEffect, ...]:
        """What changed at the stated events, of those with images before and after them."""
        return event_effects(self._drifting, self.images)

    @property
    def drift_event(self) -> EventEffect | None:
        """The last event since which the drift is another one; ``None`` without such."""
        own = [one for one in self.events if one.drift_change_per_year is not None]
        return own[-1] if own else None

    @cached_property
    def season_probability(self) -> float:
        """Probability of a season."""
        return float(self._drifting.share @ self._drifting.has_season)

    @cached_property
    def season_amplitude(self) -> Estimate:
        """Half the way from the season's least to its most; 0 as far as there is none."""
        found = self._drifting
        wave = found.mode[:, SEASON]
        size = np.linalg.norm(wave, axis=1)
        along = wave / np.maximum(size, 1e-12)[:, None]
        variance = np.einsum("qi,qij,qj->q", along, found.covariance[:, SEASON, SEASON], along)
        mixture = NormalMixture(found.share, found.unit * size, found.unit * np.sqrt(variance))
        return mixture.estimate(0.0)

    @cached_property
    def scatter(self) -> Estimate:
        """Scatter between images: scale of a Student-t density, in the units of the metric."""
        share, scatter = self._drifting.share, np.hypot(self._drifting.scatter, self.images.scatter)
        mean = float(share @ scatter)
        return Estimate(mean, float(np.sqrt(share @ (scatter - mean) ** 2)), 0.0)

    def mean(self, year: float, *, season: bool = True) -> NormalMixture:
        """The posterior of the sensor's mean at one date.

        Parameters
        ----------
        year : float
            With decimals.
        season : bool, optional
            Without it the mean over a year around the date.
        """
        require_finite(year=year)
        mean, std = self._drifting.of(self._drifting.rows(np.array([year]), season=season))
        found = NormalMixture(self._drifting.share, mean[:, 0], std[:, 0])
        return found.wider(self.images.systematic_std)

    def at(self, when: When) -> Estimate:
        """The mean of the sensor at a date: what images would give on average.

        Before the first and after the last image the drift is continued; no other change is
        expected.
        """
        return self._estimate(self.mean(decimal_year(when)))

    def predict(self, when: When, std: float | None = None) -> Estimate:
        """What one more image would give.

        Parameters
        ----------
        when : datetime, date or str
        std : float, optional
            Random standard deviation of its measurement; that of a typical one without it.

        Raises
        ------
        OptionError
            If there is no such date, or the deviation is no number from 0 on.
        """
        if std is not None:
            require_finite(std=std)
            if std < 0:
                raise OptionError(f"std is {std:g}, a deviation has to be 0 or more")
        year = decimal_year(when)
        mean, own = self._drifting.of(self._drifting.rows(np.array([year])))
        found = NormalMixture(self._drifting.share, mean[:, 0], own[:, 0])
        noise = self.images.typical_std if std is None else std
        return self._estimate(with_scatter(found, *self._scales(noise)))

    def crosses(
        self, limit: float, *, is_minimum: bool | None = None, within_years: float = _HORIZON_YEARS
    ) -> Crossing:
        """When the mean of the sensor, over the year, will pass a limit.

        Parameters
        ----------
        limit : float
            In the units of the metric.
        is_minimum : bool, optional
            Whether the sensor has to be above it; without it true of the MTF and the relative edge
            response, false of widths and overshoots.
        within_years : float, optional
            How far ahead of the last image is looked: 1000 at most.

        Raises
        ------
        OptionError
            If it is longer, the metric cannot have such a limit, or an argument is of another kind.
        """
        require_numbers(limit=limit, within_years=within_years)
        if is_minimum is not None:
            require_flags(is_minimum=is_minimum)
        if not (np.isfinite(limit) and 0 < within_years <= _MAX_YEARS):
            raise OptionError(
                f"the limit is {limit:g} and the time {within_years:g} years: give a number, and "
                f"a time above 0 and up to {_MAX_YEARS:g}"
            )
        if fault := limit_fault(self.metric, limit):
            raise OptionError(f"the limit {limit:g} of {self.metric} is never passed: {fault}")
        falls = not self.metric.startswith(_LESS_IS_SHARPER) if is_minimum is None else is_minimum
        return find_crossing(
            self._drifting, self.images.systematic_std, self.images.last, limit,
            falls, within_years,
        )  # fmt: skip

    def bands(self, years: Floats | None = None) -> TrendBands:
        """The mean of the sensor and single images on a grid of dates, with 50 and 95 % bands.

        Parameters
        ----------
        years : (n,) array, optional
            With decimals; from the first to the last image without it.

        Raises
        ------
        OptionError
            If they are no list of finite numbers.
        """
        if years is None:
            years = np.linspace(self.images.first, self.images.last, _DATES)
        years = require_floats("years", years)
        if years.ndim != 1 or not years.size or not np.isfinite(years).all():
            raise OptionError(f"years are {years!r:.80}: give a list of years, with decimals")
        found = self._drifting
        mean, std = found.of(found.rows(years))
        wide = np.hypot(std, self.images.systematic_std)
        levels = [0.5, *(side for one in _LEVELS for side in (0.5 - one / 2, 0.5 + one / 2))]
        middle, *ends = (mixture_quantiles(found.share, mean, wide, level) for level in levels)
        scattered = with_scatter(NormalMixture(found.share, mean, std),
                                 *self._scales(self.images.typical_std))  # fmt: skip
        images = [mixture_quantiles(scattered.share, scattered.mean, scattered.std, level)
                  for level in levels[-2:]]  # fmt: skip
        lowest = lowest_of(self.metric)
        if lowest is not None:
            # As the intervals of the level: no part of a band lies where no value can be.
            middle, *ends = (np.maximum(lowest, one) for one in (middle, *ends))
            images = [np.maximum(lowest, one) for one in images]
        return TrendBands(years, middle, (ends[0], ends[1]), (ends[2], ends[3]),
                          (images[0], images[1]))  # fmt: skip

    def _scales(self, std: float) -> tuple[Floats, Floats]:
        """Scales and degrees of freedom of single images about the mean, (q,) each."""
        scatter = np.hypot(self._drifting.scatter, self.images.scatter)
        return np.hypot(scatter, std), self._drifting.degrees

    def _estimate(self, density: NormalMixture) -> Estimate:
        return density.estimate(lowest_of(self.metric))

    def summary(self) -> str:
        """What the trend is, in a few sentences."""
        return trend_text(self)

    def to_dict(self) -> dict[str, Any]:
        """The trend as strict JSON types: its numbers, then what they are read from."""
        bands = self.bands()
        return {
            "schema": SCHEMA,
            "metric": self.metric,
            "name": self.name,
            "measurements": self.measurements,
            "summary": self.summary(),
            "first": self.first.isoformat(),
            "last": self.last.isoformat(),
            "level": self.level.to_dict(),
            "rate_per_year": self.rate_per_year.to_dict(),
            "relative_rate_per_year": self.relative_rate_per_year.to_dict(),
            "steady_probability": self.steady_probability,
            "steps_are_sought": self.steps_are_sought,
            "step_probability": self.step_probability,
            "probability_by_steps": self.posterior.step_probability.tolist(),
            "changes": [change.to_dict() for change in self.changes],
            "events": [event.to_dict() for event in self.events],
            "season": {
                "probability": self.season_probability,
                "amplitude": self.season_amplitude.to_dict(),
            },
            "scatter": self.scatter.to_dict(),
            "bad_days": [day.to_dict() for day in self.bad_days],
            "notes": list(self.notes),
            "bands": bands.to_dict(),
            "images": self.images.to_dict(),
            "posterior": posterior_document(self.posterior),
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Trend:
        """The trend that `to_dict` wrote.

        Raises
        ------
        OptionError
            If the document is none of a trend, or damaged.
        """
        advice = "write one with acutance archive trend and --json"
        require_document(document, SCHEMA, _REQUIRED, name="the trend", advice=advice)
        with refuse_damaged("the trend", advice):
            return cls(
                metric=document["metric"], name=document["name"],
                measurements=document["measurements"],
                images=ImageMeans.from_dict(document["images"]),
                posterior=read_posterior(document["posterior"]),
                bad_days=tuple(map(BadDay.from_dict, document["bad_days"])),
                notes=tuple(document["notes"]),
            )  # fmt: skip
