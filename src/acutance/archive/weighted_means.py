"""Means of measurements that disagree: random effects, and what all share.

A measurement is the mean, what it differs from it by (the scatter), its stated error, and what all
measurements of its group share (one sensor and method), which does not average out. The scatter
is estimated by the method of Paule and Mandel, its interval by the profile of Cochran's Q. The
interval of the mean is that of Hartung and Knapp (Student's t of the residuals) with two changes:
weights belong to a scatter in the upper part of its interval, because weights that are too unequal
make intervals too short; and the interval is never less than stated deviations a quarter too large
would allow, because few measurements also agree by chance.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtri, ndtr, stdtr, stdtrit

from acutance.arguments import require_all, require_floats, require_numbers
from acutance.curves import Estimate
from acutance.curves.estimate import normal_quantile
from acutance.curves.grid import Floats
from acutance.errors import OptionError

__all__ = ["TRUSTED", "WeightedMean", "student_std", "weighted_mean"]

_LEVEL: Final = 0.95
_WEIGHT_LEVEL: Final = 0.25
"""Weights are those of the scatter at which Q has this probability of being less: coverage of 93
to 97 % for 2 to 40 measurements of unequal deviations (benchmarks/trends.py), .91 with that of
Paule and Mandel."""
TRUSTED: Final = 0.8
"""Stated deviations are taken to be no more than a quarter too large."""
_MOST_STEPS: Final = 100
_CLOSE: Final = 1e-13
_STEPS: Final = 2000
"""Places of equal probability, by which a mean over a density is taken."""


@dataclass(frozen=True)
class WeightedMean:
    """The mean of measurements that disagree.

    Attributes
    ----------
    mean : Estimate
        Its 95 % interval is that of the method; of few measurements its tails are longer than
        those of a normal density.
    scatter : Estimate
        Between the measurements, beyond their stated deviations.
    scatter_interval : (float, float)
        95 % interval of the scatter.
    systematic_std : float
        Part of the deviation of the mean that measurements share.
    count : int
    """

    mean: Estimate
    scatter: Estimate
    scatter_interval: tuple[float, float]
    systematic_std: float
    count: int

    def probability_below(self, limit: float) -> float:
        """How probable it is that the mean is below `limit`; ``nan`` of one measurement.

        Raises
        ------
        OptionError
            If it is no number.
        """
        require_numbers(limit=limit)
        if self.count < 2 or not self.mean.std > 0:
            return float("nan")
        away, degrees = limit - self.mean.value, self.count - 1
        square = self.mean.std**2 - self.systematic_std**2
        own = student_std(float(np.sqrt(max(square, 0.0))), degrees)
        if not self.systematic_std > 0:
            return float(stdtr(degrees, away / own))
        # Few measurements leave the scatter uncertain, not what they share: the sum of both is
        # less long-tailed than Student's t of all of it.
        scattered = own * _student_steps(degrees)
        return float(ndtr((away - scattered) / self.systematic_std).mean())

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        low, high = self.scatter_interval
        return {
            "mean": self.mean.to_dict(),
            "scatter": self.scatter.to_dict(),
            "scatter_interval": [low, high if np.isfinite(high) else None],
            "systematic_std": self.systematic_std,
            "count": self.count,
        }


@cache
def _student_steps(degrees: int) -> Floats:
    """Quantiles of Student's t in the middle of equal steps of probability."""
    return np.asarray(stdtrit(degrees, (np.arange(_STEPS) + 0.5) / _STEPS))


def student_std(std: float, degrees: float) -> float:
    """The deviation of Student's t whose 95 % interval is that of a normal density of `std`."""
    return std * normal_quantile(_LEVEL) / float(stdtrit(degrees, 0.5 + _LEVEL / 2))


