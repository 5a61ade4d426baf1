"""A trend in sentences."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

from acutance.archive.counted import counted
from acutance.archive.trends.tuned import CHANGED, MIN_IMAGES_BY_STEPS
from acutance.curves import Estimate

if TYPE_CHECKING:
    from acutance.archive.trends.changes import Change, EventEffect
    from acutance.archive.trends.trend import Trend

__all__ = [
    "new_drift_words",
    "part_words",
    "percent",
    "rate_interval",
    "season_words",
    "signed",
    "since_words",
    "size_words",
    "trend_text",
    "unsought_words",
]

_SOUGHT_FROM = f"Steps are sought from {MIN_IMAGES_BY_STEPS[0]} images on"
_SURE = 0.95
_WORTH = 0.1
_NOTICED = 0.3
"""Deviations between the level and the line on that day, from which on a reader asks why."""


def signed(estimate: Estimate) -> str:
    """An estimate with the sign of its value."""
    return f"+{estimate}" if estimate.value > 0 else str(estimate)


def percent(estimate: Estimate) -> str:
    """A relative estimate in per cent, with its sign."""
    return f"{signed(100 * estimate)} %"


def trend_text(trend: Trend) -> str:
    """What a trend is, in a few sentences."""
    count = counted(trend.images.images, "image")
    parts = [
        f"{trend.title}: {trend.level} on {trend.last} ({trend.measurements} measurements in "
        f"{count}, {trend.first} to {trend.last}).",
        _drift_words(trend),
        *_event_words(trend),
        *_step_words(trend),
        season_words(trend),
        _scatter_words(trend),
        *_bad_day_words(trend),
        *trend.notes,
    ]
    return " ".join(part for part in parts if part)


def _drift_words(trend: Trend) -> str:
    rate, relative = trend.rate_per_year, trend.relative_rate_per_year
    when, ends = since_words(trend), rate_interval(trend)
    low, high = rate.interval(0.95)
    if low <= 0 <= high:
        found = signed(rate) if isnan(relative.value) else percent(relative)
        return f"No drift is found{when}: {found} a year ({ends})."
    size = f"{100 * abs(relative.value):.1f} ± {100 * relative.std:.1f} %"
    if isnan(relative.value):
        size = str(rate if rate.value > 0 else -rate)
    return f"{'It rises' if rate.value > 0 else 'It falls'} by {size} a year{when} ({ends})."


def since_words(trend: Trend) -> str:
    """Since which event the drift is what it is now; "" where no event changed it."""
    event = trend.drift_event
    return "" if event is None else f" since {event.name} ({event.date})"


def rate_interval(trend: Trend) -> str:
    """The 95 % interval of the drift a year, in per cent of the level where it has some."""
    relative = trend.relative_rate_per_year
    if isnan(relative.value):
        low, high = trend.rate_per_year.interval(0.95)
        return f"95 %: {low:+.2g} to {high:+.2g}"
    low, high = relative.interval(0.95)
    return f"95 %: {100 * low:+.1f} to {100 * high:+.1f} %"


def _scatter_words(trend: Trend) -> str:
    size = trend.relative_scatter
    return f"Images scatter by {trend.scatter.value:.2g}{part_words(size)}."


def part_words(part: float) -> str:
    """A part of the level in per cent, in brackets; "" where there is none."""
    return "" if isnan(part) else f" ({100 * part:.1f} %)"


def _step_words(trend: Trend) -> list[str]:
    if not trend.steps_are_sought:
        return [f"{_SOUGHT_FROM}."]
    found = [
        f"A step of {size_words(change)} about {change.date} ({change.since} to "
        f"{change.until}), probability {change.probability:.2f}."
        for change in trend.changes
    ]
    chance = trend.step_probability
    if found:
        return found
    if trend.steady_probability > 1 - CHANGED or chance < _WORTH:
        return [f"No step (probability of one: {chance:.2f})."]
    return [
        f"It has changed (probability {1 - trend.steady_probability:.2f}), and these images cannot "
        f"tell a drift from a step (probability of a step: {chance:.2f})."
    ]


def unsought_words(trend: Trend) -> str:
    """That steps are not sought in so few images; "" where they are."""
    if trend.steps_are_sought:
        return ""
    count = counted(trend.images.size, "image")
    return f"not sought ({count}; from {MIN_IMAGES_BY_STEPS[0]} on)"


def _event_words(trend: Trend) -> list[str]:
    return [
        f"{event.name} ({event.date}): {', '.join((signed(event.size), *_details(event)))}."
        for event in trend.events
    ]


def _details(event: EventEffect) -> list[str]:
    relative = event.relative_size
    found = [] if isnan(relative.value) else [percent(relative)]
    return found + ([words] if (words := new_drift_words(event)) else [])


def size_words(step: Change | EventEffect) -> str:
    """A step in per cent of the level before it; where that may be 0, in units of the metric."""
    return signed(step.size) if isnan(step.relative_size.value) else percent(step.relative_size)


def new_drift_words(event: EventEffect) -> str:
    """The drift before an event, and what it changed of it; "" where it did not."""
    before, change = event.drift_before_per_year, event.drift_change_per_year
    if before is None or change is None:
        return ""
    return f"drift a year before it {signed(before)}, changed by {signed(change)}"


def season_words(trend: Trend) -> str:
    """That the level is without the season, in a sentence; "" where that hardly matters."""
    if trend.season_probability < 0.5:
        there = trend.at(trend.last)
        if abs(there.value - trend.level.value) < _NOTICED * trend.level.std:
            return ""
        return (
            f"The level is without a season, which is there with a probability of "
            f"{trend.season_probability:.2f}; with it the line is at {there} on that day."
        )
    amplitude = trend.season_amplitude
    words = str(amplitude)
    if trend.has_scale:
        amplitude = 100 * amplitude / abs(trend.level.value)
        words = f"{amplitude.value:.1f} ± {amplitude.std:.1f} %"
    sure = "" if trend.season_probability > _SURE else f" ({trend.season_probability:.2f} sure)"
    return f"A season of {words}{sure}, of which the level is free."


def _bad_day_words(trend: Trend) -> list[str]:
    if not trend.bad_days:
        return []
    named = ", ".join(
        f"{day.date}{f' ({day.image})' if day.image else ''}" for day in trend.bad_days[:5]
    )
    more = len(trend.bad_days) - 5
    return [f"Bad days: {named}{f' and {more} more' if more > 0 else ''}."]
