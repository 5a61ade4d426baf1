"""Sums over the kernels of a density (`sensor_density`): weights, moments of centres, the mixture.

Loops over thousands of kernels. They stand in groups of one covariance: those of a family, at one
size. The groups of a family are adjacent and have the same centres; a distance from the pixels is
worked out at the first size, and follows at the others by a small triangular matrix.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.small_matrices import (
    add_four_rows,
    add_product,
    add_products_of_rows,
    factorize,
    forward_substitution,
)
from acutance.targets.straight.tuned import KERNEL_LOG_WIDTH

__all__ = ["LANES", "kernel_moments", "kernel_weights", "mixture", "seen_kernels"]

LANES = 4
"""Coordinates are filled up with zeros to a multiple of this: so many are taken at once."""
_SOME = 1024
"""Kernels whose distances are worked out side by side."""
_AT_ONCE = 32
"""Kernels that an unrolled loop takes at once; `_SOME` is a multiple of it."""
_TOLD_BEST = 8
"""Combinations after which most kernels are known to be negligible; a multiple of `LANES`."""
_REACH = 3.0
"""Centres whose blur differs by more, in units of `KERNEL_LOG_WIDTH`, have no part."""
_NEGLIGIBLE = 9.0
"""Kernels whose log weight is less than the largest by this are left out."""


@compiled
def seen_kernels(
    covariance: Floats,
    part: NDArray[np.intp],
    power: Floats,
    combinations: Floats,
    values: Floats,
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """What combinations ``K^T c`` with an error of one tell of kernels of covariance S.

    With ``V = 1 + K^T S K = L L^T``, of every group

    Parameters
    ----------
    covariance : (f, q, q) array
        Of families.
    part, power : (g,) arrays
        The kernels of group g have the covariance ``power[g] * covariance[part[g]]``.
    combinations : (q, r) array
        Filled up with zeros to a multiple of `LANES`: combinations of which nothing is known.
    values : (r,) array

    Returns
    -------
    lower : (g, r, r) array
        L.
    root : (g, r, q) array
        ``L^-1 K^T S``: ``root.T @ root`` is what the pixels take from the covariance.
    axes : (g, r, q) array
        ``L^-1 K^T``: independent combinations of the coordinates, of unit variance.
    told : (g, r) array
        What the pixels say of them.
    log_density : (g,) array
        Logarithm of the density of a kernel that is where the pixels say.
    """
    groups = len(part)
    q, r = combinations.shape
    lower, root = np.empty((groups, r, r)), np.empty((groups, r, q))
    axes, told = np.empty((groups, r, q)), np.empty((groups, r))
    log_density = np.zeros(groups)
    rows, value = combinations.T.copy(), np.empty((r, 1))
    across, within = np.empty((r, q)), np.empty((r, r))
    for g in range(groups):
        if g == 0 or part[g] != part[g - 1]:
            across[:], within[:] = 0.0, 0.0
            add_product(across, rows, covariance[part[g]])
            add_product(within, across, combinations)
        for i in range(r):
            value[i, 0] = values[i]
            for j in range(q):
                axes[g, i, j], root[g, i, j] = rows[i, j], power[g] * across[i, j]
            for j in range(r):
                lower[g, i, j] = power[g] * within[i, j]
            lower[g, i, i] += 1.0
        factorize(lower[g])
        forward_substitution(lower[g], root[g])
        forward_substitution(lower[g], axes[g])
        forward_substitution(lower[g], value)
        for i in range(r):
            told[g, i] = value[i, 0]
            log_density[g] -= np.log(lower[g, i, i])
    return lower, root, axes, told, log_density


@compiled
def kernel_weights(
    coordinates: NDArray[np.float32],
    log_share: Floats,
    log_width: Floats,
    log_middle: float,
    ends: NDArray[np.intp],
    lower: Floats,
    axes: Floats,
    told: Floats,
    log_density: Floats,
    largest: float,
) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, float]:
    """Logarithm of the weight of every kernel after the pixels are seen.

    A centre c is off by ``x = axes c - told``, in standard deviations of a kernel of its family's
    first size, with the factor L of `seen_kernels`; for that of another size, L', by ``L'^-1 L x``.
    The sum of squares only grows: what the combinations told best make negligible, is left out.

    Parameters
    ----------
    coordinates : (p, n) array
        The q coordinates of every centre, filled up with zeros.
    log_share, log_width : (n,) arrays
        Logarithms of the weight of a centre among all, and of the width of its blur; of every
        family ascending.
    log_middle : float
        Logarithm of the width of the pixels' blur: a centre of another has less weight.
    ends : (f + 1,) int array
        First centre of every family, and the one after the last.
    lower, axes, told, log_density
        Of all groups, family by family, as `seen_kernels` gives them.
    largest : float
        A lower bound of the largest logarithm.

    Returns
    -------
    counts : (g,) int array
        How many centres of a group are kept.
    kept, log_weight : (g, m) arrays
        Which ones they are, and the logarithms of their weights; what follows the count is empty.
    largest : float
    """
    families, (groups, r, q), p = len(ends) - 1, axes.shape, len(coordinates)
    sizes, soon = groups // families, min(r, _TOLD_BEST)
    most = np.max(ends[1:] - ends[:-1])
    counts, kept = np.zeros(groups, np.intp), np.empty((groups, most), np.intp)
    log_weight = np.empty((groups, most))
    # The last rows and columns are zeros: four sums of four products are worked out at a time.
    own, others = np.zeros((r, p), np.float32), np.zeros((sizes, r, r), np.float32)
    off, misfit = np.zeros((r, _SOME), np.float32), np.empty((sizes, _SOME), np.float32)
    left, place = np.zeros((p, _SOME), np.float32), np.empty(_SOME, np.intp)
    before, best, minus = np.empty(_SOME), np.empty(_SOME), np.zeros(r, np.float32)
    for f in range(families):
        g, own_width = f * sizes, log_width[ends[f] : ends[f + 1]]
        first = ends[f] + np.searchsorted(own_width, log_middle - _REACH * KERNEL_LOG_WIDTH)
        last = ends[f] + np.searchsorted(own_width, log_middle + _REACH * KERNEL_LOG_WIDTH)
        for size in range(1, sizes):
            turn = lower[g].copy()
            forward_substitution(lower[g + size], turn)
            for j in range(r):
                for i in range(r):
                    others[size, j, i] = turn[j, i]
        for j in range(r):
            minus[j] = -told[g, j]
            for i in range(q):
                own[j, i] = axes[g, j, i]
        for start in range(first, last, _SOME):
            some = min(_SOME, last - start)
            misfit[:] = 0.0
            _add_squares(misfit, off, own, others, minus, coordinates, start, some, 0, soon)
            best[:some] = -np.inf
            for k in range(some):
                away = (log_width[start + k] - log_middle) / KERNEL_LOG_WIDTH
                before[k] = log_share[start + k] - 0.5 * away * away
            for size in range(sizes):
                for k in range(some):
                    best[k] = max(best[k], log_density[g + size] - 0.5 * misfit[size, k])
            count = 0
            for k in range(some):
                place[count] = k
                count += before[k] + best[k] >= largest - _NEGLIGIBLE
            for i in range(q):
                for k in range(count):
                    left[i, k] = coordinates[i, start + place[k]]
            for j in range(soon):
                for k in range(count):
                    off[j, k] = off[j, place[k]]
            for size in range(sizes):
                for k in range(count):
                    misfit[size, k] = misfit[size, place[k]]
            # Columns beyond the count are some of no use, and cost nothing.
            filled_up = count + -count % _AT_ONCE
            _add_squares(misfit, off, own, others, minus, left, 0, filled_up, soon, r)
            for size in range(sizes):
                n = counts[g + size]
                for k in range(count):
                    here = before[place[k]] + log_density[g + size] - 0.5 * misfit[size, k]
                    largest = max(largest, here)
                    kept[g + size, n], log_weight[g + size, n] = start + place[k], here
                    n += here >= largest - _NEGLIGIBLE
                counts[g + size] = n
    return counts, kept, log_weight, largest


@inlined
def _add_squares(
    misfit: NDArray[np.float32],
    off: NDArray[np.float32],
    own: NDArray[np.float32],
    others: NDArray[np.float32],
    minus: NDArray[np.float32],
    coordinates: NDArray[np.float32],
    start: int,
    count: int,
    j: int,
    stop: int,
) -> None:
    """Add the squares of the combinations from j to `stop` to the misfits (sizes, count)."""
    here = np.empty((LANES, _SOME), np.float32)
    for i in range(j, stop, LANES):
        for a in range(LANES):
            off[i + a, :count] = minus[i + a]
        add_four_rows(off[i : i + LANES], own[i : i + LANES], coordinates, start, count)
        for size in range(1, len(others)):
            here[:, :count] = 0.0
            add_four_rows(here, others[size, i : i + LANES, : i + LANES], off, 0, count)
            for a in range(LANES):
                for k in range(count):
                    misfit[size, k] += here[a, k] * here[a, k]
        for a in range(LANES):
            for k in range(count):
                misfit[0, k] += off[i + a, k] * off[i + a, k]


@compiled
def kernel_moments(
    coordinates: NDArray[np.float32],
    q: int,
    counts: NDArray[np.intp],
    kept: NDArray[np.intp],
    log_weight: Floats,
    largest: float,
) -> tuple[Floats, Floats, Floats]:
    """Of every group the weight relative to the largest, and mean and covariance of its centres.

    Parameters
    ----------
    coordinates : (p, n) array
    q : int
        How many coordinates are no filling.
    counts, kept, log_weight, largest
        As of `kernel_weights`.

    Returns
    -------
    (g + 1,), (g + 1, q) and (g + 1, q, q) arrays
        All zero of one more group, about none.
    """
    groups, p, none = len(counts), len(coordinates), np.float32(0)
    total, mean = np.zeros(groups + 1), np.zeros((groups + 1, q))
    spread, square, away = np.zeros((groups + 1, q, q)), np.empty((p, p)), np.empty(p)
    place, share = np.empty(_SOME, np.intp), np.empty(_SOME, np.float32)
    own, weighted = np.empty((p, _SOME), np.float32), np.empty((p, _SOME), np.float32)
    for g in range(groups):
        # Moments about a centre: the digits of the coordinates are enough for small departures.
        middle, n = kept[g, np.argmax(log_weight[g, : counts[g]])] if counts[g] else 0, 0
        square[:], away[:] = 0.0, 0.0
        while n < counts[g]:
            count = 0
            while count < _SOME and n < counts[g]:
                place[count], share[count] = kept[g, n], np.exp(log_weight[g, n] - largest)
                count += log_weight[g, n] >= largest - _NEGLIGIBLE
                n += 1
            sums = none
            for k in range(count):
                sums += share[k]
            total[g] += sums
            for i in range(p):
                for k in range(count):
                    own[i, k] = coordinates[i, place[k]] - coordinates[i, middle]
                sums = none
                for k in range(count):
                    weighted[i, k] = share[k] * own[i, k]
                    sums += weighted[i, k]
                away[i] += sums
            add_products_of_rows(square, weighted, own, 0, count)
        if total[g] == 0:
            continue
        for i in range(q):
            away[i] /= total[g]
            mean[g, i] = coordinates[i, middle] + away[i]
            for j in range(i + 1):
                spread[g, i, j] = square[i, j] / total[g] - away[i] * away[j]
                spread[g, j, i] = spread[g, i, j]
    return total, mean, spread


@compiled
def mixture(
    share: Floats,
    centre: Floats,
    spread: Floats,
    covariance: Floats,
    part: NDArray[np.intp],
    power: Floats,
    root: Floats,
    axes: Floats,
    told: Floats,
) -> tuple[Floats, Floats]:
    """Mean (q,) and covariance (q, q) of all kernels together: their own, and how means differ.

    A kernel about c, of covariance S, is left with the mean ``c + R^T (t - A c)`` and the
    covariance ``S - R^T R``, R being its root, A its axes and t what is told of them. With the
    covariance P of the centres of a group, that of its kernels and their means is

        S - R^T R + (1 - R^T A) P (1 - R^T A)^T = S + P + R^T C + (R^T C)^T,
        C = (A P A^T - 1) R / 2 - A P.

    Parameters
    ----------
    share : (g,) array
        Probability of every group.
    centre, spread : (g, q) and (g, q, q) arrays
        Mean and covariance of its centres.
    covariance, part, power, root, axes, told
        As of `seen_kernels`.
    """
    groups, r, q = axes.shape
    mean, half, means = np.zeros(q), np.zeros((q, q)), centre.copy()
    own = np.zeros(len(covariance))
    by_axes, left, common = np.empty((r, q)), np.empty((r, r)), np.empty((r, q))
    for g in range(groups):
        if share[g] == 0:
            continue
        by_axes[:], left[:], common[:] = 0.0, 0.0, 0.0
        add_product(by_axes, axes[g], spread[g])
        add_product(left, by_axes, axes[g].T.copy())
        for i in range(r):
            left[i, i] -= 1.0
        add_product(common, left, root[g])
        for i in range(r):
            for j in range(q):
                common[i, j] = share[g] * (0.5 * common[i, j] - by_axes[i, j])
        add_product(half, root[g].T.copy(), common)
        for i in range(q):
            for j in range(q):
                half[i, j] += 0.5 * share[g] * spread[g, i, j]
        own[part[g]] += share[g] * power[g]
        for j in range(r):
            off = told[g, j]
            for i in range(q):
                off -= axes[g, j, i] * centre[g, i]
            for i in range(q):
                means[g, i] += root[g, j, i] * off
        for i in range(q):
            mean[i] += share[g] * means[g, i]
    whole = half + half.T
    for f in range(len(covariance)):
        whole += own[f] * covariance[f]
    for g in range(groups):
        for i in range(q):
            away = share[g] * (means[g, i] - mean[i])
            for j in range(q):
                whole[i, j] += away * (means[g, j] - mean[j])
    return mean, whole
