"""What an archive says of a sensor: for every band and direction its trends, or means."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date

import numpy as np

from acutance.archive.columns import Columns
from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.trends import Event, Trend, fit_trend
from acutance.archive.trends.measured_series import NO_SENSOR, all_series
from acutance.archive.trends.series import date_of
from acutance.archive.weighted_means import WeightedMean
from acutance.curves import MAIN_NUMBERS, Estimate
from acutance.errors import OptionError

__all__ = ["SeriesState", "states_of"]


@dataclass(frozen=True, eq=False)
class SeriesState:
    """One band and direction of a sensor.

    Attributes
    ----------
    name : str
        Band, product level, direction.
    metric : str
        What is drawn.
    found : dict of str to Trend or WeightedMean
        By metric; means where images are too few, or have no dates. Metrics without any value, as
        papers do not print all, are left out.
    measurements, images : int
    days : tuple of date
        Of the first and of the last image; empty where none has a date.
    notes : tuple of str
        What has to be known of the measurements, in sentences.
    """

    name: str
    metric: str
    found: dict[str, Trend | WeightedMean]
    measurements: int
    images: int
    days: tuple[date, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def trend(self) -> Trend | None:
        """The trend that is drawn."""
        main = self.found[self.metric]
        return main if isinstance(main, Trend) else None

    def level(self, metric: str) -> Estimate:
        """The sensor on the day of its last image, or the mean of all."""
        one = self.found[metric]
        return one.level if isinstance(one, Trend) else one.mean


def states_of(
    rows: Columns,
    sensor: str,
    metric: str,
    events: Sequence[Event],
    progress: Callable[[int, int], None] | None = None,
) -> list[SeriesState]:
    """The state of every band, product level and direction.

    Parameters
    ----------
    rows : Columns
        Measurements of one sensor.
    sensor : str
    metric : str
        What is drawn, and the main numbers are tabulated with it; what has no value of it has no
        state.
    events : sequence of Event
    progress : function of (done, total), optional
        Called before every band and direction.
    """
    metrics = tuple(dict.fromkeys((metric, *MAIN_NUMBERS)))
    several = {one: list(all_series(rows, one)) for one in metrics}
    states = []
    for at, main in enumerate(several[metric]):
        if progress is not None:
            progress(at, len(several[metric]))
        known = main.known()
        if known.size == 0:
            continue
        found: dict[str, Trend | WeightedMean] = {}
        for one in metrics:
            series = several[one][at]
            if series.known().size == 0:
                continue
            try:
                found[one] = fit_trend(series, events)
            except OptionError:
                found[one] = mean_of_images(series)
        name = main.name.removeprefix(sensor or NO_SENSOR).removeprefix(", ")
        when = known.when[np.isfinite(known.when)]
        days = (date_of(float(when.min())), date_of(float(when.max()))) if when.size else ()
        images = len(set(known.image.tolist()))
        drawn = found[metric]
        notes = drawn.notes if isinstance(drawn, Trend) else main.notes
        states.append(SeriesState(name, metric, found, known.size, images, days, notes))
    return states
