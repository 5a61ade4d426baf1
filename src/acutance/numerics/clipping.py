"""Clipped pixels: at the detector's limit, or piled up at an end of the range of values."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["at_limit_share", "clipped_share", "piled_up_share"]

_MIN_PILED_UP = 5
_MIN_EXCESS = 3


def clipped_share(
    values: Floats, saturation_level: float | None = None, *, noisy: bool = True
) -> float:
    """Share of some pixels, (n,), that reach the detector's limit or pile up at either end.

    Parameters
    ----------
    values : (n,) array
    saturation_level : float or None
        The largest value the detector can give.
    noisy : bool, optional
        Whether the image has noise: a uniform background without noise is all one number, which
        is no sign of clipping.
    """
    limit = at_limit_share(values, saturation_level)
    if not noisy:
        return limit
    return max(limit, piled_up_share(values), piled_up_share(-values))


def at_limit_share(values: Floats, saturation_level: float | None) -> float:
    """Share of some pixels, (n,), that have the largest value the detector can give."""
    if saturation_level is None or values.size == 0:
        return 0.0
    return int(np.count_nonzero(values >= saturation_level)) / values.size


def piled_up_share(values: Floats) -> float:
    """Share of some pixels, (n,), that have the largest value of all, where it is more than chance.

    Clipping before writing leaves many pixels at the end and few next to it; noise has few at its
    end.
    """
    last, before = _counts_at_end(values)
    piled = last >= _MIN_PILED_UP and last > _MIN_EXCESS * before
    return last / values.size if piled else 0.0


@compiled
def _counts_at_end(values: Floats) -> tuple[int, int]:
    """How many of some values are the largest, and how many the largest but that."""
    largest, second, last, before = -np.inf, -np.inf, 0, 0
    for value in values:
        if value > largest:
            largest, second, last, before = value, largest, 1, last
        elif value == largest:
            last += 1
        elif value > second:
            second, before = value, 1
        elif value == second:
            before += 1
    return last, before
