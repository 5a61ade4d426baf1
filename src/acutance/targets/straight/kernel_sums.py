"""Sums over the kernels of a density (`sensor_density`): their weights, and moments of centres.

Loops over thousands of kernels; of most, the first few combinations tell that they have no part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["NEGLIGIBLE", "kernel_moments", "kernel_weights"]

NEGLIGIBLE = 9.0
"""Kernels whose log weight is less than the largest by this are left out."""


@compiled
def kernel_weights(
    centres: Floats, log_before: Floats, axes: Floats, values: Floats, largest: float
) -> tuple[Floats, float]:
    """Logarithm of the weight of kernels that differ in their centres alone.

    Parameters
    ----------
    centres : (n, q) array
    log_before : (n,) array
        Logarithm of their weight before the pixels are seen.
    axes : (r, q) array
        Independent combinations of the coordinates, those first that the pixels tell best, in
        units of their standard deviation under one kernel.
    values : (r,) array
        What the pixels say of them.
    largest : float
        The largest logarithm so far.

    Returns
    -------
    log_weight : (n,) array
        Minus infinity for negligible ones.
    largest : float
        The largest logarithm now.
    """
    n, q = centres.shape
    found = np.empty(n)
    for k in range(n):
        weight = log_before[k]
        for j in range(values.size):
            off = values[j]
            for i in range(q):
                off -= axes[j, i] * centres[k, i]
            weight -= 0.5 * off * off
            if weight < largest - NEGLIGIBLE:
                weight = -np.inf
                break
        found[k] = weight
        largest = max(largest, weight)
    return found, largest


@compiled
def kernel_moments(
    centres: Floats, log_weight: NDArray[np.float64], largest: float
) -> tuple[float, Floats, Floats]:
    """Total weight, relative to the largest, mean (q,) and covariance (q, q) of the centres."""
    n, q = centres.shape
    total, mean, square = 0.0, np.zeros(q), np.zeros((q, q))
    for k in range(n):
        if log_weight[k] > largest - NEGLIGIBLE:
            weight = np.exp(log_weight[k] - largest)
            total += weight
            for i in range(q):
                own = weight * centres[k, i]
                mean[i] += own
                for j in range(q):
                    square[i, j] += own * centres[k, j]
    if total > 0:
        mean /= total
        for i in range(q):
            for j in range(q):
                square[i, j] = square[i, j] / total - mean[i] * mean[j]
    return total, mean, square
