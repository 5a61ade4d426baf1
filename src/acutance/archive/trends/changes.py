"""What changed: steps at unknown dates, and the steps at stated events."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.archive.trends.images import ImageMeans
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.posterior import TrendPosterior
from acutance.archive.trends.relative import is_told_from_zero
from acutance.archive.trends.series import date_of
from acutance.archive.trends.tuned import REPORTED_SIGN, REPORTED_SPAN, REPORTED_STEP
from acutance.curves import Estimate
from acutance.curves.grid import Floats

__all__ = ["Change", "EventEffect", "event_effects", "found_changes"]

_LEVEL = 0.95
_JUST_YEARS = 1e-6
"""Half a minute."""


@dataclass(frozen=True)
class Change:
    """A step at a date that was not stated.

    Attributes
    ----------
    date : date
        As probable before as after it.
    since, until : date
        Days between which it lies with a probability of 95 %.
    size : Estimate
        In the units of the metric; negative where it fell.
    relative_size : Estimate
        Over the level just before it; ``nan`` where that may be 0.
    probability : float
        That there is a step between those days.
    """

    date: datetime.date
    since: datetime.date
    until: datetime.date
    size: Estimate
    relative_size: Estimate
    probability: float

    def to_dict(self) -> dict[str, Any]:
        """All fields, dates in ISO 8601."""
        return {
            "date": self.date.isoformat(),
            "since": self.since.isoformat(),
            "until": self.until.isoformat(),
            "size": self.size.to_dict(),
            "relative_size": self.relative_size.to_dict(),
            "probability": self.probability,
        }


@dataclass(frozen=True)
class EventEffect:
    """What a stated event did.

    Attributes
    ----------
    name : str
    date : date
    size : Estimate
        Step, in the units of the metric.
    relative_size : Estimate
        Over the level just before it; ``nan`` where that may be 0.
    drift_before_per_year, drift_change_per_year : Estimate or None
        Where the drift may have changed, in the units of the metric.
    """

    name: str
    date: datetime.date
    size: Estimate
    relative_size: Estimate
    drift_before_per_year: Estimate | None = None
    drift_change_per_year: Estimate | None = None

    def to_dict(self) -> Mapping[str, Any]:
        """All fields, the date in ISO 8601."""
        slopes = {
            "drift_before_per_year": self.drift_before_per_year,
            "drift_change_per_year": self.drift_change_per_year,
        }
        return {
            "name": self.name,
            "date": self.date.isoformat(),
            "size": self.size.to_dict(),
            "relative_size": self.relative_size.to_dict(),
            **{name: None if one is None else one.to_dict() for name, one in slopes.items()},
        }


def found_changes(posterior: TrendPosterior, images: ImageMeans) -> tuple[Change, ...]:
    """The steps that are probable enough to be reported, in the order of time."""
    probability = posterior.step_probability
    if probability[1:].sum() < REPORTED_STEP:
        return ()
    count = 1 + int(np.argmax(probability[1:]))
    with_them = posterior.steps == count
    if not with_them.any():
        return ()
    those = posterior.those(with_them)
    found = (_change(posterior, those, place) for place in range(count))
    days = (date_of(images.last) - date_of(images.first)).days
    return tuple(change for change in found if _is_reported(change, days))


def _is_reported(change: Change, days: float) -> bool:
    """Whether a step is probable, and it is known roughly when it was, or that it goes up or down.

    Parameters
    ----------
    change : Change
    days : float
        From the first to the last image.
    """
    above = change.size.probability_above(0.0)
    is_placed = (change.until - change.since).days <= REPORTED_SPAN * days
    is_signed = max(above, 1 - above) >= REPORTED_SIGN
    return change.probability >= REPORTED_STEP and (is_placed or is_signed)


def _change(posterior: TrendPosterior, those: TrendPosterior, place: int) -> Change:
    low, high = those.step_low[:, place], those.step_high[:, place]
    since, middle, until = (
        _gap_quantile(low, high, those.share, level)
        for level in (0.5 - _LEVEL / 2, 0.5, 0.5 + _LEVEL / 2)
    )
    index = posterior.design.size + place
    return Change(
        date_of(middle), date_of(since), date_of(until), those.coefficient(index).estimate(),
        _relative_size(those, index, 0.5 * (low + high)), _probability(posterior, since, until),
    )  # fmt: skip


def _relative_size(posterior: TrendPosterior, index: int, when: Floats) -> Estimate:
    """A step over the level just before it, by the density of both.

    Parameters
    ----------
    posterior : TrendPosterior
    index : int
        The coefficient of the step.
    when : (q,) array
        Where each density has it: between two images they differ about the day, and a level of
        one day for all would be that after the step in some.
    """
    rows = posterior.rows_each(when - _JUST_YEARS)
    level, level_std = posterior.of(rows[:, None])
    if not is_told_from_zero(NormalMixture(posterior.share, level[:, 0], level_std[:, 0])):
        return Estimate(np.nan, np.nan)
    size = posterior.unit * posterior.mode[:, index]
    ratio = size / level[:, 0]
    # d(size / level) = (d size - ratio d level) / level
    slopes = -ratio[:, None] * rows
    slopes[:, index] += 1.0
    _, std = posterior.of((slopes / level)[:, None])
    return NormalMixture(posterior.share, ratio, std[:, 0]).estimate()


def _gap_quantile(low: Floats, high: Floats, share: Floats, level: float) -> float:
    """Quantile of a date that lies anywhere in one of several gaps."""
    edges = np.unique(np.concatenate([low, high]))
    width = np.maximum(high - low, 1e-9)
    part = np.clip((edges[:, None] - low) / width, 0.0, 1.0) @ share
    return float(np.interp(level, part, edges))


def _probability(posterior: TrendPosterior, since: float, until: float) -> float:
    """That any step lies between two dates."""
    width = np.maximum(posterior.step_high - posterior.step_low, 1e-9)
    inside = np.minimum(posterior.step_high, until) - np.maximum(posterior.step_low, since)
    chance = np.nan_to_num(np.clip(inside / width, 0.0, 1.0))
    held = 1 - np.prod(1 - chance, axis=1)
    total = 0.0
    for count, weight in enumerate(posterior.step_probability):
        mask = posterior.steps == count
        if mask.any():
            total += float(
                weight * (posterior.share[mask] @ held[mask]) / posterior.share[mask].sum()
            )
    return total


def event_effects(posterior: TrendPosterior, images: ImageMeans) -> tuple[EventEffect, ...]:
    """The step, and the change of the drift, at every stated event that images show."""
    found, following = [], 4
    for event in posterior.design.events:
        at, following = following, following + 1 + event.changes_drift
        if not images.surround(event.year):
            continue
        size = posterior.coefficient(at).estimate()
        relative = _relative_size(posterior, at, np.full(posterior.share.size, event.year))
        slopes: tuple[Estimate, ...] = ()
        if event.changes_drift:
            before = posterior.rate(event.year - _JUST_YEARS)
            slopes = before.estimate(), posterior.coefficient(at + 1).estimate()
        found.append(EventEffect(event.name, date_of(event.year), size, relative, *slopes))
    return tuple(found)
