"""How much an image changes from pixel to pixel, in steps of its numbers.

Rounding that neither noise nor detail smooths draws contours. The contours of two rounded images
of one scene lie at the same places, sharp in both, and the kernel between them is too narrow.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.noise import smallest_step

__all__ = ["detail_in_steps"]

_MOST_STEPS: Final = 2.0
"""Larger changes count as this: a few borders and defects smooth no rounding elsewhere."""
_ROUNDING: Final = (1 + 4 / 16) / 12
"""Variance, in steps squared, that rounding adds to a pixel less the mean of its neighbours."""
_MIN_PIXELS: Final = 100


def detail_in_steps(parts: Iterable[Floats]) -> float:
    """Root mean square of pixels less the mean of their four neighbours, rounding taken off.

    Parameters
    ----------
    parts : iterable of (rows, cols) arrays
        Parts of one image, NaN where there are no data.

    Returns
    -------
    float
        In steps of the image's numbers, infinite where the pixels are too few.
    """
    kept = list(parts)
    known = np.concatenate([part[np.isfinite(part)] for part in kept])
    step = smallest_step(known)
    off = np.concatenate([_off_neighbours(part) for part in kept])
    if off.size < _MIN_PIXELS or not step > 0:
        return math.inf
    power = float(np.mean(np.minimum(np.abs(off) / step, _MOST_STEPS) ** 2))
    if power >= 0.5 * _MOST_STEPS**2:
        return math.inf
    return math.sqrt(max(power - _ROUNDING, 0.0))


def _off_neighbours(part: Floats) -> Floats:
    """Every pixel that has four neighbours with data, less their mean."""
    inner = part[1:-1, 1:-1]
    around = part[:-2, 1:-1] + part[2:, 1:-1] + part[1:-1, :-2] + part[1:-1, 2:]
    off = inner - 0.25 * around
    return np.asarray(off[np.isfinite(off)])