def weighted_mean(
    value: ArrayLike,
    std: ArrayLike,
    *,
    systematic_std: ArrayLike = 0.0,
    group: Sequence[Hashable] | None = None,
    lowest: float | None = None,
) -> WeightedMean:
    """The mean of n measurements, with the scatter between them as a component of its own.

    Parameters
    ----------
    value : (n,) array
    std : (n,) array
        Random parts of the stated standard deviations; ``nan`` where none was stated: the median
        of the others stands in, and without any the scatter alone decides.
    systematic_std : float or (n,) array, optional
        Part that the measurements of a group share.
    group : sequence of n, optional
        What shares a systematic part, such as (sensor, method); all do without it.
    lowest : float, optional
        What the quantity cannot fall below.

    Returns
    -------
    WeightedMean
        Of one measurement its own value and deviation, and nothing about the scatter.

    Raises
    ------
    OptionError
        If there are none, a value is not finite, or there are others of deviations or groups.
    """
    values = np.atleast_1d(require_floats("value", value))
    stds = _as_many("std", std, values)
    if values.size == 0 or not np.isfinite(values).all():
        raise OptionError(
            f"{values.size} measurements, {int((~np.isfinite(values)).sum())} of them without a "
            "value: give at least one, and finite values"
        )
    variance = _stated(stds)
    shared = np.nan_to_num(_as_many("systematic_std", systematic_std, values))
    labels = [0] * values.size if group is None else list(require_all(Hashable, "group", group))
    if len(labels) != values.size:
        raise OptionError(f"{len(labels)} groups of {values.size} measurements: give one of each")
    if values.size == 1:
        own = float(np.sqrt(variance[0])) if np.isfinite(stds[0]) else np.nan
        mean = Estimate(float(values[0]), float(np.hypot(own, shared[0])), lowest)
        return WeightedMean(mean, Estimate(np.nan, np.nan), (0.0, np.inf), float(shared[0]), 1)
    degrees = values.size - 1
    weight = _weights(values, variance)
    middle = float(weight @ values)
    spread = float(weight @ (values - middle) ** 2) / degrees
    half = float(stdtrit(degrees, 0.5 + _LEVEL / 2)) * np.sqrt(spread) / normal_quantile(_LEVEL)
    floor = TRUSTED / np.sqrt((1 / variance).sum()) if variance.min() > 0 else 0.0
    systematic = _shared_std(weight, shared, labels)
    own = max(half, floor) or np.nan
    mean = Estimate(middle, float(np.hypot(own, systematic)), lowest)
    low, high = (float(np.sqrt(_scatter(values, variance, float(chdtri(degrees, beyond)))))
                 for beyond in (0.5 - _LEVEL / 2, 0.5 + _LEVEL / 2))  # fmt: skip
    if high == 0:
        # They agree better than they state: less than what they state cannot be excluded.
        high = float(np.sqrt(np.median(variance)))
    best = float(np.sqrt(_scatter(values, variance, float(degrees))))
    width = (high - low) / (2 * normal_quantile(_LEVEL))
    return WeightedMean(mean, Estimate(best, width, 0.0), (low, high), systematic, values.size)


def _weights(value: Floats, variance: Floats) -> Floats:
    """Shares of the measurements in the mean."""
    target = float(chdtri(value.size - 1, 1 - _WEIGHT_LEVEL))
    total = variance + _scatter(value, variance, target)
    weight = 1 / np.maximum(total, 1e-12 * total.max()) if total.max() > 0 else np.ones_like(total)
    return np.asarray(weight / weight.sum())


def _stated(std: Floats) -> Floats:
    """Variances; where none is stated the median of the others."""
    known = std[np.isfinite(std)]
    missing = float(np.median(known)) if known.size else 0.0
    return np.asarray(np.where(np.isfinite(std), std, missing) ** 2)


def _cochran(value: Floats, variance: Floats) -> float:
    """Weighted sum of squares about the weighted mean."""
    weight = 1 / variance
    mean = float(weight @ value) / weight.sum()
    return float(weight @ (value - mean) ** 2)


def _scatter(value: Floats, variance: Floats, target: float) -> float:
    """The variance between measurements at which Cochran's Q is `target`; 0 if it is below."""
    high = float(((value - value.mean()) ** 2).sum()) / target
    floor = 1e-12 * max(high, float(variance.max()))
    if high == 0 or _cochran(value, variance + floor) <= target:
        return 0.0
    low, found, high = floor, high, np.inf
    # One over Q is nearly a line: Newton's steps on it, and a halving where one would leave what
    # is known to hold the solution.
    for _ in range(_MOST_STEPS):
        weight = 1 / (variance + found)
        square = (value - float(weight @ value) / weight.sum()) ** 2
        cochran = float(weight @ square)
        low, high = (found, high) if cochran > target else (low, found)
        new = found + (cochran / target - 1) * cochran / float(weight**2 @ square)
        if not low <= new <= high:
            new = 2 * found if np.isinf(high) else 0.5 * (low + high)
        is_close = abs(new - found) <= _CLOSE * new
        found = new
        if is_close:
            break
    return found


def _as_many(name: str, numbers: ArrayLike, values: Floats) -> Floats:
    """Numbers that belong to values, one of each or one of all."""
    found = require_floats(name, numbers)
    if values.ndim != 1 or found.shape not in ((), (1,), values.shape):
        raise OptionError(
            f"{name} has the shape {found.shape}, the values {values.shape}: give a list of values "
            "and as many deviations, or one"
        )
    return np.broadcast_to(found, values.shape)


def _shared_std(weight: Floats, shared: Floats, labels: Sequence[Hashable]) -> float:
    """Deviation of the mean by what groups share: fully within a group, independent between."""
    sums: dict[Hashable, float] = {}
    for one, std, label in zip(weight.tolist(), shared.tolist(), labels, strict=True):
        sums[label] = sums.get(label, 0.0) + one * std
    return float(np.sqrt(sum(total**2 for total in sums.values())))
