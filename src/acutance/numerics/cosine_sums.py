"""Sums of cosines at equal distances, without a cosine for each."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["cosine_sums"]


@compiled
def cosine_sums(weights: Floats, angles_rad: Floats, count: int) -> Floats:
    """``sum(weights * cos(n * angles_rad))`` of n = 0, 1, ... below a count.

    By Chebyshev's recurrence, ``cos((n + 1) x) = 2 cos(x) cos(n x) - cos((n - 1) x)``.

    Parameters
    ----------
    weights : (k, m) array
    angles_rad : (m,) array
    count : int

    Returns
    -------
    (k, count) array
    """
    found = np.zeros((len(weights), count))
    for j in range(angles_rad.size):
        step = np.cos(angles_rad[j])
        before, here = step, 1.0
        for n in range(count):
            for i in range(len(weights)):
                found[i, n] += weights[i, j] * here
            before, here = here, 2 * step * here - before
    return found
