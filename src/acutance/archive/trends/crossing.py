"""When a sensor will pass a limit, if its drift goes on."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from typing import Any, Final

import numpy as np
from scipy.special import ndtr

from acutance.archive.trends.posterior import TrendPosterior
from acutance.archive.trends.series import date_of
from acutance.arguments import require_numbers
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["Crossing", "find_crossing"]

_STEPS_A_YEAR: Final = 12
_POINTS, _WEIGHTS = np.polynomial.hermite_e.hermegauss(31)


@dataclass(frozen=True, eq=False)
class Crossing(ShortRepr):
    """When the mean of a sensor passes a limit.

    Attributes
    ----------
    limit : float
    falls : bool
        Whether it passes the limit when it falls below; else when it rises above.
    when : (n,) array
        Years with decimals, monthly, from the last image on.
    probability : (n,) array
        That it has passed the limit by then.
    """

    limit: float
    falls: bool
    when: Floats
    probability: Floats

    def by(self, level: float) -> date | None:
        """The day by which it has passed with a probability; ``None`` if not within the time.

        Raises
        ------
        OptionError
            If it is no number.
        """
        require_numbers(level=level)
        if self.probability[-1] < level:
            return None
        at = int(np.argmax(self.probability >= level))
        if at == 0:
            return date_of(float(self.when[0]))
        pair = slice(at - 1, at + 1)
        return date_of(float(np.interp(level, self.probability[pair], self.when[pair])))

    @property
    def median(self) -> date | None:
        """As probable before as after it; ``None``: not within the time."""
        return self.by(0.5)

    @property
    def interval(self) -> tuple[date | None, date | None]:
        """Days by which it has passed with probabilities of 2.5 and 97.5 %."""
        return self.by(0.025), self.by(0.975)

    @property
    def years(self) -> float:
        """How far ahead was looked."""
        return float(self.when[-1] - self.when[0])

    def summary(self) -> str:
        """The sentence."""
        verb = "falls below" if self.falls else "rises above"
        median, (early, late) = self.median, self.interval
        if self.probability[0] >= 0.5:
            return f"{verb} {self.limit:g} already (probability {self.probability[0]:.2f})"
        if median is None:
            verb = "fall below" if self.falls else "rise above"
            return (
                f"does not {verb} {self.limit:g} within {self.years:.0f} years, with a probability "
                f"of {1 - self.probability[-1]:.2f}, if the drift goes on"
            )
        # Where the median comes within the time, so does the earlier day.
        days = (
            f"{early} to {late}"
            if late is not None
            else f"{early} or later; perhaps not within {self.years:.0f} years"
        )
        return f"{verb} {self.limit:g} about {median} (95 %: {days}), if the drift goes on"

    def to_dict(self) -> dict[str, Any]:
        """Limit, dates in ISO 8601 (``None``: not within the time), probabilities."""
        early, late = self.interval
        named = {"median": self.median, "by_0.025": early, "by_0.975": late}
        return {
            "limit": self.limit,
            "falls": self.falls,
            **{name: None if day is None else day.isoformat() for name, day in named.items()},
            "within_years": self.years,
            "when": self.when.tolist(),
            "probability": self.probability.tolist(),
        }


def find_crossing(
    posterior: TrendPosterior, systematic_std: float, now: float, limit: float, falls: bool,
    years: float,
) -> Crossing:  # fmt: skip
    """The probabilities of having passed a limit, month by month.

    Parameters
    ----------
    posterior : TrendPosterior
    systematic_std : float
        What all measurements share.
    now : float
        Year with decimals from which the drift is continued.
    limit : float
    falls : bool
        Whether below the limit is beyond it, or above.
    years : float
        How far ahead.
    """
    ahead = np.arange(0, round(years * _STEPS_A_YEAR) + 1) / _STEPS_A_YEAR
    rows = posterior.rows(np.array([now]), season=False)
    slope = np.zeros(rows.shape[2])
    own = posterior.design.slopes(now)
    slope[: own.size] = own
    level, level_std = posterior.of(rows)
    rate, rate_std = posterior.of(np.broadcast_to(slope, rows.shape))
    both = posterior.unit**2 * np.einsum("qi,qij,j->q", rows[:, 0], posterior.covariance, slope)
    sign = 1.0 if falls else -1.0
    room = sign * (level[:, 0] - limit)
    sloped = sign * rate[:, 0]
    total_std = np.hypot(level_std[:, 0], systematic_std)
    probability = _passed(posterior.share, room, total_std, sloped, rate_std[:, 0], both, ahead)
    return Crossing(limit, falls, now + ahead, np.maximum.accumulate(probability))


def _passed(
    share: Floats, room: Floats, room_std: Floats, rate: Floats, rate_std: Floats, both: Floats,
    ahead: Floats,
) -> Floats:  # fmt: skip
    """That a line from `room` has been below 0 by the times `ahead`, (n,).

    A line is below 0 between two times only if it is at one of them. The room is integrated on
    Gauss's points, given it the rate is normal.
    """
    at = room[:, None] + room_std[:, None] * _POINTS
    slope = both / np.maximum(room_std, 1e-300) ** 2
    mean = rate[:, None] + slope[:, None] * (at - room[:, None])
    left = np.sqrt(np.maximum(rate_std**2 - slope * both, 1e-30))[:, None]
    chance = share[:, None] * _WEIGHTS / _WEIGHTS.sum()
    passed = np.empty(ahead.size)
    for place, time in enumerate(ahead):
        later = ndtr((-at / max(time, 1e-9) - mean) / left)
        passed[place] = float((chance * np.where(at < 0, 1.0, later)).sum())
    return passed
