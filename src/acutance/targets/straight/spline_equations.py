"""Sums of an edge's pixels into the normal equations of its edge spread function (ESF) spline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.spline import CELLS, edge_weights
from acutance.targets.straight.step_profile import Profile

__all__ = ["Stencil", "accumulate", "renewed", "step_stencils"]

Stencil = tuple[NDArray[np.intp], Floats]


def step_stencils(profile: Profile, s: Floats, width_px: float) -> list[Stencil]:
    """Each pixel's place in the spline of the ESF, for every step of a profile.

    Parameters
    ----------
    profile : Profile
    s : (n,) array
        Distances from the first step, px.
    width_px : float
        The unit of the spline.
    """
    found = []
    for distance, share in zip(profile.distances(s), profile.shares, strict=True):
        cell, basis = edge_weights(distance / width_px)
        found.append((cell, basis if share == 1 else share * basis))
    return found


def accumulate(
    stencils: Sequence[Stencil], y: Floats, weight: Floats, columns: Floats, count: float
) -> Normal:
    """Sum the pixels into the normal equations of ``y = sum of ESFs + columns^T a``.

    Parameters
    ----------
    stencils : sequence of ((n,) int, (4, n)) arrays
        For every step of the profile: each pixel's place in the ESF's spline, as
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
    for i, (cell, basis) in enumerate(stencils):
        weighted, rows = basis * weight, np.vstack([basis, y, columns])
        sums = _sums_by_cell(cell, weighted, np.ascontiguousarray(rows.T))
        for a in range(4):
            _add_own(gram, a, sums[:, a, a:4].T)
            projection[a : a + CELLS] += sums[:, a, 4]
            gram[a : a + CELLS, m:] += sums[:, a, 5:]
        for other, other_basis in stencils[i + 1 :]:
            _add_pair(gram, cell, weighted, other, other_basis)
    gram += gram.T
    products = rows[4:] * weight @ rows[4:].T
    gram[m:, m:], projection[m:] = products[1:, 1:], products[0, 1:]
    return Normal(gram, projection, products.item(0), count)


def renewed(
    normal: Normal,
    stencils: Sequence[Stencil],
    y: Floats,
    weight: Floats,
    columns: Floats,
    changed: int,
) -> Normal:
    """The equations of the same pixels after the last columns have changed.

    Parameters
    ----------
    normal : Normal
        As `accumulate` made it of these pixels and weights.
    stencils, y, weight
        As they were.
    columns : (q, n) array
    changed : int
        How many of the columns, from the last, are others than they were.
    """
    first = normal.projection.size - changed
    weighted = columns[-changed:] * weight
    rows = np.zeros((changed, normal.projection.size))
    for cell, basis in stencils:
        sums = _sums_by_cell(cell, basis, np.ascontiguousarray(weighted.T))
        for a in range(4):
            rows[:, a : a + CELLS] += sums[:, a].T
    rows[:, CELLS + 3 :] = weighted @ columns.T
    gram, projection = normal.gram.copy(), normal.projection.copy()
    gram[first:], gram[:, first:], projection[first:] = rows, rows.T, weighted @ y
    return replace(normal, gram=gram, projection=projection)


@compiled
def _sums_by_cell(cell: NDArray[np.intp], left: Floats, right: Floats) -> Floats:
    """Products of the rows of `left` and the columns of `right`, summed over each cell's pixels.

    Parameters
    ----------
    cell : (n,) int array
    left, right : (j, n) and (n, k) arrays

    Returns
    -------
    (CELLS, j, k) array
    """
    sums = np.zeros((CELLS, left.shape[0], right.shape[1]))
    for i in range(cell.size):
        own = sums[cell[i]]
        for a in range(left.shape[0]):
            factor = left[a, i]
            for b in range(right.shape[1]):
                own[a, b] += factor * right[i, b]
    return sums


def _add_own(gram: Floats, a: int, sums: Floats) -> None:
    """Products of one step's spline with itself: the upper triangle, and half the diagonal."""
    # Entries (cell + a, cell + b) lie on one diagonal: a strided slice of the flat matrix.
    size = gram.shape[0]
    flat, stride = gram.reshape(-1), size + 1
    for b, products in enumerate(sums, start=a):
        start = a * size + b
        diagonal = flat[start : start + CELLS * stride : stride]
        diagonal += products if a < b else 0.5 * products


@compiled
def _add_pair(
    gram: Floats, cell: NDArray[np.intp], weighted: Floats, other: NDArray[np.intp], basis: Floats
) -> None:
    """Products of two steps' splines, one way: its transpose is the other."""
    for i in range(cell.size):
        for a in range(4):
            for b in range(4):
                gram[cell[i] + a, other[i] + b] += weighted[a, i] * basis[b, i]
