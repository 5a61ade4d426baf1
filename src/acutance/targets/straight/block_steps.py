"""Steps at every eighth row and column: what JPEG leaves of an image.

JPEG rounds the cosine transform of every block of 8 x 8 pixels (G. K. Wallace, Communications of
the ACM 34(4), 30, 1991, DOI 10.1145/103085.103089). Within a block the fine detail is gone, noise
and the weak part of an edge's spectrum with it, and blocks do not join: the third difference of
pixels is larger across their borders than within. Where the blocks begin a crop does not tell, so
the phase is sought.
"""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["block_steps"]

_BLOCK = 8
_MIN_SIDE_PX = 32
"""Of fewer rows or columns chance makes a phase larger by half."""
_BOUND = 2.5
"""Third differences count up to so many times their median: an edge is no border of blocks."""


def block_steps(pixels: Floats) -> float:
    """How many times larger third differences are at every eighth row and column than at others.

    The mean (geometric) of rows and columns. In images that were not compressed it is 1.0 to 1.3
    by chance; 1 of small regions, and where most pixels equal their neighbours.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    if min(pixels.shape) < _MIN_SIDE_PX:
        return 1.0
    return math.sqrt(_steps_of_columns(pixels) * _steps_of_columns(np.ascontiguousarray(pixels.T)))


def _steps_of_columns(pixels: Floats) -> float:
    """Largest mean of a phase over the middle one of the others."""
    third = _third_differences(pixels)
    known = third[np.isfinite(third)]
    usual = float(np.partition(known, known.size // 2)[known.size // 2]) if known.size else 0.0
    if usual == 0:
        return 1.0
    by_phase = np.sort(_phase_means(third, _BOUND * usual))
    # Dead columns at every eighth leave phases of which nothing is known.
    by_phase = by_phase[np.isfinite(by_phase)]
    middle = float(by_phase[max(by_phase.size // 2 - 1, 0)])
    return float(by_phase[-1]) / middle if middle > 0 else 1.0


@compiled
def _third_differences(pixels: Floats) -> Floats:
    """Moduli of the third differences from column to column, (rows, cols - 3)."""
    rows, cols = pixels.shape
    third = np.empty((rows, cols - 3))
    for i in range(rows):
        for j in range(cols - 3):
            inner, outer = pixels[i, j + 2] - pixels[i, j + 1], pixels[i, j + 3] - pixels[i, j]
            third[i, j] = abs(outer - 3 * inner)
    return third


@compiled
def _phase_means(third: Floats, bound: float) -> Floats:
    """Mean of what is known of every eighth column, each value at most the bound, (8,).

    NaN where nothing is.
    """
    total, count = np.zeros(_BLOCK), np.zeros(_BLOCK)
    for i in range(third.shape[0]):
        for j in range(third.shape[1]):
            if np.isfinite(third[i, j]):
                total[j % _BLOCK] += min(third[i, j], bound)
                count[j % _BLOCK] += 1
    return total / count
