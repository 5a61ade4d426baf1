"""Normal equations of an ESF spline: all that the pixels say, in one small banded matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.fit.spline import CELLS, edge_weights

__all__ = ["Normal", "accumulate"]


@dataclass(frozen=True, eq=False)
class Normal:
    """Weighted sums over the pixels; m = CELLS + 3 ESF coefficients, q further columns.

    Attributes
    ----------
    gram : (m, m) array
        Sum of w B B^T over the cubic B-splines every pixel meets.
    cross, extra : (m, q) and (q, q) arrays
        Sums of w B x^T and w x x^T for the further columns x.
    spline_data, extra_data : (m,) and (q,) arrays
        Sums of w B y and w x y.
    data : float
        Sum of w y^2.
    count : int
        Number of pixels.
    """

    gram: Floats
    cross: Floats
    extra: Floats
    spline_data: Floats
    extra_data: Floats
    data: float
    count: int


def accumulate(u: Floats, y: Floats, weight: Floats, columns: Floats) -> Normal:
    """Sum the pixels into the normal equations of ``y = ESF(u) + columns^T a``.

    Parameters
    ----------
    u, y, weight : (n,) arrays
        Normal distance in widths, value, and inverse variance (any common scale) of the pixels.
    columns : (q, n) array
        Further regressors, one row each.
    """
    cell, basis = edge_weights(u)
    weighted = basis * weight
    size = CELLS + 3
    gram = np.zeros((size, size))
    spline_data = np.zeros(size)
    cross = np.zeros((size, columns.shape[0]))
    flat = gram.reshape(-1)
    for a in range(4):
        here = slice(a, a + CELLS)
        spline_data[here] += np.bincount(cell, weighted[a] * y, CELLS)
        for j, column in enumerate(columns):
            cross[here, j] += np.bincount(cell, weighted[a] * column, CELLS)
        for b in range(a, 4):
            # Entries (cell + a, cell + b) lie on one diagonal: a strided slice of the flat matrix.
            start = a * size + b
            flat[start : start + CELLS * (size + 1) : size + 1][:CELLS] += np.bincount(
                cell, weighted[a] * basis[b], CELLS
            )
    upper = np.triu(gram, 1)
    weighted_columns = columns * weight
    return Normal(
        gram=gram + upper.T,
        cross=cross,
        extra=weighted_columns @ columns.T,
        spline_data=spline_data,
        extra_data=weighted_columns @ y,
        data=float(np.dot(weight * y, y)),
        count=y.size,
    )
