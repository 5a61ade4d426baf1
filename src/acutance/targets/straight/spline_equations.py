"""Sums of an edge's pixels into the normal equations of its edge spread function (ESF) spline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.normal_equations import Normal
from acutance.numerics.small_matrices import products_of_rows
from acutance.targets.straight.spline import CELLS, edge_weights
from acutance.targets.straight.step_profile import Profile

__all__ = [
    "Stencil",
    "accumulate",
    "products_of_splines",
    "products_with_spline",
    "renewed",
    "step_stencils",
]

Stencil = tuple[NDArray[np.intp], Floats]
_SOME: Final = 64
"""Pixels whose values are put side by side at a time."""


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
    stencils: Sequence[Stencil],
    y: Floats,
    weight: Floats,
    columns: Sequence[Floats],
    count: float,
) -> Normal:
    """Sum the pixels into the normal equations of ``y = sum of ESFs + columns^T a``.

    Parameters
    ----------
    stencils : sequence of ((n,) int, (4, n)) arrays
        For every step of the profile: each pixel's place in the ESF's spline, as
        `spline.edge_weights` gives it, the weights times the step's share.
    y, weight : (n,) arrays
        Value, and inverse variance (any common scale) of the pixels.
    columns : sequence of (q, n) arrays
        Further regressors, one row each.
    count : float
        Number of pixels; an outlier counts for less.
    """
    m, q = CELLS + 3, sum(map(len, columns))
    gram, projection = np.zeros((m + q, m + q)), np.zeros(m + q)
    root = np.sqrt(weight)
    # Filled up to a multiple of four, as the products want them.
    rows = np.empty((5 + q + (3 - q) % 4, y.size))
    np.multiply(y, root, out=rows[4])
    first = 5
    for some in columns:
        np.multiply(some, root, out=rows[first : first + len(some)])
        first += len(some)
    rows[first:] = 0.0
    weighted = [(cell, basis * root) for cell, basis in stencils]
    for i, (cell, basis) in enumerate(weighted):
        rows[:4] = basis
        _add_step(gram, projection, _sums_by_cell(cell, basis, rows[: 5 + q], CELLS))
        for other in weighted[i + 1 :]:
            products = products_of_splines(cell, basis, *other, (CELLS, CELLS))
            gram[:m, :m] += products + products.T
    gram[m:, :m] = gram[:m, m:].T
    products = products_of_rows(rows[4:])[: 1 + q, : 1 + q]
    gram[m:, m:], projection[m:] = products[1:, 1:], products[0, 1:]
    return Normal(gram, projection, products.item(0), count)


def renewed(
    normal: Normal,
    stencils: Sequence[Stencil],
    y: Floats,
    weight: Floats,
    columns: Sequence[Floats],
) -> Normal:
    """The equations of the same pixels after the last of the columns' arrays has changed.

    Parameters
    ----------
    normal : Normal
        As `accumulate` made it of these pixels and weights.
    stencils, y, weight
        As they were.
    columns : sequence of (q, n) arrays
    """
    weighted = columns[-1] * weight
    first = normal.projection.size - len(weighted)
    beside = np.sum([products_with_spline(one, weighted) for one in stencils], axis=0)
    rows = np.hstack([beside.T, *(weighted @ some.T for some in columns)])
    gram, projection = normal.gram.copy(), normal.projection.copy()
    gram[first:], gram[:, first:], projection[first:] = rows, rows.T, weighted @ y
    return replace(normal, gram=gram, projection=projection)


def products_with_spline(stencil: Stencil, rows: Floats, cells: int = CELLS) -> Floats:
    """Sums over the pixels of a spline's columns times some rows (k, n), (cells + 3, k)."""
    sums = _sums_by_cell(*stencil, rows, cells)
    found = np.zeros((cells + 3, len(rows)))
    for a in range(4):
        found[a : a + cells] += sums[:, a]
    return found


@compiled
def products_of_splines(
    cell: NDArray[np.intp],
    basis: Floats,
    other: NDArray[np.intp],
    others: Floats,
    cells: tuple[int, int],
) -> Floats:
    """Sums over the pixels of the products of two splines' columns, (cells + 3, cells + 3)."""
    found = np.zeros((cells[0] + 3, cells[1] + 3))
    for i in range(cell.size):
        for a in range(4):
            for b in range(4):
                found[cell[i] + a, other[i] + b] += basis[a, i] * others[b, i]
    return found


@compiled
def _sums_by_cell(cell: NDArray[np.intp], basis: Floats, rows: Floats, cells: int) -> Floats:
    """Products of the four splines of every pixel and some rows, summed over each cell's pixels.

    Parameters
    ----------
    cell : (n,) int array
    basis, rows : (4, n) and (k, n) arrays
    cells : int

    Returns
    -------
    (cells, 4, k) array
    """
    size = rows.shape[0]
    sums, some = np.zeros((cells, 4, size)), np.empty((_SOME, size))
    for first in range(0, cell.size, _SOME):
        count = min(_SOME, cell.size - first)
        # The values of one pixel side by side: the processor takes several at once.
        for i in range(count):
            for b in range(size):
                some[i, b] = rows[b, first + i]
        for i in range(count):
            own = sums[cell[first + i]]
            for a in range(4):
                factor = basis[a, first + i]
                for b in range(size):
                    own[a, b] += factor * some[i, b]
    return sums


@compiled
def _add_step(gram: Floats, projection: Floats, sums: Floats) -> None:
    """Products of one step's spline with itself, with the pixels' values and the regressors."""
    for cell in range(CELLS):
        for a in range(4):
            projection[cell + a] += sums[cell, a, 4]
            for b in range(4):
                gram[cell + a, cell + b] += sums[cell, a, b]
            for b in range(5, sums.shape[2]):
                gram[cell + a, CELLS - 2 + b] += sums[cell, a, b]
