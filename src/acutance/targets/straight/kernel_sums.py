"""Sums over the kernels of a density (`sensor_density`): their weights, and moments of centres.

Loops over thousands of kernels; of most, the first few combinations tell that they have no part.
Kernels stand in groups of one covariance: those of a family, at one size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["LANES", "forward_substitution", "kernel_moments", "kernel_weights"]

LANES = 16
"""Coordinates are filled up with zeros to a multiple of this: a processor takes as many at once."""
_NEGLIGIBLE = 9.0
"""Kernels whose log weight is less than the largest by this are left out."""


@compiled
def kernel_weights(
    centres: Floats,
    log_before: Floats,
    members: NDArray[np.intp],
    axes: Floats,
    told: Floats,
    log_density: Floats,
    largest: float,
) -> tuple[Floats, float]:
    """Logarithm of the weight of every kernel after the pixels are seen.

    Parameters
    ----------
    centres : (n, p) array
        The q coordinates, filled up with zeros.
    log_before : (n,) array
        Logarithm of the weight of a centre before.
    members : (g, 2) int array
        First centre of every group, and the one after its last.
    axes : (g, r, q) array
        Independent combinations of the coordinates, those first that the pixels tell best, in
        units of their standard deviation under a kernel of the group.
    told : (g, r) array
        What the pixels say of them.
    log_density : (g,) array
        Logarithm of what all kernels of a group have in common.
    largest : float
        A lower bound of the largest logarithm.

    Returns
    -------
    log_weight : (g, m) array
        Of the m or less centres of a group; minus infinity for negligible ones.
    largest : float
    """
    groups, combinations, q = axes.shape
    found = np.full((groups, np.max(members[:, 1] - members[:, 0])), -np.inf)
    for g in range(groups):
        first, last = members[g]
        filled = np.zeros((combinations, centres.shape[1]))
        filled[:, :q] = axes[g]
        for k in range(first, last):
            weight = log_before[k] + log_density[g]
            for j in range(combinations):
                off = told[g, j]
                for i in range(centres.shape[1]):
                    off -= filled[j, i] * centres[k, i]
                weight -= 0.5 * off * off
                if weight < largest - _NEGLIGIBLE:
                    break
            else:
                found[g, k - first] = weight
                largest = max(largest, weight)
    return found, largest


@compiled
def kernel_moments(
    centres: Floats, members: NDArray[np.intp], log_weight: Floats, largest: float
) -> tuple[Floats, Floats, Floats]:
    """Of every group the weight relative to the largest, and mean and covariance of its centres.

    Parameters
    ----------
    centres : (n, q) array
    members, log_weight, largest
        As of `kernel_weights`.

    Returns
    -------
    (g,), (g, q) and (g, q, q) arrays
    """
    groups, q = members.shape[0], centres.shape[1]
    total, mean, spread = np.zeros(groups), np.zeros((groups, q)), np.zeros((groups, q, q))
    for g in range(groups):
        first, last = members[g]
        for k in range(first, last):
            if log_weight[g, k - first] < largest - _NEGLIGIBLE:
                continue
            weight = np.exp(log_weight[g, k - first] - largest)
            total[g] += weight
            for i in range(q):
                own = weight * centres[k, i]
                mean[g, i] += own
                for j in range(i + 1):
                    spread[g, i, j] += own * centres[k, j]
        if total[g] > 0:
            mean[g] /= total[g]
            for i in range(q):
                for j in range(i + 1):
                    spread[g, i, j] = spread[g, i, j] / total[g] - mean[g, i] * mean[g, j]
                    spread[g, j, i] = spread[g, i, j]
    return total, mean, spread


@compiled
def forward_substitution(lower: Floats, right: Floats) -> Floats:
    """Solutions of several triangular systems, (g, r, k), of matrices (g, r, r) and right sides."""
    found = right.copy()
    for g in range(lower.shape[0]):
        for i in range(lower.shape[1]):
            for j in range(i):
                for k in range(found.shape[2]):
                    found[g, i, k] -= lower[g, i, j] * found[g, j, k]
            for k in range(found.shape[2]):
                found[g, i, k] /= lower[g, i, i]
    return found
