"""Triangular factors of matrices whose rows reach three places: those of cubic splines."""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = [
    "banded_back_substitution",
    "banded_factor",
    "banded_substitution",
    "between_banded_factors",
]

_REACH: Final = 4
_LEAST: Final = 1e-12
"""Of the mean of the diagonal, added to it: fewer pixels than columns do not tell all of these."""


@compiled
def banded_factor(matrix: Floats) -> Floats:
    """Lower factor L of a matrix (n, n), its bands alone: ``found[d, j]`` is ``L[j + d, j]``.

    The matrix need not be of full rank.
    """
    n = len(matrix)
    least, found = 0.0, np.zeros((_REACH, n))
    for j in range(n):
        least += _LEAST * matrix[j, j] / n
    for j in range(n):
        for e in range(min(_REACH, n - j)):
            left = matrix[j + e, j] + (least if e == 0 else 0.0)
            for d in range(1, min(_REACH - e, j + 1)):
                left -= found[d + e, j - d] * found[d, j - d]
            found[e, j] = np.sqrt(left) if e == 0 else left / found[0, j]
    return found


@compiled
def banded_substitution(factor: Floats, right: Floats) -> Floats:
    """``L^-1 @ right`` of the bands of L, (4, n), and some columns (n, m)."""
    found = right.copy()
    for j in range(len(found)):
        for d in range(1, min(_REACH, j + 1)):
            for k in range(found.shape[1]):
                found[j, k] -= factor[d, j - d] * found[j - d, k]
        for k in range(found.shape[1]):
            found[j, k] /= factor[0, j]
    return found


@compiled
def banded_back_substitution(factor: Floats, right: Floats) -> Floats:
    """``L^-T @ right`` of the bands of L, (4, n), and one column (n,)."""
    found, n = right.copy(), right.size
    for j in range(n - 1, -1, -1):
        for d in range(1, min(_REACH, n - j)):
            found[j] -= factor[d, j] * found[j + d]
        found[j] /= factor[0, j]
    return found


@compiled
def between_banded_factors(factor: Floats, middle: Floats) -> Floats:
    """``L.T @ middle @ L`` of the bands of L, (4, n), and a matrix (n, n)."""
    n = len(middle)
    half, found = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for d in range(_REACH):
            for j in range(n - d):
                half[i, j] += middle[i, j + d] * factor[d, j]
    for i in range(n):
        for d in range(min(_REACH, n - i)):
            for j in range(n):
                found[i, j] += factor[d, i] * half[i + d, j]
    return found
