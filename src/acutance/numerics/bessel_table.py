"""Tables of Bessel functions of many integer orders, from one recurrence for each argument."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["bessel_table"]


def bessel_table(orders: Sequence[int], x: Floats) -> Floats:
    """J of some orders, exact to some 1e-14.

    Functions of one order at a time cost a series, an asymptotic expansion or a recurrence each;
    the recurrence from the highest order down (Miller's) passes all others on its way.

    Parameters
    ----------
    orders : sequence of int
        From 0 on, each once.
    x : (n,) array
        Arguments from 0 on.

    Returns
    -------
    (orders, n) array
    """
    place = np.full(max(orders) + 1, -1, dtype=np.intp)
    place[np.asarray(orders)] = np.arange(len(orders))
    return np.asarray(_downwards(place, np.asarray(x, dtype=float)))


_LARGE = 1e200
"""Numbers beyond it are scaled down: far above the argument orders differ by thousands of powers
of ten."""


@compiled
def _downwards(place: NDArray[np.intp], x: Floats) -> Floats:
    """Miller's recurrence; `place` (highest order + 1,) has the row of an order, or -1."""
    highest = place.size - 1
    count = 0
    for k in range(highest + 1):
        count = max(count, place[k] + 1)
    values = np.zeros((count, x.size))
    own = np.zeros(highest + 1)
    for i in range(x.size):
        if x[i] == 0.0:
            if place[0] >= 0:
                values[place[0], i] = 1.0
            continue
        # Where J has fallen to nothing: beyond the turning point by some of its widths.
        reach = max(float(highest), x[i])
        first = int(reach + 20.0 + 12.0 * reach ** (1.0 / 3.0))
        first += first % 2
        above, here, total = 0.0, 1e-250, 0.0
        for k in range(first, -1, -1):
            if k <= highest:
                own[k] = here
            if k % 2 == 0:
                total += here if k == 0 else 2.0 * here
            if k > 0:
                above, here = here, 2.0 * k / x[i] * here - above
            if abs(here) > _LARGE:
                here /= _LARGE
                above /= _LARGE
                total /= _LARGE
                for m in range(k, highest + 1):
                    own[m] /= _LARGE
        for k in range(highest + 1):
            if place[k] >= 0:
                # 1 = J0 + 2 J2 + 2 J4 ...
                values[place[k], i] = own[k] / total
    return values
