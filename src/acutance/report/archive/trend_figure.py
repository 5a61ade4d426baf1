"""A trend drawn: images, the sensor's mean with its bands, steps, events, limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.series import date_of
from acutance.curves.grid import Floats
from acutance.curves.metric_words import METRIC_WORDS
from acutance.report.archive.dates import axis_days, date_axis, day_on_axis
from acutance.report.archive.wording import step_words
from acutance.report.labels import shorten_name
from acutance.report.paper import BLUE, FAINT, GREEN, INK, ORANGE, VERMILION, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.archive.trends import Change, Trend, TrendBands

__all__ = ["are_bad", "draw_trend", "trend_figure"]

_WIDTH_IN, _HEIGHT_IN = 12.4, 4.8
_AHEAD = 0.15
"""Part of the series' time that the trend is continued after its last image."""
_DATES = 181
_MANY = 150
"""More images than these are drawn without their deviations."""
_ROOM = 0.12
_REACH = 6.0
"""Images further from the median than so many of its absolute deviations lie on the rim."""
_LIMIT_REACH = 1.0
"""The axis is stretched to limits that are nearer to what is drawn than its range times this."""
_LABEL_PT = 8.5
_LABEL_STEP = 0.045
"""Labels of limits are apart by this part of the axis."""
_EVENT_STEP = 0.025
"""Names of events that are nearer, as a part of the axis, are written as one."""
_EVENT_LENGTH = 40
_LEGEND_BESIDE = 1.1
"""Where the legend begins, in widths of the axes, with the labels of limits before it."""


def trend_figure(trend: Trend, *, limit: float | Sequence[float] | None = None) -> Figure:
    """A trend on a page of its own.

    Parameters
    ----------
    trend : Trend
    limit : float or sequence of float, optional
        Drawn as lines, in the units of the metric; those far from the trend are named at the end of
        the axis.
    """
    with styled():
        figure = new_page(_WIDTH_IN, _HEIGHT_IN)
        draw_trend(figure.subplots(), trend, limit=limit)
    return figure


def draw_trend(axes: Axes, trend: Trend, *, limit: float | Sequence[float] | None = None) -> None:
    """Draw a trend on axes.

    Parameters
    ----------
    axes : Axes
    trend : Trend
    limit : float or sequence of float, optional
    """
    limits = sorted(set(np.atleast_1d([] if limit is None else limit).tolist()))
    first, last = trend.images.first, trend.images.last
    ahead = last + max(_AHEAD * (last - first), 1 / 24)
    bands = trend.bands(np.union1d(np.linspace(first, ahead, _DATES), [last]))
    _draw_bands(axes, bands, last)
    low, high = _range(trend, bands, limits)
    _draw_images(axes, trend, low, high)
    axes.set_ylim(low, high)
    _draw_limits(axes, limits)
    axes.set_xlim(axis_days(first - 0.02 * (ahead - first)), axis_days(ahead))
    _draw_changes(axes, trend)
    date_axis(axes)
    words = METRIC_WORDS[trend.metric]
    axes.set_ylabel(words.label_with_unit)
    axes.set_title(f"{words.label}{f', {trend.name}' if trend.name else ''}")
    axes.legend(loc="upper left", bbox_to_anchor=(_LEGEND_BESIDE if limits else 1.0, 1.0))


def _draw_bands(axes: Axes, bands: TrendBands, last: float) -> None:
    day, seen, later = axis_days(bands.when), bands.when <= last, bands.when >= last
    axes.fill_between(
        day, *bands.images95, color=FAINT, alpha=0.10, linewidth=0, label="single images, 95 %"
    )
    axes.fill_between(
        day, *bands.band95, color=BLUE, alpha=0.22, linewidth=0, label="the sensor, 95 %"
    )
    axes.fill_between(
        day, *bands.band50, color=BLUE, alpha=0.35, linewidth=0, label="the sensor, 50 %"
    )
    axes.plot(day[seen], bands.mean[seen], color=BLUE, label="the sensor, median")
    axes.plot(day[later], bands.mean[later], color=BLUE, linestyle=":", label="if it goes on")


def _range(trend: Trend, bands: TrendBands, limits: Sequence[float]) -> tuple[float, float]:
    """Ends of the vertical axis: a monstrous image or a far limit does not flatten all others."""
    value = trend.images.value
    middle = float(np.median(value))
    spread = _REACH * float(np.median(np.abs(value - middle))) or 0.05 * abs(middle) or 1.0
    near = value[np.abs(value - middle) <= spread]
    ends = [
        near.min(),
        near.max(),
        *(one for side in bands.band95 for one in (side.min(), side.max())),
    ]
    reach = _LIMIT_REACH * (max(ends) - min(ends))
    low, high = min(ends) - reach, max(ends) + reach
    ends += [one for one in limits if low <= one <= high]
    room = _ROOM * (max(ends) - min(ends)) or 0.05 * abs(middle) or 1.0
    return float(min(ends) - room), float(max(ends) + room)


