"""Cubic smoothing spline in the terms of MATLAB's ``csaps``, on a regular fine grid of knots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["SmoothingSpline", "fit_smoothing_spline"]

# Products of the second derivatives of the four cubic B-splines of one cell, integrated.
_BEND = np.array([[1.0, -1.0], [-2.0, 3.0], [1.0, -3.0], [0.0, 1.0]])
_BEND_PRODUCTS: Floats = _BEND @ np.array([[1.0, 1 / 2], [1 / 2, 1 / 3]]) @ _BEND.T


def _basis(t: Floats, order: int) -> Floats:
    """The four cubic B-splines at the fraction t (n,) of a cell, or a derivative, (4, n)."""
    one = np.ones_like(t)
    if order == 0:
        inner = (3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1)
        return np.stack(((1 - t) ** 3, *inner, t**3)) / 6
    if order == 1:
        inner = (3 * t**2 - 4 * t, -3 * t**2 + 2 * t + 1)
        return np.stack((-((1 - t) ** 2), *inner, t**2)) / 2
    if order == 2:
        return np.stack((1 - t, 3 * t - 2, 1 - 3 * t, t))
    return np.stack((-one, 3 * one, -3 * one, one))


@dataclass(frozen=True, eq=False)
class SmoothingSpline:
    """A cubic spline with regular knots.

    Parameters
    ----------
    start, step : float
        First knot and distance between knots.
    coefficient : (cells + 3,) array
    """

    start: float
    step: float
    coefficient: Floats

    def __call__(self, x: Floats, derivative: int = 0) -> Floats:
        """Value, or a derivative up to the third, at `x` (n,) inside the knots."""
        cell, t = _cells(x, self.start, self.step, self.coefficient.size - 3)
        basis = _basis(t, derivative) / self.step**derivative
        return np.asarray(sum(basis[i] * self.coefficient[cell + i] for i in range(4)))


def _cells(x: Floats, start: float, step: float, count: int) -> tuple[NDArray[np.int64], Floats]:
    position = (x - start) / step
    cell = np.clip(np.floor(position), 0, count - 1).astype(np.int64)
    return cell, position - cell


def fit_smoothing_spline(
    x: Floats,
    y: Floats,
    weight: Floats,
    *,
    smoothness: float,
    start: float,
    stop: float,
    step: float = 0.05,
) -> SmoothingSpline:
    """Minimise ``p sum w (y - f(x))^2 + (1 - p) integral f''^2``.

    This is the definition of ``csaps`` (de Boor, A Practical Guide to Splines, chapter XIV).
    Knots every `step` instead of one at every abscissa change the curve by far less than its
    noise, allow repeated abscissae, and keep the system narrow.

    Parameters
    ----------
    x, y, weight : (n,) arrays
        Samples in any order, between `start` and `stop`.
    smoothness : float
        The p of csaps, 0 < p < 1; 1 would interpolate.
    start, stop, step : float, optional
        Range and spacing of the knots.
    """
    from scipy.linalg import solveh_banded

    count = max(round((stop - start) / step), 1)
    cell, t = _cells(x, start, step, count)
    basis = _basis(t, 0)
    bend = (1 - smoothness) / smoothness / step**3
    banded = np.zeros((4, count + 3))
    moment = np.zeros(count + 3)
    for i in range(4):
        moment[i : i + count] += np.bincount(cell, weight * y * basis[i], minlength=count)
        for j in range(i, 4):
            squares = np.bincount(cell, weight * basis[i] * basis[j], minlength=count)
            banded[j - i, i : i + count] += squares + bend * _BEND_PRODUCTS[i, j]
    return SmoothingSpline(start, step, solveh_banded(banded, moment, lower=True))
