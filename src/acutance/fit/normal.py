"""Normal equations of an ESF spline: all that the pixels say, in one small matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.fit.spline import CELLS

__all__ = ["Normal", "Stencil", "accumulate"]

Stencil = tuple[NDArray[np.intp], Floats]


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
    stencils: Sequence[Stencil], y: Floats, weight: Floats, columns: Floats, count: float
) -> Normal:
    """Sum the pixels into the normal equations of ``y = sum of ESFs + columns^T a``.

    Parameters
    ----------
    stencils : sequence of ((n,) int, (4, n)) arrays
        For every step of the ground: each pixel's place in the ESF's spline, as
        `spline.edge_weights` gives it, the weights times the step's share.
    y, weight : (n,) arrays
        Value, and inverse variance (any common scale) of the pixels.
    columns : (q, n) array
        Further regressors, one row each.
    count : float
        Number of pixels; an outlier counts for less.
    """
    m, q = CELLS + 3, columns.shape[0]
    gram = np.zeros((m + q, m + q))
    projection = np.zeros(m + q)
    weighted_columns = columns * weight
    for i, (cell, basis) in enumerate(stencils):
        weighted = basis * weight
        _add_own(gram, cell, basis, weighted)
        for other, other_basis in stencils[i + 1 :]:
            _add_pair(gram, cell, weighted, other, other_basis)
        for a in range(4):
            here = slice(a, a + CELLS)
            projection[here] += np.bincount(cell, weighted[a] * y, CELLS)
            for j, column in enumerate(columns):
                gram[here, m + j] += np.bincount(cell, weighted[a] * column, CELLS)
    gram += gram.T
    gram[m:, m:] = weighted_columns @ columns.T
    projection[m:] = weighted_columns @ y
    return Normal(gram, projection, float(np.dot(weight * y, y)), count)


def _add_own(gram: Floats, cell: NDArray[np.intp], basis: Floats, weighted: Floats) -> None:
    """Products of one step's spline with itself: the upper triangle, and half the diagonal."""
    # Entries (cell + a, cell + b) lie on one diagonal: a strided slice of the flat matrix.
    size = gram.shape[0]
    flat, stride = gram.reshape(-1), size + 1
    for a in range(4):
        for b in range(a, 4):
            start = a * size + b
            diagonal = flat[start : start + CELLS * stride : stride]
            products = np.bincount(cell, weighted[a] * basis[b], CELLS)
            diagonal += products if a < b else 0.5 * products


def _add_pair(
    gram: Floats, cell: NDArray[np.intp], weighted: Floats, other: NDArray[np.intp], basis: Floats
) -> None:
    """Products of two steps' splines, one way: its transpose is the other."""
    m = CELLS + 3
    offsets = (np.arange(4)[:, None] * m + np.arange(4)).reshape(16, 1)
    place = cell * m + other + offsets
    shares = (weighted[:, None] * basis).reshape(16, -1)
    gram[:m, :m] += np.bincount(place.reshape(-1), shares.reshape(-1), m * m).reshape(m, m)
