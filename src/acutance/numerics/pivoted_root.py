"""A factor of a matrix that is hardly of full rank, by Cholesky's method with pivots."""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["covariance_root", "least_squares", "pivoted_root"]

_NEGLIGIBLE: Final = 1e-15
"""Share of a variance that rounding leaves."""


@compiled
def pivoted_root(matrix: Floats, least: float) -> Floats:
    """A factor (n, k) of a positive semidefinite matrix (n, n), the largest columns first.

    No diagonal element of what ``root @ root.T`` lacks of the matrix exceeds `least`. An
    eigendecomposition would need some columns less, and ten times as long.
    """
    n = len(matrix)
    columns, left = np.zeros((n, n)), np.diag(matrix).copy()
    rank, is_taken = 0, np.zeros(n, np.bool_)
    while rank < n:
        place = int(np.argmax(left))
        if not left[place] > least:
            break
        own = columns[rank]
        for k in range(n):
            own[k] = matrix[place, k]
        for j in range(rank):
            factor = columns[j, place]
            for k in range(n):
                own[k] -= factor * columns[j, k]
        scale = 1 / np.sqrt(left[place])
        for k in range(n):
            own[k] = 0.0 if is_taken[k] else own[k] * scale
            left[k] -= own[k] * own[k]
        own[place], left[place], is_taken[place] = 1 / scale, -np.inf, True
        rank += 1
    return columns[:rank].T.copy()


def covariance_root(covariance: Floats) -> Floats:
    """A factor (n, k) of a covariance, as good for small standard deviations as for large ones."""
    std = np.sqrt(np.maximum(np.diagonal(covariance), np.finfo(float).tiny))
    return std[:, None] * pivoted_root(covariance / std / std[:, None], _NEGLIGIBLE)


def least_squares(root: Floats, values: Floats) -> Floats:
    """The solution (k,) of ``root @ y = values`` that leaves least of the values, (n,)."""
    return np.asarray(np.linalg.solve(root.T @ root, root.T @ values))
