"""Normal equations of an ESF spline: all that the pixels say, in one small matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.fit.spline import CELLS

__all__ = ["Normal", "accumulate"]


@dataclass(frozen=True, eq=False)
class Normal:
    """Weighted sums over the pixels: m = CELLS + 3 ESF coefficients, then q further columns.

    Attributes
    ----------
    gram : (m + q, m + q) array
        Sum of w a a^T, with a the row of the design every pixel makes.
    projection : (m + q,) array
        Sum of w a y.
    data : float
        Sum of w y^2.
    count : float
        Number of pixels.
    """

    gram: Floats
    projection: Floats
    data: float
    count: float

    def combined(self, directions: Floats) -> Normal:
        """The equations of r coefficients beta, where the m + q are ``directions @ beta``."""
        gram = directions.T @ self.gram @ directions
        return Normal(gram, directions.T @ self.projection, self.data, self.count)


def accumulate(
    cell: NDArray[np.intp], basis: Floats, y: Floats, weight: Floats, columns: Floats
) -> Normal:
    """Sum the pixels into the normal equations of ``y = ESF + columns^T a``.

    Parameters
    ----------
    cell, basis : (n,) int and (4, n) arrays
        Every pixel's place in the ESF's spline, as `spline.edge_weights` gives it.
    y, weight : (n,) arrays
        Value, and inverse variance (any common scale) of the pixels.
    columns : (q, n) array
        Further regressors, one row each.
    """
    m, q = CELLS + 3, columns.shape[0]
    gram = np.zeros((m + q, m + q))
    projection = np.zeros(m + q)
    weighted, weighted_columns = basis * weight, columns * weight
    # Entries (cell + a, cell + b) lie on one diagonal: a strided slice of the flat matrix.
    flat, stride = gram.reshape(-1), m + q + 1
    for a in range(4):
        here = slice(a, a + CELLS)
        projection[here] += np.bincount(cell, weighted[a] * y, CELLS)
        for j, column in enumerate(columns):
            gram[here, m + j] += np.bincount(cell, weighted[a] * column, CELLS)
        for b in range(a, 4):
            start = a * (m + q) + b
            diagonal = flat[start : start + CELLS * stride : stride]
            diagonal += np.bincount(cell, weighted[a] * basis[b], CELLS)
    gram[m:, m:] = np.triu(weighted_columns @ columns.T)
    gram += np.triu(gram, 1).T
    projection[m:] = weighted_columns @ y
    return Normal(gram, projection, float(np.dot(weight * y, y)), y.size)