def _draw_images(axes: Axes, trend: Trend, low: float, high: float) -> None:
    images = trend.images
    day, value = axis_days(images.when), images.value
    inside = (value >= low) & (value <= high)
    bad = are_bad(trend)
    several = "means of several images" if images.are_joined else "images"
    for those, color, label in ((~bad, INK, several), (bad, VERMILION, "bad days")):
        shown = those & inside
        if not those.any():
            continue
        if images.size <= _MANY:
            axes.errorbar(
                day[shown], value[shown], yerr=np.sqrt(images.variance[shown]), fmt="o",
                color=color, markersize=4, elinewidth=0.8, alpha=0.85, label=label,
            )  # fmt: skip
        else:
            axes.plot(
                day[shown], value[shown], ".", color=color, markersize=3, alpha=0.5, label=label,
                rasterized=True,
            )  # fmt: skip
        for beyond, marker, place in ((value > high, "^", high), (value < low, "v", low)):
            outside = those & beyond
            if outside.any():
                axes.plot(
                    day[outside], np.full(outside.sum(), place), marker, color=color, clip_on=False
                )


def are_bad(trend: Trend) -> NDArray[np.bool_]:
    """Which images are far from the trend, (j,)."""
    bad = {(day.date, day.value) for day in trend.bad_days}
    found = zip(trend.images.when.tolist(), trend.images.value.tolist(), strict=True)
    return np.array([(date_of(when), value) in bad for when, value in found])


def _draw_limits(axes: Axes, limits: Sequence[float]) -> None:
    """Lines with their labels beside the axes, where nothing else is drawn."""
    low, high = axes.get_ylim()
    for limit in limits:
        if low <= limit <= high:
            axes.axhline(limit, color=VERMILION, linewidth=1.2, linestyle="--")
    marks = ["↓ " if one < low else "↑ " if one > high else "" for one in limits]
    shares = np.clip((np.array(limits) - low) / (high - low), 0.0, 1.0)
    for limit, mark, place in zip(limits, marks, _apart(shares), strict=True):
        axes.text(
            1.0, place, f" {mark}limit {limit:g}", transform=axes.transAxes, ha="left",
            va="center", fontsize=_LABEL_PT, color=VERMILION,
        )  # fmt: skip


def _apart(shares: Floats) -> Floats:
    """Rising places on the axis, moved until none is nearer to the next than a line of text."""
    steps = _LABEL_STEP * np.arange(shares.size)
    upwards = np.maximum.accumulate(shares - steps) + steps
    # Those that were moved beyond the top come down, with those below them.
    downwards = np.minimum.accumulate((np.minimum(upwards, 1.0) - steps)[::-1])[::-1]
    return np.asarray(downwards + steps)


def _draw_changes(axes: Axes, trend: Trend) -> None:
    """Steps as the days between which they lie, events as lines, each with its words."""
    for change in trend.changes:
        _draw_step(axes, change)
    days: dict[float, list[str]] = {}
    for event in trend.events:
        days.setdefault(day_on_axis(event.date), []).append(event.name)
    for day in days:
        axes.axvline(day, color=GREEN, linewidth=1.1, linestyle="-.")
    first, last = axes.get_xlim()
    for day, name in _labels(days, _EVENT_STEP * (last - first)).items():
        axes.text(
            day, 0.02, f" {name}", transform=axes.get_xaxis_transform(), rotation=90,
            ha="right", va="bottom", fontsize=8.5, color=GREEN,
            bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1.0},
        )  # fmt: skip


def _labels(days: dict[float, list[str]], room: float) -> dict[float, str]:
    """Names of events by the day that they stand at; those without room for each are one label."""
    found: dict[float, list[str]] = {}
    for day in sorted(days):
        before = next(reversed(found), None)
        place = day if before is None or day - before >= room else before
        found.setdefault(place, []).extend(days[day])
    return {day: shorten_name(", ".join(names), _EVENT_LENGTH) for day, names in found.items()}


def _draw_step(axes: Axes, change: Change) -> None:
    day, since, until = map(day_on_axis, (change.date, change.since, change.until))
    axes.axvspan(since, until, color=ORANGE, alpha=0.18, linewidth=0)
    axes.axvline(day, color=ORANGE, linewidth=1.2)
    axes.text(
        day, 0.98, f" step {step_words(change)} ",
        transform=axes.get_xaxis_transform(), ha="left", va="top", fontsize=8.5, color=INK,
        bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1.0},
    )  # fmt: skip
