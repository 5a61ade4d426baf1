"""The page of one trend: the answer, the drawing, the numbers, the images."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from acutance.archive.trends.series import date_of
from acutance.archive.trends.tuned import DRIFT_STDS_PER_YEAR
from acutance.archive.trends.words import (
    new_drift_words,
    season_words,
    since_words,
    unsought_words,
)
from acutance.curves import Estimate
from acutance.curves.metric_words import METRIC_WORDS
from acutance.report.archive.trend_figure import are_bad, trend_figure
from acutance.report.archive.wording import (
    interval_words,
    percent,
    rate_words,
    signed,
    step_percent,
    step_words,
    with_minus,
)
from acutance.report.html import Plate, Section, Table, Verdict, render_page
from acutance.report.labels import MISSING, word_estimate

if TYPE_CHECKING:
    from acutance.archive.trends import EventEffect, Trend

__all__ = ["trend_page", "trend_plate", "trend_verdict"]

_MAX_IMAGES = 400
_WORTH = 0.1
_LEVEL = 0.95
_SINGLE = (
    "Deviation from the trend in units of the image's own standard deviation and the scatter "
    "between images together."
)
_JOINED = (
    "Means of images that follow one another, with deviations by the scatter of these images. "
    "Deviation from the trend in units of that deviation and the scatter between such means "
    "together."
)


def trend_page(trend: Trend, *, limit: float | None = None, command: str | None = None) -> str:
    """One trend as one self-contained HTML page.

    Parameters
    ----------
    trend : Trend
    limit : float, optional
        When the sensor will pass it is part of the answer.
    command : str, optional
        The command line.
    """
    answer = Section(
        "Result",
        paragraphs=(with_minus(trend.summary()),),
        verdicts=(trend_verdict(trend, limit),),
        plates=(trend_plate(trend, limit),),
    )
    tables = (_numbers_table(trend), *_changes_table(trend), _images_table(trend))
    content = (answer, *map(Section.of_table, tables), _method_section(command))
    facts = {
        "measurements": str(trend.measurements),
        "images": str(trend.images.images),
        "from": trend.first.isoformat(),
        "to": trend.last.isoformat(),
    }
    return render_page(f"Trend of {METRIC_WORDS[trend.metric].label}", trend.name, content, facts)


def trend_plate(trend: Trend, limit: float | Sequence[float] | None = None) -> Plate:
    """The drawing with its caption."""
    return Plate.of_figure(
        trend_figure(trend, limit=limit),
        f"{METRIC_WORDS[trend.metric].label} of the sensor through time",
        "Dots: means of the measurements of an image, with their random standard deviations "
        "(arrows lie outside the drawing); orange-red: far from all others (bad days), and of "
        "little weight. Blue: the sensor's mean with its 50 and 95 % bands; "
        "dotted: if the drift goes on. Grey: between these lie 95 % of single images. Amber: a "
        "step at a date that was not stated, and the days between which it lies. Green: stated "
        "events. Dashed: limits; those with an arrow lie outside the drawing.",
        wide=True,
    )


def trend_verdict(trend: Trend, limit: float | None = None, label: str = "") -> Verdict:
    """Whether the sensor changes, in one sentence, with what else has to be known.

    Parameters
    ----------
    trend : Trend
    limit : float, optional
    label : str, optional
        Begins the sentence.
    """
    words: list[str] = []
    rate, since = trend.rate_per_year, since_words(trend)
    if not _holds_zero(rate):
        verb = "rises" if rate.value > 0 else "falls"
        words.append(f"{verb} by {rate_words(trend, sign=False)} a year{since}")
    words += [f"changed by {step_words(one)} about {one.date}" for one in trend.changes]
    words += [
        f"{one.name} of {one.date}: {step_words(one)}"
        for one in trend.events
        if not _holds_zero(one.size)
    ]
    word: Literal["good", "usable", "doubtful"] = "doubtful"
    if not words:
        # Without steps sought, or with a drift that is hardly known, "none" is no good news.
        sought = "change" if trend.steps_are_sought else "drift"
        words = [f"no {sought} is found: {rate_words(trend)} a year{since}"]
        word = "good" if trend.steps_are_sought and _drift_is_known(trend) else "usable"
    level = f"{METRIC_WORDS[trend.metric].of(_value(trend.level))} on {trend.last}"
    details = [("season", text) for text in (with_minus(season_words(trend)),) if text]
    details += [("steps", text) for text in _open_steps(trend)]
    if limit is not None:
        details.append(("limit", f"{trend.crosses(limit).summary()}."))
    return Verdict(word, f"{label}{level}; {', '.join(words)}.", tuple(details))


def _drift_is_known(trend: Trend) -> bool:
    """Whether "none is found" means more of a drift than was expected before any image."""
    return not trend.has_scale or trend.relative_rate_per_year.std < min(DRIFT_STDS_PER_YEAR)


def _holds_zero(estimate: Estimate) -> bool:
    low, high = estimate.interval(_LEVEL)
    return low <= 0 <= high


def _open_steps(trend: Trend) -> list[str]:
    if unsought := unsought_words(trend):
        return [f"{unsought}."]
    if trend.changes or trend.step_probability < _WORTH:
        return []
    return [
        f"a step at an unknown date cannot be ruled out (probability {trend.step_probability:.2f})."
    ]


def _value(estimate: Estimate) -> str:
    return word_estimate(estimate).value_and_std


def _numbers_table(trend: Trend) -> Table:
    words = METRIC_WORDS[trend.metric]
    rate, relative = trend.rate_per_year, trend.relative_rate_per_year
    since = since_words(trend)
    # A level that may be 0 has no per cent.
    in_percent = [
        (
            f"drift per year [%]{since}",
            percent(relative).removesuffix(" %"),
            interval_words(100.0 * relative),
        )
    ] if trend.has_scale else []  # fmt: skip
    rows = [
        (
            f"{words.label_with_unit} on {trend.last}",
            _value(trend.level),
            interval_words(trend.level),
        ),
        (f"drift per year{since}", _value(rate), interval_words(rate)),
        *in_percent,
        ("scatter between images", _value(trend.scatter), MISSING),
        ("season, half its range", _value(trend.season_amplitude), MISSING),
        ("probability of a season", f"{trend.season_probability:.2f}", MISSING),
        _no_step_row(trend),
    ]
    return Table(("", "Value", "95 % interval"), tuple(rows), "lrr", title="Numbers")


def _no_step_row(trend: Trend) -> tuple[str, str, str]:
    if unsought := unsought_words(trend):
        return "steps at unknown dates", unsought, MISSING
    return "probability of no step at an unknown date", f"{1 - trend.step_probability:.2f}", MISSING


def _changes_table(trend: Trend) -> tuple[Table, ...]:
    rows = [
        (
            f"{one.date}\n{one.since} to {one.until}", "step, found",
            _value(one.size), step_percent(one), f"{one.probability:.2f}",
        )
        for one in trend.changes
    ] + [
        (
            str(one.date), _event_words(one), _value(one.size), step_percent(one), MISSING,
        )
        for one in trend.events
    ]  # fmt: skip
    if not rows:
        return ()
    columns = ("Date", "What", "Size", "Relative", "Probability")
    return (Table(columns, tuple(rows), "llrrr", title="Changes"),)


def _event_words(event: EventEffect) -> str:
    """The name of an event, below it what it changed of the drift."""
    return "\n".join(filter(None, (event.name, with_minus(new_drift_words(event)))))


def _images_table(trend: Trend) -> Table:
    """Every image with its mean and how far it is from the trend, in its own deviations."""
    images = trend.images
    expected = trend.bands(images.when).mean
    scale = np.sqrt(images.variance + trend.posterior.drifting().typical_scatter ** 2)
    bad = are_bad(trend)
    rows: list[tuple[str, ...]] = []
    alerts = set()
    for at in range(min(images.size, _MAX_IMAGES)):
        if bad[at]:
            alerts.add(len(rows))
        mean = Estimate(float(images.value[at]), float(np.sqrt(images.variance[at])))
        rows.append((
            str(date_of(float(images.when[at]))), str(int(images.count[at])),
            _value(mean), signed((images.value[at] - expected[at]) / scale[at]),
        ))  # fmt: skip
    left = images.size - len(rows)
    notes = [_JOINED if images.are_joined else _SINGLE]
    if left:
        notes.append(f"The first {len(rows)}; {left} more are not listed.")
    return Table(
        ("Date", "Measurements", "Mean", "From the trend"), tuple(rows), "lrrr",
        parts=2 if len(rows) > 20 else 1, alerts=frozenset(alerts), title="Images",
        notes=tuple(notes), page_only=True,
    )  # fmt: skip


def _method_section(command: str | None) -> Section:
    return Section(
        "How",
        paragraphs=(
            "Level, drift, steps and season are fitted together. Images scatter with heavy tails "
            "(Student's t), so that bad days count little; steps at unknown dates have their "
            "probability from the evidence of 0 to 3 of them, summed over all places; intervals "
            "are those of the posterior, with the systematic part of the stated deviations, which "
            "does not average out.",
        ),
        command=command,
    )
