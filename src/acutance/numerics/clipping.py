"""Clipped pixels: at the detector's limit, or piled up at an end of the range of values."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainc

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = [
    "NOT_CLIPPED",
    "ClipLevels",
    "at_limit_share",
    "clip_levels",
    "clipped_share",
    "piled_up_share",
]

_MIN_PILED_UP = 5
_MIN_EXCESS = 3
_NEAR_END = 4
"""Values next to the end by which chance is judged."""
_BY_CHANCE = 1e-3
"""Of 500 unclipped edges one had five pixels at the end of a side and one at the next value."""
_MIN_PILED_IN_IMAGE = 20
"""Pixels of an image at the end of its range by which it is clipped there."""
_MIN_LEVELS = 8
"""Different values of an image that has noise."""


class ClipLevels(NamedTuple):
    """Values at which an image is clipped; None at an end where it is not.

    Attributes
    ----------
    dark, bright : float or None
    """

    dark: float | None
    bright: float | None


NOT_CLIPPED = ClipLevels(None, None)


def clip_levels(values: Floats) -> ClipLevels:
    """Where the range of values of an image, (n,), was cut off, if it was.

    A stretch to 8 bits cuts a few hundredths of the pixels off at either end, a detector the
    brightest. At such an end lie many more pixels than at the next value. Where any other value
    has as many more than its neighbours, noise is finer than the steps of the numbers, or there is
    none: dark water may have one value then.
    """
    dark, bright = _lowest_if_piled(values), _lowest_if_piled(-values)
    # To count all values takes a hundred times longer, and few images need it.
    if (dark is None and bright is None) or _is_peaked(values):
        return NOT_CLIPPED
    return ClipLevels(dark, None if bright is None else -bright)


def _is_peaked(values: Floats) -> bool:
    """Whether values are few, or the most frequent but the ends stands out of both neighbours."""
    _, count = np.unique(values, return_counts=True)
    if count.size < _MIN_LEVELS:
        return True
    inner = count[1:-1]
    most = int(np.argmax(inner))
    before, _, after = np.pad(inner, 1)[most : most + 3].tolist()
    return bool(inner[most] > _MIN_EXCESS * max(before, after))


def _lowest_if_piled(values: Floats) -> float | None:
    """The lowest value, if so many more pixels lie there than at the next that it is an end."""
    if not values.size:
        return None
    lowest = values.min()
    last = np.count_nonzero(values == lowest)
    if last < _MIN_PILED_IN_IMAGE or last == values.size:
        return None
    others = values[values > lowest]
    before = np.count_nonzero(others == others.min())
    return float(lowest) if last > _MIN_EXCESS * before else None


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
    end. As many as lie at the next four values on average are expected, by Poisson's law.
    """
    if not values.size:
        return 0.0
    last, *others = _counts_at_end(values).tolist()
    seen = [count for count in others if count > 0]
    mean = sum(seen) / max(len(seen), 1)
    piled = last >= _MIN_PILED_UP and last > _MIN_EXCESS * others[0]
    return last / values.size if piled and float(gammainc(last, mean)) < _BY_CHANCE else 0.0


@compiled
def _counts_at_end(values: Floats) -> NDArray[np.intp]:
    """How many of some values are the largest, the largest but that, and so on; 0 of no value."""
    largest = np.full(_NEAR_END + 1, -np.inf)
    count = np.zeros(_NEAR_END + 1, np.intp)
    for value in values:
        if not value >= largest[_NEAR_END]:
            continue
        place = 0
        while value < largest[place]:
            place += 1
        if value == largest[place]:
            count[place] += 1
            continue
        for later in range(_NEAR_END, place, -1):
            largest[later], count[later] = largest[later - 1], count[later - 1]
        largest[place], count[place] = value, 1
    return count
