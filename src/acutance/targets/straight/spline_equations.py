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
    gram, projection = np.zeros((m + q, m + q)), np.zeros(m + q)
    rows = np.empty((1 + q, y.size))
    rows[0], rows[1:] = y, columns
    for i, (cell, basis) in enumerate(stencils):
        weighted = basis * weight
        _add_own(gram, _sums_by_cell(cell, weighted, basis))
        _add_others(gram, projection, _sums_by_cell(cell, weighted, rows))
        for other, other_basis in stencils[i + 1 :]:
            _add_pair(gram, cell, weighted, other, other_basis)
    gram[m:, :m] = gram[:m, m:].T
    # The product of a matrix with its own transpose takes half the time of any other.
    rows *= np.sqrt(weight)
    products = rows @ rows.T
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
        sums = _sums_by_cell(cell, basis, weighted)
        for a in range(4):
            rows[:, a : a + CELLS] += sums[:, :, a].T
    rows[:, CELLS + 3 :] = weighted @ columns.T
    gram, projection = normal.gram.copy(), normal.projection.copy()
    gram[first:], gram[:, first:], projection[first:] = rows, rows.T, weighted @ y
    return replace(normal, gram=gram, projection=projection)


@compiled
def _sums_by_cell(cell: NDArray[np.intp], basis: Floats, rows: Floats) -> Floats:
    """Products of the four splines of every pixel and some rows, summed over each cell's pixels.

    Parameters
    ----------
    cell : (n,) int array
    basis, rows : (4, n) and (k, n) arrays

    Returns
    -------
    (CELLS, k, 4) array
    """
    sums = np.zeros((CELLS, rows.shape[0], 4))
    for i in range(cell.size):
        own = sums[cell[i]]
        p, r, s, t = basis[0, i], basis[1, i], basis[2, i], basis[3, i]
        for b in range(rows.shape[0]):
            value = rows[b, i]
            own[b, 0] += p * value
            own[b, 1] += r * value
            own[b, 2] += s * value
            own[b, 3] += t * value
    return sums


@compiled
def _add_own(gram: Floats, sums: Floats) -> None:
    """Products of one step's spline with itself."""
    for cell in range(sums.shape[0]):
        for a in range(4):
            for b in range(4):
                gram[cell + a, cell + b] += sums[cell, a, b]


@compiled
def _add_others(gram: Floats, projection: Floats, sums: Floats) -> None:
    """Products of one step's spline with the pixels' values, and with the regressors."""
    for cell in range(sums.shape[0]):
        for a in range(4):
            projection[cell + a] += sums[cell, 0, a]
            for b in range(1, sums.shape[1]):
                gram[cell + a, CELLS + 2 + b] += sums[cell, b, a]


@compiled
def _add_pair(
    gram: Floats, cell: NDArray[np.intp], weighted: Floats, other: NDArray[np.intp], basis: Floats
) -> None:
    """Products of two steps' splines, either way."""
    for i in range(cell.size):
        for a in range(4):
            for b in range(4):
                product = weighted[a, i] * basis[b, i]
                gram[cell[i] + a, other[i] + b] += product
                gram[other[i] + b, cell[i] + a] += product
