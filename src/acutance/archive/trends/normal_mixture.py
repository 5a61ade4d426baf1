"""Posteriors as mixtures of normal densities: quantiles, probabilities, the estimate that fits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import ndtr

from acutance.curves import Estimate
from acutance.curves.estimate import normal_quantile
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["NormalMixture"]

_REACH: Final = 12.0
_HALVINGS: Final = 60
_LEVEL: Final = 0.95


@dataclass(frozen=True, eq=False)
class NormalMixture(ShortRepr):
    """A density that is a sum of normal ones.

    Parameters
    ----------
    share : (q,) array
        Sums to 1.
    mean, std : (q,) array
    """

    share: Floats
    mean: Floats
    std: Floats

    def probability_below(self, limit: float) -> float:
        """How probable values below `limit` are."""
        with np.errstate(divide="ignore", invalid="ignore"):
            off = (limit - self.mean) / self.std
        step = np.where(self.mean < limit, np.inf, -np.inf)
        return float(self.share @ ndtr(np.where(self.std > 0, off, step)))

    def quantile(self, level: float) -> float:
        """The value below which the part `level` lies."""
        low = float((self.mean - _REACH * self.std).min())
        high = float((self.mean + _REACH * self.std).max())
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if self.probability_below(middle) < level:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def interval(self, level: float = _LEVEL) -> tuple[float, float]:
        """Ends between which the part `level` lies, as much below as above."""
        return self.quantile(0.5 - level / 2), self.quantile(0.5 + level / 2)

    def estimate(self, lowest: float | None = None) -> Estimate:
        """The middle of the 95 % interval, with the deviation that gives this interval.

        Tails of few measurements are longer than normal ones, so that this is more than the
        standard deviation of a normal density with the same middle part.

        Parameters
        ----------
        lowest : float, optional
            What the quantity cannot fall below. Where the middle lies beyond, what remains of the
            interval stands for it.
        """
        low, high = self.interval()
        if lowest is not None and low + high < 2 * lowest:
            low, high = lowest, max(high, lowest)
        half = 0.5 * (high - low)
        return Estimate(0.5 * (low + high), half / normal_quantile(_LEVEL), lowest)

    def wider(self, std: float) -> NormalMixture:
        """The same with an independent normal deviation added."""
        return NormalMixture(self.share, self.mean, np.hypot(self.std, std))

    def times(self, factor: float) -> NormalMixture:
        """The density of a multiple."""
        return NormalMixture(self.share, factor * self.mean, abs(factor) * self.std)
