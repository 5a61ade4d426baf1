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
    beside = np.vstack([y, columns])
    for i, (cell, basis) in enumerate(stencils):
        # Sorted by their place, the pixels of a cell are neighbours: one sweep sums a product.
        order = np.argsort(cell.astype(np.int16), kind="stable")
        places = cell[order]
        factors = np.vstack([basis, beside]).take(order, axis=1)
        weighted = factors[:4] * weight[order]
        starts = _first_of_each(places)
        for a in range(4):
            sums = np.zeros((factors.shape[0] - a, CELLS))
            sums[:, places[starts]] = np.add.reduceat(weighted[a] * factors[a:], starts, axis=1)
            _add_own(gram, a, sums[: 4 - a])
            projection[a : a + CELLS] += sums[4 - a]
            gram[a : a + CELLS, m:] += sums[5 - a :].T
        for other, other_basis in stencils[i + 1 :]:
            _add_pair(gram, cell, basis * weight, other, other_basis)
    gram += gram.T
    weighted_columns = columns * weight
    gram[m:, m:] = weighted_columns @ columns.T
    projection[m:] = weighted_columns @ y
    return Normal(gram, projection, float(np.dot(weight * y, y)), count)


def _first_of_each(place: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where in sorted places each of them comes first."""
    starts = np.empty(place.size, bool)
    starts[0] = True
    np.not_equal(place[1:], place[:-1], out=starts[1:])
    return starts.nonzero()[0]


def _add_own(gram: Floats, a: int, sums: Floats) -> None:
    """Products of one step's spline with itself: the upper triangle, and half the diagonal."""
    # Entries (cell + a, cell + b) lie on one diagonal: a strided slice of the flat matrix.
    size = gram.shape[0]
    flat, stride = gram.reshape(-1), size + 1
    for b, products in enumerate(sums, start=a):
        start = a * size + b
        diagonal = flat[start : start + CELLS * stride : stride]
        diagonal += products if a < b else 0.5 * products


def _add_pair(
    gram: Floats, cell: NDArray[np.intp], weighted: Floats, other: NDArray[np.intp], basis: Floats
) -> None:
    """Products of two steps' splines, one way: its transpose is the other."""
    m = CELLS + 3
    offsets = (np.arange(4)[:, None] * m + np.arange(4)).reshape(16, 1)
    place = cell * m + other
    order = np.argsort(place.astype(np.int16), kind="stable")
    place = place[order]
    starts = _first_of_each(place)
    products = weighted.take(order, axis=1)[:, None] * basis.take(order, axis=1)
    sums = np.add.reduceat(products.reshape(16, -1), starts, axis=1)
    found = np.bincount((place[starts] + offsets).reshape(-1), sums.reshape(-1), m * m)
    gram[:m, :m] += found.reshape(m, m)
