"""A trend in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.archive.counted import counted
from acutance.archive.trends.tuned import CHANGED, MIN_IMAGES_BY_STEPS
from acutance.curves import Estimate

if TYPE_CHECKING:
    from acutance.archive.trends.trend import Trend

__all__ = ["percent", "season_words", "signed", "trend_text"]

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
        f"Images scatter by {trend.scatter.value:.2g} "
        f"({100 * trend.scatter.value / abs(trend.level.value or 1.0):.1f} %).",
        *_bad_day_words(trend),
        *trend.notes,
    ]
    return " ".join(part for part in parts if part)


def _drift_words(trend: Trend) -> str:
    rate = trend.relative_rate_per_year
    low, high = rate.interval(0.95)
    ends = f"95 %: {100 * low:+.1f} to {100 * high:+.1f} %"
    if low <= 0 <= high:
        return f"No drift is found: {percent(rate)} a year ({ends})."
    verb = "It rises" if rate.value > 0 else "It falls"
    return f"{verb} by {100 * abs(rate.value):.1f} ± {100 * rate.std:.1f} % a year ({ends})."


def _step_words(trend: Trend) -> list[str]:
    if trend.images.size < MIN_IMAGES_BY_STEPS[0]:
        return [f"Steps are sought from {MIN_IMAGES_BY_STEPS[0]} images on."]
    found = [
        f"A step of {percent(change.relative_size)} about {change.date} ({change.since} to "
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


def _event_words(trend: Trend) -> list[str]:
    return [f"{event.name} ({event.date}): {signed(event.size)}." for event in trend.events]


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
    amplitude = 100 * trend.season_amplitude / abs(trend.level.value or 1.0)
    sure = "" if trend.season_probability > _SURE else f" ({trend.season_probability:.2f} sure)"
    return (
        f"A season of {amplitude.value:.1f} ± {amplitude.std:.1f} %{sure}, of which the level is "
        "free."
    )


def _bad_day_words(trend: Trend) -> list[str]:
    if not trend.bad_days:
        return []
    named = ", ".join(
        f"{day.date}{f' ({day.image})' if day.image else ''}" for day in trend.bad_days[:5]
    )
    more = len(trend.bad_days) - 5
    return [f"Bad days: {named}{f' and {more} more' if more > 0 else ''}."]
