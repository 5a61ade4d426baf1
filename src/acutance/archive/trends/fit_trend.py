"""From a series to its trend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acutance.archive.counted import counted
from acutance.archive.trends.design import Design
from acutance.archive.trends.gsd import gsd_events
from acutance.archive.trends.images import ImageMeans, joined_images, parts_of_places
from acutance.archive.trends.posterior import TrendPosterior, trend_posterior
from acutance.archive.trends.series import Event, Series, date_of
from acutance.archive.trends.target_effects import TargetEffects, effects_and_images
from acutance.archive.trends.trend import BadDay, Trend
from acutance.archive.trends.tuned import MAX_IMAGES, MIN_IMAGES, OUTLIER_SCALES
from acutance.arguments import require_all, require_kind
from acutance.curves.grid import Floats
from acutance.errors import OptionError

__all__ = ["fit_trend"]

_YEAR_DAYS = 365.25
_MIN_DAYS = 1.0
_MEAN_INSTEAD = "take their mean (acutance archive table, archive.table)"


def fit_trend(series: Series, events: Sequence[Event] = ()) -> Trend:
    """Level, drift, steps, season and scatter of a series.

    Where the GSD of the images changes, a metric in pixels gets an event there
    (`acutance.archive.trends.gsd`).

    Parameters
    ----------
    series : Series
    events : sequence of Event, optional
        Dates at which the sensor may have changed.

    Returns
    -------
    Trend

    Raises
    ------
    OptionError
        If fewer than three images have dates, or all are of one day; if an argument is of the
        wrong kind.
    """
    require_kind(Series, series=series)
    events = require_all(Event, "events", events)
    dated = series.dated()
    changes, notes = gsd_events(dated)
    effects, single = effects_and_images(dated)
    _require_time(single, dated)
    images = joined_images(single, MAX_IMAGES)
    effects = effects.joined(parts_of_places(single.size, MAX_IMAGES))
    ordered = tuple(sorted((*events, *changes), key=lambda event: event.year))
    design = Design(float(images.when.mean()), ordered)
    posterior, added = trend_posterior(images, design, effects)
    # Images as the mean of all targets would have them.
    images = replace(images, value=images.value - added)
    return Trend(
        metric=series.metric, name=series.name, measurements=dated.size, images=images,
        posterior=posterior, bad_days=_bad_days(images, posterior, series),
        notes=(*series.notes, *_left_out(series, dated), *_outside(images, events),
               *_together(images, ordered), *notes, *_targets(effects, posterior)),
    )  # fmt: skip


def _require_time(images: ImageMeans, series: Series) -> None:
    days = _YEAR_DAYS * float(images.when[-1] - images.when[0])
    if images.size < MIN_IMAGES:
        are = "has a date" if images.size == 1 else "have dates"
        raise OptionError(
            f"{series.title}: {counted(images.size, 'image')} {are}, a trend needs {MIN_IMAGES}: "
            f"select more (verdict, since, until), or {_MEAN_INSTEAD}"
        )
    if days < _MIN_DAYS:
        raise OptionError(
            f"{series.title}: all {images.size} images are of {date_of(float(images.when[0]))}, "
            f"and a trend needs time between them: {_MEAN_INSTEAD}"
        )


def _left_out(series: Series, dated: Series) -> tuple[str, ...]:
    left = series.known().size - dated.size
    are = "is" if left == 1 else "are"
    return (f"{counted(left, 'measurement')} without a date {are} left out.",) if left else ()


def _targets(effects: TargetEffects, posterior: TrendPosterior) -> tuple[str, ...]:
    """What targets and sites that come again have to do with the numbers."""
    if not effects.are_known:
        return ()
    words = " at ".join(
        counted(count, name)
        for count, name in ((effects.targets, "target"), (effects.sites, "site")) if count
    )  # fmt: skip
    share = posterior.target_std / posterior.unit
    notes = [
        f"The images show {words}, which differ by about {100 * share:.2g} % (standard "
        "deviation): the level is the mean of these, with an interval that allows for how few "
        "they are, and what is peculiar to a target is taken out of its images."
    ]
    if effects.in_turn:
        notes.append(
            "One follows another: what they differ by looks like a change of the sensor, and such "
            "a change like them. Take one image of both, or select one."
        )
    return tuple(notes)


def _outside(images: ImageMeans, events: Sequence[Event]) -> tuple[str, ...]:
    """Events before the first or after the last image: nothing shows what they did."""
    names = [event.name for event in events if not images.surround(event.year)]
    if not names:
        return ()
    return (f"No image shows what {', '.join(names)} did: all are on one side of it.",)


def _together(images: ImageMeans, events: Sequence[Event]) -> tuple[str, ...]:
    """Events without an image between them: nothing shows which of them did what."""
    names: dict[int, list[str]] = {}
    for event in events:
        names.setdefault(int(np.searchsorted(images.when, event.year)), []).append(event.name)
    return tuple(
        f"No image lies between {' and '.join(those)}: only what they changed together is seen, "
        "and each alone has a wide interval."
        for place, those in names.items() if len(those) > 1 and 0 < place < images.size
    )  # fmt: skip


def _bad_days(images: ImageMeans, posterior: TrendPosterior, series: Series) -> tuple[BadDay, ...]:
    """Images too far from the trend, worst first."""
    if images.are_joined:
        return ()
    expected, scale = _expected(images, posterior)
    off = (images.value - expected) / scale
    far = np.flatnonzero(np.abs(off) > OUTLIER_SCALES)
    return tuple(
        BadDay(
            date_of(float(images.when[at])), series.image_names.get(int(images.label[at]), ""),
            float(images.value[at]), float(expected[at]), float(off[at]),
        )
        for at in far[np.argsort(-np.abs(off[far]))]
    )  # fmt: skip


def _expected(images: ImageMeans, posterior: TrendPosterior) -> tuple[Floats, Floats]:
    """Mean of the posterior at every image, and the scale of its scatter."""
    mean, _ = posterior.of(posterior.rows(images.when))
    return posterior.share @ mean, np.sqrt(posterior.typical_scatter**2 + images.variance)
