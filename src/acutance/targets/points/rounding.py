"""Noise in steps of the image's numbers, around point sources.

The scatter of rounded numbers depends on where between two of them the background lies: noise of a
seventh of a step scatters by nothing in the middle of a step and by half of one at its end. So the
noise is the likeliest one, at the likeliest background of every source, for how often each number
occurs. Below a fifth of a step it no longer smooths the rounding, and wings lower than half a step
are not in the image.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.numerics.noise import smallest_step

__all__ = ["noise_in_steps"]

_Indices = NDArray[np.intp]
_INNER_PX: Final = 5.0
_OUTER_PX: Final = 13.0
_NOISE_STEPS: Final[Floats] = np.geomspace(0.02, 1.0, 40)
_PLACES: Final[Floats] = np.linspace(-0.5, 0.5, 41)
"""Of the background within the step whose number is the most frequent."""
_REACH: Final = 4
"""Numbers on either side of the most frequent one: noise of one step hardly reaches further."""
_MIN_PIXELS: Final = 30
_MAX_SCATTER: Final = 10.0
"""Steps of scatter from which on no rounding matters."""
_MAX_FINE_STEP: Final = 1e-4
"""Steps over the image's range of values that the PSF does not resolve."""


def noise_in_steps(pixels: Floats, places: Floats) -> float:
    """Noise of the background in steps of the image's numbers; infinite of one step and more.

    Parameters
    ----------
    pixels : (rows, cols) array
        Unusable ones are NaN.
    places : (k, 2) array
        Sources as (row, col).
    """
    rows, cols, owner = _ring_pixels(pixels.shape, places)
    value = pixels[rows, cols]
    known = np.isfinite(value)
    value, owner = value[known], owner[known]
    if not value.size:
        return np.inf
    every = pixels[np.isfinite(pixels)]
    span = float(every.max() - every.min())
    step = smallest_step(value) or smallest_step(every)
    if step <= _MAX_FINE_STEP * span or float(np.std(value)) > _MAX_SCATTER * step:
        return np.inf
    numbers = np.rint(value / step)
    counted = [_counts(numbers[owner == k]) for k in range(len(places))]
    counts = np.array([one for one in counted if one is not None])
    if not counts.size:
        return np.inf
    # Log likelihood (noise, place, source); every source lies at its likeliest place.
    likelihood = np.einsum("spc,kc->spk", _log_shares(), counts).max(axis=1).sum(axis=1)
    best = int(np.argmax(likelihood))
    return np.inf if best == _NOISE_STEPS.size - 1 else float(_NOISE_STEPS[best])


def _ring_pixels(shape: tuple[int, ...], places: Floats) -> tuple[_Indices, _Indices, _Indices]:
    """Pixels far enough from all sources to be background, each with its nearest source."""
    reach = np.arange(-int(_OUTER_PX), int(_OUTER_PX) + 1)
    down, right = (grid.ravel() for grid in np.meshgrid(reach, reach, indexing="ij"))
    middle = np.rint(places).astype(np.intp)
    rows, cols = middle[:, :1] + down, middle[:, 1:] + right
    owner = np.broadcast_to(np.arange(len(places))[:, None], rows.shape)
    inside = (rows >= 0) & (cols >= 0) & (rows < shape[0]) & (cols < shape[1])
    rows, cols, owner = rows[inside], cols[inside], owner[inside]
    away, nearest = cKDTree(places).query(np.stack([rows, cols], axis=1))
    kept = (nearest == owner) & (away > _INNER_PX)
    return rows[kept], cols[kept], owner[kept]


def _counts(numbers: Floats) -> Floats | None:
    """How many pixels have the most frequent number, and each of its neighbours."""
    if numbers.size < _MIN_PIXELS:
        return None
    found, often = np.unique(numbers, return_counts=True)
    offsets = np.arange(-_REACH, _REACH + 1) + found[int(np.argmax(often))]
    return np.array([float(often[found == one].sum()) for one in offsets])


@cache
def _log_shares() -> Floats:
    """Logarithm of the share of pixels of every number, (noise, place, number)."""
    borders = np.arange(-_REACH, _REACH + 2) - 0.5
    below = ndtr((borders - _PLACES[:, None]) / _NOISE_STEPS[:, None, None])
    # Some pixels are no noise: grass, hot pixels.
    return np.asarray(np.log(np.diff(below, axis=2) + 1e-4))
