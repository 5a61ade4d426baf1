"""Noise of pixels: its level on either side of an edge, its outliers, its correlation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = [
    "ALL_DIRECTIONS",
    "Correlation",
    "correlation",
    "median",
    "outlier_share",
    "outlier_weights",
    "robust_scale",
    "side_variances",
]

_MIN_DOWNWEIGHTED = 3.0
_MAX_GAUSSIAN = 4.5
_LAGS = 2
# Lags as rows down and columns to the right; the opposite ones have the same correlation.
_NEAREST = ((0, 1), (1, 0))
_FURTHER = ((1, 1), (1, -1), (0, 2), (2, 0))
_MIN_PAIRS = 20
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
    sides = (residual[esf < 0.05], residual[esf > 0.95])
    dark, bright = (
        _variance(side) if side.size >= _MIN_PAIRS else _variance(residual) for side in sides
    )
    return dark, bright


def _variance(residual: Floats) -> float:
    """Variance, without values that Gaussian noise does not reach."""
    power = (residual - np.add.reduce(residual) / residual.size) ** 2
    variance = float(np.add.reduce(power)) / residual.size
    if float(power.max()) < 16 * variance:
        return variance
    centred = residual - median(residual)
    usual = residual[np.abs(centred) <= _MAX_GAUSSIAN * robust_scale(centred)]
    return float(np.var(usual)) if usual.size else variance


def robust_scale(residual: Floats) -> float:
    """Standard deviation of the bulk of the residuals, by their median modulus."""
    return 1.4826 * median(np.abs(residual))


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
    return float(np.mean(np.abs(residual) > _OUTLYING * noise))


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
    """

    inflation: float
    strongest: float
    significance: float

    @property
    def significant(self) -> float:
        """Modulus of the strongest correlation, 0 where chance explains it: checks use it."""
        return abs(self.strongest) if self.significance >= _SIGNIFICANT else 0.0


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
    height, width = int(rows.max()) + 1, int(cols.max()) + 1
    field = np.zeros((height + _LAGS, width + 2 * _LAGS))
    known = np.zeros_like(field)
    place = rows * field.shape[1] + cols + _LAGS
    field.reshape(-1)[place] = residual
    known.reshape(-1)[place] = 1.0
    power = float(residual @ residual) / residual.size
    nearest = [_lagged(field, known, lag) for lag in _NEAREST]
    strongest, significance = 0.0, 0.0
    for covariance, pairs in nearest:
        rho = covariance / power
        if pairs >= _MIN_PAIRS and abs(rho) * math.sqrt(pairs) > significance:
            strongest, significance = rho, abs(rho) * math.sqrt(pairs)
    if significance < _SIGNIFICANT:
        return Correlation(1.0, strongest, significance)
    spectra = np.ones((len(directions), _FREQ_CPP.size))
    further = [_lagged(field, known, lag) for lag in _FURTHER]
    for (down, right), (covariance, pairs) in zip(
        _NEAREST + _FURTHER, nearest + further, strict=True
    ):
        if pairs >= _MIN_PAIRS:
            for spectrum, (x, y) in zip(spectra, directions, strict=True):
                along_px = right * x + down * y
                spectrum += 2 * covariance / power * np.cos(2 * np.pi * _FREQ_CPP * along_px)
    return Correlation(max(float(spectra.max()), 1.0), strongest, significance)


def _lagged(field: Floats, known: Floats, lag: tuple[int, int]) -> tuple[float, float]:
    """Mean product of the pixels a lag apart, and how many pairs there are."""
    down, right = lag
    height, width = field.shape[0] - _LAGS, field.shape[1] - 2 * _LAGS
    here = (slice(0, height), slice(_LAGS, _LAGS + width))
    there = (slice(down, down + height), slice(_LAGS + right, _LAGS + right + width))
    pairs = float(np.vdot(known[here], known[there]))
    return float(np.vdot(field[here], field[there])) / max(pairs, 1.0), pairs
