"""Does a sensor meet a requirement: met, not met, or cannot be told yet.

What is judged is the mean of the sensor on the day asked, over the year (without the season): not
a single image, and not the mean of those that happen to be there. Its posterior is that of the
trend; of images that show no trend (fewer than three dates) the mean with random effects stands in.
"""

from __future__ import annotations

import datetime
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import ceil
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from acutance.archive.columns import Columns
from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.requirement_answers import Answer, SpecificationCheck
from acutance.archive.requirement_selection import asked_of, asks_nothing
from acutance.archive.specification import Requirement, Specification
from acutance.archive.trends.fit_trend import fit_trend
from acutance.archive.trends.measured_series import all_series, unmeasured_directions
from acutance.archive.trends.series import Event, Series, date_of, decimal_year
from acutance.archive.trends.trend import Trend
from acutance.archive.trends.tuned import MIN_IMAGES
from acutance.archive.trends.words import season_words
from acutance.curves import Estimate
from acutance.curves.estimate import normal_quantile
from acutance.curves.metric_bounds import lowest_of
from acutance.errors import NothingSelectedError, OptionError
from acutance.targets.conformity import OPEN, conformity_word

__all__ = ["check_requirement", "check_specification"]

_YEAR_DAYS: Final = 365.25
_MOST: Final = 10_000
"""More images than this are no answer."""
_STEP_THAT_COUNTS: Final = 0.05
"""Less of the probability does not skew a density."""


Select = Callable[[dict[str, Any]], Columns]
"""Rows of an archive by the filters of a requirement."""
Unknown = Callable[[Mapping[str, Any]], str]
"""Which names among filters occur nowhere in an archive, in a sentence; "" if all occur."""


def check_specification(
    specification: Specification,
    select: Select,
    events: Sequence[Event] = (),
    *,
    selection: Mapping[str, Any] = MappingProxyType({}),
    unknown: Unknown = lambda _: "",
) -> SpecificationCheck:
    """Judge all requirements of a specification.

    Parameters
    ----------
    specification : Specification
    select : callable
        Rows of an archive by filters (`Requirement.selection`).
    events : sequence of Event, optional
        Dates at which the sensors may have changed.
    selection : mapping, optional
        More filters of an archive; requirements of other sensors, bands and so on are left out.
    unknown : callable, optional
        Which names among filters occur nowhere; "" if all do.

    Returns
    -------
    SpecificationCheck

    Raises
    ------
    NothingSelectedError
        If no requirement is of what is selected, or every one has such names, and nothing is
        left to be judged.
    """
    answers: list[Answer] = []
    missing: list[str] = []
    asked = asked_of(specification, selection)
    if not asked:
        raise NothingSelectedError(unknown(selection) or asks_nothing(specification, selection))
    for requirement, words in asked:
        missing.append(unknown(words))
        answers += _answers(requirement, select(words), words, missing[-1], events)
    if all(missing) and not any(answer.images for answer in answers):
        raise NothingSelectedError(f"no requirement can be judged: {_by_reason(missing)}")
    return SpecificationCheck(specification.title, tuple(answers))


def _by_reason(missing: Sequence[str]) -> str:
    """What is missing, with the numbers of the requirements it is missed by."""
    places: dict[str, list[str]] = {}
    for number, reason in enumerate(missing, 1):
        places.setdefault(reason, []).append(str(number))
    return "; ".join(f"{reason} (requirement {', '.join(at)})" for reason, at in places.items())


def _answers(
    requirement: Requirement, rows: Columns, words: Mapping[str, Any], missing: str,
    events: Sequence[Event],
) -> list[Answer]:  # fmt: skip
    """The answers to one requirement; of what is not there, why it cannot be told."""
    found = [check_requirement(requirement, series, events)
             for series in all_series(rows, requirement.metric)]  # fmt: skip
    no_image = f"there is no image{_trusted_words(requirement)}"
    if missing:
        # Of a name that is mistyped no image will ever be there.
        found.append(_nothing(requirement, _asked_words(words), missing, more_images=None))
    elif not found:
        found.append(_nothing(requirement, _asked_words(words), no_image))
    if words.get("orientation") is None:
        for what, other in unmeasured_directions(rows):
            advice = f'for {other} alone, state orientation = "{other}" in the requirement'
            found.append(_nothing(requirement, what, f"{no_image} ({advice})"))
    return found


def _asked_words(words: Mapping[str, Any]) -> str:
    """Whose measurements are asked for: "QB02 or K3, pan"."""
    chosen = (words.get(name) for name in ("sensor", "band", "orientation"))
    return ", ".join(one if isinstance(one, str) else " or ".join(one) for one in chosen if one)


def _nothing(
    requirement: Requirement, what: str, reason: str, more_images: int | None = MIN_IMAGES
) -> Answer:
    """Nothing in the archive is what a requirement is about."""
    return Answer(requirement, what, OPEN, None, None, None, 0, more_images, reason)


