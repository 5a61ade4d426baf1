"""Odd and even columns, or rows, that differ: two readouts with gains or offsets of their own.

Each pixel of a plateau minus the mean of its neighbours on both sides, counted with a sign that
alternates: neither gradients nor noise have a mean of it. Lines across the columns are independent
samples, so that their scatter says what chance makes.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.check import Check, Limits, answer
from acutance.targets.straight.check_data import CheckData

__all__ = ["odd_even"]

_SIGMAS: Final = 5.0
_MIN_LINES: Final = 8


def odd_even(data: CheckData, limits: Limits) -> Check:
    """How much odd and even columns or rows of the plateaus differ, beyond what noise explains."""
    rows, cols = data.trimmed.pixels.at
    worst, which = 0.0, "columns"
    for side in data.plateaus:
        for name, line, place in (("columns", rows, cols), ("rows", cols, rows)):
            value, std = _difference(data.residual, side, line, place)
            if abs(value) > max(_SIGMAS * std, worst):
                worst, which = abs(value), name
    found = f"odd and even {which} differ by {100 * worst:.2f} % of the contrast"
    return answer("odd_even", worst, found, limits)


@compiled
def _difference(
    residual: Floats, used: NDArray[np.bool_], line: NDArray[np.intp], place: NDArray[np.intp]
) -> tuple[float, float]:
    """Mean of odd minus even places of residuals, and its standard deviation; 0 if unknown.

    The larger by lines and by places: a furrow or a road along the lines is a few places alone.
    """
    lines, places = line.max() + 1, place.max() + 1
    field = np.full((lines, places), np.nan)
    for k in range(residual.size):
        if used[k]:
            field[line[k], place[k]] = residual[k]
    sums, counts = np.zeros((2, max(lines, places))), np.zeros((2, max(lines, places)))
    for i in range(lines):
        for j in range(1, places - 1):
            off = field[i, j] - 0.5 * (field[i, j - 1] + field[i, j + 1])
            if np.isfinite(off):
                signed = off if j % 2 else -off
                sums[0, i] += signed
                sums[1, j] += signed
                counts[0, i] += 1
                counts[1, j] += 1
    if min(np.count_nonzero(counts[0]), np.count_nonzero(counts[1])) < _MIN_LINES:
        return 0.0, np.inf
    total = counts[0].sum()
    difference = sums[0].sum() / total
    by_line = sums[0] - difference * counts[0]
    by_place = sums[1] - difference * counts[1]
    # Neighbouring lines of a resampled image share noise.
    shared = max((by_line[1:] * by_line[:-1]).sum(), 0.0)
    variance = max((by_line**2).sum() + 2 * shared, (by_place**2).sum())
    return difference, math.sqrt(variance) / total
