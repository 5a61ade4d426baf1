"""The columns of a trend: level, drift, season, stated events; steps are added by place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.archive.trends.series import Event
from acutance.archive.trends.tuned import (
    DRIFT_STDS_PER_YEAR,
    NO_STD,
    SEASON_STD,
)
from acutance.curves.grid import Floats

__all__ = ["DRIFT", "LEVEL", "SEASON", "Design"]

LEVEL, DRIFT, SEASON = 0, 1, slice(2, 4)


@dataclass(frozen=True)
class Design:
    """What a trend is made of besides its steps.

    Parameters
    ----------
    centre : float
        Year with decimals at which level and drift are told apart.
    events : tuple of Event
        In the order of time.
    """

    centre: float
    events: tuple[Event, ...] = ()

    @property
    def size(self) -> int:
        """Number of columns."""
        return 4 + sum(1 + event.changes_drift for event in self.events)

    def columns(self, when: Floats, *, season: bool = True) -> Floats:
        """Level, drift, the season's cosine and sine, step and slope of every event, (n, p).

        Parameters
        ----------
        when : (n,) array
        season : bool, optional
            Without it the season's columns are 0: the mean over a year.
        """
        turn = 2 * np.pi * when
        wave = (np.cos(turn), np.sin(turn)) if season else (0 * when, 0 * when)
        found = [np.ones_like(when), when - self.centre, *wave]
        for event in self.events:
            after = (when >= event.year).astype(float)
            found.append(after)
            if event.changes_drift:
                found.append(after * (when - event.year))
        return np.column_stack(found)

    def slopes(self, when: float) -> Floats:
        """Derivatives of the columns by time, without the season, (p,)."""
        found = [0.0, 1.0, 0.0, 0.0]
        for event in self.events:
            found.append(0.0)
            if event.changes_drift:
                found.append(float(when >= event.year))
        return np.array(found)

    def precision(self, *, drift_std: float, season: bool, event_std: float) -> Floats:
        """Of the priors of all columns, relative to the level; that of the level is flat.

        Parameters
        ----------
        drift_std : float
            Of the drift per year; 0 where there is none.
        season : bool
        event_std : float
            Of the step at an event.
        """
        drift = max(drift_std, NO_STD)
        wave = SEASON_STD if season else NO_STD
        stds = [drift, wave, wave]
        for event in self.events:
            stds.append(event_std)
            if event.changes_drift:
                stds.append(max(DRIFT_STDS_PER_YEAR))
        return np.array([0.0, *(1 / std**2 for std in stds)])
