"""Noise of pixels: its level on either side of an edge, its outliers, its correlation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.scalar_product import scalar_product

__all__ = [
    "ALL_DIRECTIONS",
    "Correlation",
    "correlation",
    "median",
    "outlier_share",
    "outlier_weights",
    "robust_scale",
    "rounding_std",
    "side_variances",
    "smallest_step",
    "variance_between",
]

_MIN_DOWNWEIGHTED = 3.0
_MAX_GAUSSIAN = 4.5
_LAGS = 2
# Lags as rows down and columns to the right; the opposite ones have the same correlation.
_NEAREST = ((0, 1), (1, 0))
_FURTHER = ((1, 1), (1, -1), (0, 2), (2, 0))
_ALL_LAGS: NDArray[np.intp] = np.array(_NEAREST + _FURTHER)
_MIN_PAIRS = 20
_MANY = 2**16
"""So many of an image's numbers have two that differ by one step."""
_FREQ_CPP: Floats = np.linspace(0.0, 0.5, 11)
_SIGNIFICANT = 4.0
_OUTLYING = 4.5

ALL_DIRECTIONS = (
    (1.0, 0.0),
    (math.sqrt(0.5), math.sqrt(0.5)),
    (0.0, 1.0),
    (-math.sqrt(0.5), math.sqrt(0.5)),
)
"""Unit vectors (x, y) of the directions in which a two-dimensional target is judged."""


def side_variances(residual: Floats, esf: Floats) -> tuple[float, float]:
    """Noise variance on the dark and on the bright side, each about its own level.

    Parameters
    ----------
    residual, esf : (n,) arrays
        Residuals of a fit, and the fitted edge response (0 dark .. 1 bright), of the same pixels.
    """
    dark = variance_between(residual, esf, -math.inf, 0.05)
    return dark, variance_between(residual, esf, 0.95, math.inf)


def variance_between(residual: Floats, esf: Floats, low: float, high: float) -> float:
    """Variance of residuals of pixels whose fitted response lies between two, (n,) each.

    Without values that Gaussian noise does not reach; of all pixels, where those are few.
    """
    count, variance, largest = _scatter(residual, esf, low, high)
    if count < _MIN_PAIRS:
        low, high = -math.inf, math.inf
        _, variance, largest = _scatter(residual, esf, low, high)
    if largest < 16 * variance:
        return variance
    own = residual[(esf > low) & (esf < high)]
    centred = own - median(own)
    usual = own[np.abs(centred) <= _MAX_GAUSSIAN * robust_scale(centred)]
    return float(np.var(usual)) if usual.size else variance


@compiled
def _scatter(residual: Floats, esf: Floats, low: float, high: float) -> tuple[int, float, float]:
    """How many pixels have a response between two, their variance and largest square about it."""
    count, total = 0, 0.0
    for k in range(esf.size):
        there = low < esf[k] < high
        count += there
        total += residual[k] if there else 0.0
    mean, power, largest = total / count, 0.0, 0.0
    for k in range(esf.size):
        off = residual[k] - mean if low < esf[k] < high else 0.0
        power += off * off
        largest = max(largest, off * off)
    return count, power / count, largest


def robust_scale(residual: Floats) -> float:
    """Standard deviation of the bulk of the residuals, by their median modulus."""
    return 1.4826 * median(np.abs(residual))


def smallest_step(value: Floats) -> float:
    """The step of an image's numbers: the smallest difference between two of them; 0 of one."""
    ordered = np.sort(value)
    steps = ordered[1:] - ordered[:-1]
    steps = steps[steps > 0]
    return float(steps.min()) if steps.size else 0.0


