"""Smooth functions as polynomials, for compiled loops.

The functions of the C library take one number after another. A polynomial has no branches: of a
loop over pixels the compiler lets the processor compute four or eight pixels at once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from acutance.curves.grid import Floats
from acutance.numerics.compiled import inlined

__all__ = ["interpolated", "polynomial_value"]


def interpolated(
    function: Callable[[Floats], Floats], low: float, high: float, degree: int
) -> Floats:
    """Coefficients, the constant's first, of a polynomial next to a function between two places.

    It is equal to it at the Chebyshev nodes, and nearly as close everywhere as any polynomial.
    """
    series = Chebyshev.interpolate(function, degree, [low, high])
    return np.ascontiguousarray(series.convert(kind=Polynomial).coef, float)


@inlined
def polynomial_value(coefficients: Floats, x: float) -> float:
    """Value of a polynomial at one place, by Horner's rule."""
    value: float = coefficients[-1]
    for k in range(coefficients.size - 2, -1, -1):
        value = value * x + coefficients[k]
    return value
