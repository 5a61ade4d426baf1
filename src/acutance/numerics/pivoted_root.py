"""A factor of a matrix that is hardly of full rank, by Cholesky's method with pivots."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.linalg import get_lapack_funcs

from acutance.curves.grid import Floats

__all__ = ["covariance_root", "least_squares", "pivoted_root"]

_NEGLIGIBLE: Final = 1e-15
"""Share of a variance that rounding leaves."""
(_pstrf,) = get_lapack_funcs(("pstrf",), (np.empty((1, 1)),))


def pivoted_root(matrix: Floats, least: float) -> Floats:
    """A factor (n, k) of a positive semidefinite matrix (n, n), the largest columns first.

    No diagonal element of what ``root @ root.T`` lacks of the matrix exceeds `least`. An
    eigendecomposition would need some columns less, and ten times as long.
    """
    packed, place, rank, _ = _pstrf(matrix.T, tol=least, lower=1)
    root = np.zeros((matrix.shape[0], rank))
    root[place - 1] = np.tril(packed[:, :rank])
    return root


def covariance_root(covariance: Floats) -> Floats:
    """A factor (n, k) of a covariance, as good for small standard deviations as for large ones."""
    std = np.sqrt(np.maximum(np.diagonal(covariance), np.finfo(float).tiny))
    return std[:, None] * pivoted_root(covariance / std / std[:, None], _NEGLIGIBLE)


def least_squares(root: Floats, values: Floats) -> Floats:
    """The solution (k,) of ``root @ y = values`` that leaves least of the values, (n,)."""
    return np.asarray(np.linalg.solve(root.T @ root, root.T @ values))
