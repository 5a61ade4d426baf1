"""Parts of a standard deviation, each known by so many degrees of freedom, joined into one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from scipy.special import ndtr, stdtr, stdtrit

from acutance.archive.weighted_means import WeightedMean, student_std
from acutance.curves import Estimate
from acutance.curves.estimate import normal_quantile

__all__ = ["LEVEL", "StdPart", "joined_std", "part_of_mean"]

LEVEL: Final = 0.95


@dataclass(frozen=True)
class StdPart:
    """A standard deviation that was estimated.

    Parameters
    ----------
    std : float
    degrees : float
        Of freedom; infinite where it was stated.
    """

    std: float
    degrees: float = math.inf

    def estimate(self, value: float) -> Estimate:
        """A value with the deviation that gives its 95 % interval, that of Student's t."""
        return Estimate(value, self.std * self._reach / normal_quantile(LEVEL))

    def probability_above(self, value: float) -> float:
        """How probable it is that a number measured as `value` is above 0."""
        if not self.std > 0:
            return math.nan
        ratio = value / self.std
        return float(ndtr(ratio) if math.isinf(self.degrees) else stdtr(self.degrees, ratio))

    @property
    def _reach(self) -> float:
        """Half the 95 % interval, in deviations."""
        if math.isinf(self.degrees):
            return normal_quantile(LEVEL)
        return float(stdtrit(self.degrees, 0.5 + LEVEL / 2))


def joined_std(*parts: StdPart) -> StdPart:
    """The deviation of a sum of independent parts, with the degrees of freedom of Satterthwaite."""
    variance = sum(part.std**2 for part in parts)
    doubt = sum(part.std**4 / part.degrees for part in parts)
    return StdPart(math.sqrt(variance), variance**2 / doubt if doubt > 0 else math.inf)


def part_of_mean(mean: WeightedMean) -> StdPart:
    """The deviation of a mean without what its measurements share."""
    own = math.sqrt(max(mean.mean.std**2 - mean.systematic_std**2, 0.0))
    if mean.count < 2 or math.isnan(own):
        return StdPart(mean.mean.std)
    return StdPart(student_std(own, mean.count - 1), mean.count - 1)
