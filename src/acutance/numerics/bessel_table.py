"""Tables of Bessel functions of many integer orders, from one recurrence for each argument."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import j0, j1

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["bessel_table"]

_LARGE: Final = 1e200
"""Numbers beyond it are scaled down: far above the argument orders differ by thousands of powers
of ten."""
_TOGETHER: Final = 16
"""Arguments that pass the recurrence together: the processor takes several at once."""


def bessel_table(orders: Sequence[int], x: Floats) -> Floats:
    """J of some orders, exact to some 1e-14.

    Functions of one order at a time cost a series, an asymptotic expansion or a recurrence each.
    The recurrence from the lowest orders up, which is stable as long as the order is below the
    argument, passes all on its way; for smaller arguments that from far above the highest order
    down (Miller's).

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
    highest = max(orders)
    place = np.full(highest + 1, -1, dtype=np.intp)
    place[np.asarray(orders)] = np.arange(len(orders))
    found, large = np.empty((len(orders), x.size)), x > highest
    small = (x > 0) & ~large
    found[:, large] = _upwards(place, x[large], j0(x[large]), j1(x[large]))
    found[:, small] = _downwards(place, x[small], len(orders))
    found[:, x == 0] = (np.asarray(orders) == 0)[:, None]
    return found


@compiled
def _upwards(place: NDArray[np.intp], x: Floats, before: Floats, here: Floats) -> Floats:
    """The recurrence from J0 and J1, which are overwritten.

    `place` (highest order + 1,) has the row of an order, or -1.
    """
    values = np.empty((place.max() + 1, x.size))
    for k in range(place.size):
        if place[k] >= 0:
            values[place[k]] = before
        for i in range(x.size):
            before[i], here[i] = here[i], 2.0 * (k + 1) / x[i] * here[i] - before[i]
    return values


@compiled
def _downwards(place: NDArray[np.intp], x: Floats, count: int) -> Floats:
    """Miller's recurrence; `place` as above, `count` rows."""
    highest = place.size - 1
    values = np.empty((count, x.size))
    for start in range(0, x.size, _TOGETHER):
        some = x[start : start + _TOGETHER]
        # Where J has fallen to nothing: beyond the turning point by some of its widths.
        reach = max(float(highest), some.max())
        first = int(reach + 20.0 + 12.0 * reach ** (1.0 / 3.0))
        first += first % 2
        above, here = np.zeros(some.size), np.full(some.size, 1e-250)
        total, twice = np.zeros(some.size), 2.0 / some
        found = values[:, start : start + _TOGETHER]
        for k in range(first, -1, -1):
            if k <= highest and place[k] >= 0:
                found[place[k]] = here
            # 1 = J0 + 2 J2 + 2 J4 ...
            share = 0.0 if k % 2 else (2.0 if k else 1.0)
            largest = 0.0
            for i in range(some.size):
                total[i] += share * here[i]
                above[i], here[i] = here[i], k * twice[i] * here[i] - above[i]
                largest = max(largest, abs(here[i]))
            if largest > _LARGE:
                for i in range(some.size):
                    if abs(here[i]) > _LARGE:
                        here[i] /= _LARGE
                        above[i] /= _LARGE
                        total[i] /= _LARGE
                        for m in range(max(k, 0), highest + 1):
                            if place[m] >= 0:
                                found[place[m], i] /= _LARGE
        for row in range(count):
            for i in range(some.size):
                found[row, i] /= total[i]
    return values