def check_requirement(
    requirement: Requirement, series: Series, events: Sequence[Event] = ()
) -> Answer:
    """Judge a requirement by the measurements of one sensor, band and direction.

    Parameters
    ----------
    requirement : Requirement
    series : Series
        Of its metric; those outside its window are left out here.
    events : sequence of Event, optional
        Dates at which the sensor may have changed.

    Returns
    -------
    Answer
    """
    known = _in_window(series.known(), requirement)
    images = int(np.unique(known.image).size)
    if images < 2:
        return _untold(requirement, series, images)
    try:
        trend = fit_trend(known, events)
    except OptionError:
        return _by_mean(requirement, known)
    return _by_trend(requirement, trend)


def _in_window(series: Series, requirement: Requirement) -> Series:
    if requirement.window_days is None or not np.isfinite(series.when).any():
        return series
    last = np.nanmax(series.when)
    return series.of(series.when >= last - requirement.window_days / _YEAR_DAYS)


def _untold(requirement: Requirement, series: Series, images: int) -> Answer:
    trusted = _trusted_words(requirement)
    if series.size and not series.known().size:
        trusted = f" with a value of {requirement.metric}"
    reason = (
        f"there is no image{trusted}" if images == 0 else
        f"there is one image{trusted}, which does not show how much images scatter"
    )  # fmt: skip
    return Answer(requirement, series.name, OPEN, None, None, None, images,
                  MIN_IMAGES - images, reason)  # fmt: skip


def _trusted_words(requirement: Requirement) -> str:
    """Which measurements count: images with others may well be there."""
    word = requirement.verdict
    return f" with a measurement that is {word}{'' if word == 'good' else ' or better'}"


def _by_trend(requirement: Requirement, trend: Trend) -> Answer:
    first, last = trend.images.first, trend.images.last
    year = last if requirement.on is None else decimal_year(requirement.on)
    density = trend.mean(year, season=False)
    below = density.probability_below(requirement.limit)
    met = 1 - below if requirement.is_minimum else below
    posterior = trend.posterior
    # Of Student-t scatter an image tells (nu + 1) / (nu + 3) of what a normal one would.
    square = trend.scatter.value**2 + trend.images.typical_std**2
    lost = float(posterior.share @ ((posterior.degrees + 3) / (posterior.degrees + 1)))
    mean = density.estimate(lowest_of(trend.metric))
    found = _answer(
        requirement, trend.name, met, mean, date_of(year), trend.images.images, square * lost,
        float(np.hypot(trend.images.systematic_std, posterior.targets_std)),
        " ".join(filter(None, (season_words(trend), *_skewed(requirement, mean, below, trend)))),
    )  # fmt: skip
    found = replace(found, notes=trend.notes)
    nearest = date_of(min(max(year, first), last))
    if found.word != OPEN or found.day is None or nearest == found.day:
        return found
    # How many would tell depends on when they are taken.
    return replace(found, more_images=None, nearest=nearest)


def _skewed(
    requirement: Requirement, mean: Estimate, below: float, trend: Trend
) -> tuple[str, ...]:
    """What to know where the middle of the interval and the probability point to two sides."""
    limit = requirement.limit
    if (mean.value < limit) == (below > 0.5):
        return ()
    middle, most = ("below", "above") if mean.value < limit else ("above", "below")
    # Among few images no step is sought: there it is the scatter that is open.
    has_steps = 1 - trend.posterior.step_probability[0] >= _STEP_THAT_COUNTS
    why = (
        "where a step is probable and not certain" if has_steps else
        "where the images leave open how much they scatter, and which of them lie far off"
    )  # fmt: skip
    return (
        f"The middle of the interval lies {middle} {limit:g}, and yet most of the probability "
        f"{most} it: the density is skewed, as {why}.",
    )


def _by_mean(requirement: Requirement, series: Series) -> Answer:
    """Of images without dates, or all of one day: their mean, taken as that of the sensor."""
    found = mean_of_images(series)
    below = found.probability_below(requirement.limit)
    if np.isnan(below):
        reason = "the images agree to the last digit and state no deviation"
        return Answer(requirement, series.name, OPEN, None, None, None, found.count, None, reason)
    met = 1 - below if requirement.is_minimum else below
    stated = np.nan_to_num(series.std)
    square = found.scatter.value**2 + float(np.median(stated**2))
    return _answer(
        requirement, series.name, met, found.mean, None, found.count, square,
        found.systematic_std,
        " ".join(("No trend: too few dates; the mean of the images stands in.", *series.notes)),
    )  # fmt: skip


def _answer(
    requirement: Requirement, what: str, met: float, mean: Estimate, day: datetime.date | None,
    images: int, square: float, systematic_std: float, reason: str,
) -> Answer:  # fmt: skip
    confidence = requirement.confidence
    word = conformity_word(met, confidence)
    is_told = word != OPEN
    more = 0 if is_told else _images_that_tell(requirement, mean, square, systematic_std)
    return Answer(requirement, what, word, met, mean, day, images, more, reason)


def _images_that_tell(
    requirement: Requirement, mean: Estimate, square: float, systematic_std: float
) -> int | None:
    """Images about the day asked that would bring the mean's deviation to its distance."""
    quantile = normal_quantile(2 * requirement.confidence - 1)
    wanted = ((mean.value - requirement.limit) / quantile) ** 2 - systematic_std**2
    now = max(mean.std**2 - systematic_std**2, 1e-300)
    if wanted <= 0:
        return None
    count = max(1, ceil(square * (1 / wanted - 1 / now)))
    return count if count <= _MOST else None