def rounding_std(value: Floats) -> float:
    """Standard deviation that rounding to the step of an image's numbers adds to noise."""
    some = value[:: max(value.size // _MANY, 1)]
    return smallest_step(some) / math.sqrt(12)


def median(values: Floats) -> float:
    """The middle one of some values, the upper of two: faster than `numpy.median`."""
    middle = values.size // 2
    return float(np.partition(values, middle)[middle])


def outlier_weights(standard: Floats) -> Floats:
    """Weights that take outliers out: 1 within 3 standard deviations, then falling.

    They fall with the fourth power, so that the weighted square of an outlier vanishes as the
    outlier grows. Gaussian noise hardly ever exceeds 3 standard deviations and keeps its weight.

    Parameters
    ----------
    standard : (n,) array
        Residuals in units of their standard deviation.
    """
    return np.asarray((_MIN_DOWNWEIGHTED / np.maximum(np.abs(standard), _MIN_DOWNWEIGHTED)) ** 4)


def outlier_share(residual: Floats, noise: float, floor: float = 0.0) -> float:
    """Share of some residuals, (n,), beyond 4.5 standard deviations of the noise.

    Parameters
    ----------
    residual : (n,) array
    noise : float
        Standard deviation of the noise.
    floor : float, optional
        Noise below which residuals are the arithmetic's or the model's own, and no outliers.
    """
    if not noise > floor or residual.size == 0:
        return 0.0
    return _count_beyond(residual, _OUTLYING * noise) / residual.size


@compiled
def _count_beyond(residual: Floats, bound: float) -> int:
    count = 0
    for one in residual:
        count += abs(one) > bound
    return count


@dataclass(frozen=True)
class Correlation:
    """Correlation of the noise between neighbouring pixels.

    Attributes
    ----------
    inflation : float
        Largest ratio of the noise power along some directions, 0..Nyquist, to white noise of the
        same variance (1 when the noise is white).
    strongest : float
        The strongest correlation found among the direct neighbours.
    significance : float
        That correlation in units of the standard deviation which white noise has.
    by_lag : tuple of float
        Correlation of pixels one and two apart, in all directions; empty where noise is white.
    """

    inflation: float
    strongest: float
    significance: float
    by_lag: tuple[float, ...] = ()

    @property
    def significant(self) -> float:
        """Modulus of the strongest correlation, 0 where chance explains it: checks use it."""
        return abs(self.strongest) if self.significance >= _SIGNIFICANT else 0.0

    @property
    def pixels_as_one(self) -> float:
        """So many pixels tell as much of the noise's variance as one would of white noise."""
        return 1 + 2 * sum(one**2 for one in self.by_lag)

    def seen_by(self, template: Floats, rows: NDArray[np.intp], cols: NDArray[np.intp]) -> float:
        """Variance of the noise's product with a template over that of white noise, at least 1.

        Parameters
        ----------
        template : (n,) array
        rows, cols : (n,) int arrays
            Its pixels, from 0.
        """
        if not self.by_lag:
            return 1.0
        products, _ = _lagged_products(np.ascontiguousarray(template), rows, cols, _ALL_LAGS)
        return max(1 + 2 * float(products @ self.by_lag) / float(template @ template), 1.0)


def correlation(
    residual: Floats,
    rows: NDArray[np.intp],
    cols: NDArray[np.intp],
    directions: Sequence[tuple[float, float]] = ALL_DIRECTIONS,
) -> Correlation:
    """Noise correlation from the residuals of a fit.

    Parameters
    ----------
    residual : (n,) array
        Residuals in units of their standard deviation, outliers bounded.
    rows, cols : (n,) int arrays
        Their pixels.
    directions : sequence of (float, float), optional
        Unit vectors (x, y) along which the power is taken: the normal of a straight target; of
        others the largest of several directions counts.
    """
    sums, pairs = _lagged_products(
        np.ascontiguousarray(residual, float),
        np.ascontiguousarray(rows, np.intp),
        np.ascontiguousarray(cols, np.intp),
        _ALL_LAGS,
    )
    power = float(residual @ residual) / residual.size
    rho = sums / (np.maximum(pairs, 1.0) * power)
    strongest, significance = 0.0, 0.0
    for k, _ in enumerate(_NEAREST):
        likely = abs(float(rho[k])) * math.sqrt(pairs[k])
        if pairs[k] >= _MIN_PAIRS and likely > significance:
            strongest, significance = float(rho[k]), likely
    if significance < _SIGNIFICANT:
        return Correlation(1.0, strongest, significance)
    known = pairs >= _MIN_PAIRS
    down, right = _ALL_LAGS[known].T
    x, y = np.array(directions).T[:, :, None]
    along_px = right * x + down * y
    waves = np.cos(2 * np.pi * _FREQ_CPP[:, None] * along_px[:, None])
    inflation = max(float((1 + 2 * waves @ rho[known]).max()), 1.0)
    return Correlation(inflation, strongest, significance, tuple(np.where(known, rho, 0).tolist()))


@compiled
def _lagged_products(
    residual: Floats, rows: NDArray[np.intp], cols: NDArray[np.intp], lags: NDArray[np.intp]
) -> tuple[Floats, Floats]:
    """Sum of the products of the pixels a lag apart, and how many pairs there are, (lags,) each."""
    height, width = 0, 0
    for k in range(rows.size):
        height, width = max(height, rows[k] + 1), max(width, cols[k] + 1)
    # Behind every row and below the last one unknown pixels: no lag leads to another known one.
    stride = width + _LAGS
    field, known = np.zeros((height + _LAGS) * stride), np.zeros((height + _LAGS) * stride)
    for k in range(rows.size):
        field[rows[k] * stride + cols[k]] = residual[k]
        known[rows[k] * stride + cols[k]] = 1.0
    sums, pairs = np.empty(len(lags)), np.empty(len(lags))
    for k in range(len(lags)):
        shift = lags[k, 0] * stride + lags[k, 1]
        sums[k] = scalar_product(field[:-shift], field[shift:])
        pairs[k] = scalar_product(known[:-shift], known[shift:])
    return sums, pairs
