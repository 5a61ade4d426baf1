"""Pixels that repeat the one above or beside them: what nearest-neighbour resampling leaves.

An image that is enlarged, turned or projected by taking the nearest pixel has some of them twice.
Noise does not repeat: rows that are equal while those above and below differ are certain. Where
the grid was also turned, equal pairs are short and stand anywhere; differences of neighbours are
then zero more often than one step of the numbers, and those of pixels three rows apart are not.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.pixel_steps import smallest_neighbour_step, value_range

__all__ = ["repeated_share"]

_APART: Final = 3
"""Rows of which one repeats the other only where an image is enlarged three times and more."""
_MIN_PAIRS: Final = 64
_MAX_RARITY: Final = 2.0
"""A pair of equal pixels counts as a chance of 1 in 7 at least, however fine the numbers."""
_MAX_EQUAL: Final = 0.97
"""Of images more alike than that nothing is known."""
_ENOUGH: Final = 5.0
"""Log chance of a run of equal pixels over that of one among all pairs: of 51 000 tiles of real
images, quiet and textured ones in 8 bits among them, one had a run of 4."""
_SIGMAS: Final = 5.0
"""Of equal pairs beyond expectation: in those tiles 3.5 at most."""
_ROUGH_STEPS: Final = 1.5
"""Pixels count where those around differ by two steps: on flat ground all are equal."""
_FINEST: Final = 1e-6
"""Steps below this share of the range are the arithmetic's."""


def repeated_share(pixels: Floats) -> float:
    """Share of the pixels that repeat the one above them or beside them; 0 where chance may do it.

    The larger of both. An image enlarged by a factor s has 1 - 1/s.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    step = max(smallest_neighbour_step(pixels), _FINEST * value_range(pixels))
    if not 0 < step < math.inf:
        return 0.0
    both = pixels, np.ascontiguousarray(pixels.T)
    return max(max(_share_in_runs(one), _share_of_pairs(one, step)) for one in both)


def _share_in_runs(pixels: Floats) -> float:
    """Share of the pixels in stretches of a row that repeat the row above."""
    equal, pairs = _equal_apart(pixels)
    if pairs < _MIN_PAIRS or equal > _MAX_EQUAL * pairs:
        return 0.0
    chance = max(equal / pairs, math.exp(-_MAX_RARITY))
    enough = _ENOUGH * math.log(2 * pairs) / -math.log(chance)
    return _in_runs(pixels, 1 - chance, enough)


@compiled
def _equal_apart(pixels: Floats) -> tuple[int, int]:
    """How many pixels equal the one three rows on, and how many pairs there are."""
    equal, pairs = 0, 0
    for i in range(pixels.shape[0] - _APART):
        for j in range(pixels.shape[1]):
            apart = pixels[i + _APART, j] - pixels[i, j]
            equal += apart == 0
            pairs += bool(np.isfinite(apart))
    return equal, pairs


@compiled
def _in_runs(pixels: Floats, differing: float, enough: float) -> float:
    """Share of the pixels in runs of so many equal pairs of two rows.

    A pair counts where the pixels above, below and beside differ as often as pixels do elsewhere:
    two rows of fill, of a saturated road or of bars along the rows are equal without being copies.
    So are those on both sides of an axis of symmetry, where the next two are equal, too.
    """
    rows, cols = pixels.shape
    in_runs, pairs = 0, 0
    for i in range(1, rows - 2):
        run, above, below, beside, uneven = 0, 0, 0, 0, 0
        for j in range(cols + 1):
            apart = pixels[i + 1, j] - pixels[i, j] if j < cols else np.inf
            if np.isnan(apart):
                continue
            if apart != 0:
                if min(float(run), min(above, below, beside, uneven) / differing) >= enough:
                    in_runs += run
                run, above, below, beside, uneven = 0, 0, 0, 0, 0
                pairs += j < cols
                continue
            own = pixels[i, j]
            pairs += 1
            run += 1
            above += pixels[i - 1, j] != own or (i > 1 and pixels[i - 2, j] != own)
            below += pixels[i + 2, j] != own or (i + 3 < rows and pixels[i + 3, j] != own)
            uneven += pixels[i - 1, j] != pixels[i + 2, j]
            beside += (j > 0 and pixels[i, j - 1] != own) or (j > 1 and pixels[i, j - 2] != own)
    return in_runs / max(pairs, 1)


def _share_of_pairs(pixels: Floats, step: float) -> float:
    """Share of rough pairs of neighbours that are equal beyond what those three rows apart are."""
    equal, next_step, pairs = _rough_pairs(pixels, 1, step)
    if equal <= _SIGMAS**2:
        return 0.0
    equal_apart, next_apart, _ = _rough_pairs(pixels, _APART, step)
    # Of noise finer than its steps as many differ by none as by one up, or one down.
    ratio = max((equal_apart + 1) / (next_apart + 2), 0.5)
    expected = ratio * next_step
    relative = 1 / (equal_apart + 1) + 1 / (next_apart + 2)
    variance = equal + ratio * expected + expected**2 * relative + 1
    excess = equal - expected
    if excess < _SIGMAS * math.sqrt(variance):
        return 0.0
    # Both pairs next to a copy are not rough, and do not count.
    return excess / (pairs + 2 * excess)


@compiled
def _rough_pairs(pixels: Floats, apart: int, step: float) -> tuple[int, int, int]:
    """Pairs of pixels so many rows apart in rough places: equal ones, one step apart, all.

    Both differ from the next outside, these from one another, and the first from one beside it.
    """
    rows, cols = pixels.shape
    equal, next_step, pairs = 0, 0, 0
    for i in range(1, rows - apart - 1):
        for j in range(1, cols - 1):
            own, other = pixels[i, j], pixels[i + apart, j]
            before, behind = pixels[i - 1, j], pixels[i + apart + 1, j]
            outside = (
                _rough(own, before, step)
                and _rough(other, behind, step)
                and _rough(before, behind, step)
            )
            beside = _rough(own, pixels[i, j - 1], step) or _rough(own, pixels[i, j + 1], step)
            if outside and beside:
                difference = abs(own - other)
                pairs += bool(np.isfinite(difference))
                equal += difference < 0.5 * step
                next_step += 0.5 * step <= difference < 1.5 * step
    return equal, next_step, pairs


@inlined
def _rough(one: float, other: float, step: float) -> bool:
    return abs(one - other) >= _ROUGH_STEPS * step
