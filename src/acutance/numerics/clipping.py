"""Clipped pixels: at the detector's limit, or piled up at an end of the range of values."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats

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
    return float(np.mean(values >= saturation_level))


def piled_up_share(values: Floats) -> float:
    """Share of some pixels, (n,), that have the largest value of all, where it is more than chance.

    Clipping before writing leaves many pixels at the end and few next to it; noise has few at its
    end.
    """
    if values.size == 0:
        return 0.0
    is_last = values == values.max()
    last = int(np.count_nonzero(is_last))
    if last < _MIN_PILED_UP:
        return 0.0
    others = values[~is_last]
    before = int(np.count_nonzero(others == others.max())) if others.size else 0
    return last / values.size if last > _MIN_EXCESS * before else 0.0
