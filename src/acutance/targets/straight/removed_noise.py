"""Noise that was removed from flat ground and left at borders: filters that keep edges.

A filter of single pixels by pixels like them (bilateral, non-local means, thresholds of wavelets)
finds many like them on a plateau and few on a border. What is left of the noise is smooth on the
plateaus, and white at the border, with several times their variance. A rough border has that
variance too, but moves the pixels on both sides of its line together; and interpolation at places
that drift moves them against one another: neither leaves neighbours independent.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.check import Check, Limits, answer
from acutance.targets.straight.check_data import STEEP_SHARE, CheckData

__all__ = ["removed_noise"]

_SMOOTH: Final = 0.2
"""Correlation of neighbours on the plateaus from which on their noise is smooth."""
_MIN_PAIRS: Final = 25
_SIGMAS, _LESS = 2.5, 0.5
"""Neighbours at the border are independent within so many deviations, or less alike than those of
the plateaus by this factor: some of the border was filtered, too."""
_LEAST: Final = 1.5
"""Noise of the border over that of the plateaus up to which its pixels are not looked at."""


def removed_noise(data: CheckData, limits: Limits) -> Check:
    """How much more the pixels of the border scatter than those of the plateaus, each by itself."""
    border = data.border
    smooth, ratio = data.across.significant, 1.0
    if smooth > _SMOOTH and border.power > _LEAST**2 * border.noise > 0:
        pairs, products = _neighbours(
            data.residual, data.slope, data.near, *data.trimmed.pixels.at, STEEP_SHARE
        )
        enough = pairs.min() >= _MIN_PAIRS
        if enough and _are_unlike(pairs, np.abs(products) / border.power, smooth):
            ratio = math.sqrt(border.power / border.noise)
    found = "no noise was found at the border that plateaus do not have"
    if ratio > 1:
        found = (
            f"single pixels of the border scatter {ratio:.1f} times as much as those of the "
            f"plateaus, whose neighbours' noise correlates by {abs(data.across.strongest):.2f}"
        )
    return answer("removed_noise", ratio, found, limits)


def _are_unlike(pairs: Floats, correlation: Floats, smooth: float) -> bool:
    """Whether neighbours at the border correlate by no more than chance, or less than others."""
    return bool(np.all(correlation < np.maximum(_SIGMAS / np.sqrt(pairs), _LESS * smooth)))


@compiled
def _neighbours(
    residual: Floats, slope: Floats, near: NDArray[np.intp],
    row: NDArray[np.intp], col: NDArray[np.intp], steep_share: float,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Pairs of neighbours along columns and along rows where the image is steep, (2,).

    And the mean products of their residuals.
    """
    steepest = 0.0
    for one in slope:
        steepest = max(steepest, abs(one))
    field = np.full((row.max() + 2, col.max() + 2), np.nan)
    for i in range(near.size):
        if abs(slope[i]) > steep_share * steepest:
            field[row[near[i]], col[near[i]]] = residual[near[i]]
    pairs, products = np.zeros(2), np.zeros(2)
    for i in range(field.shape[0] - 1):
        for j in range(field.shape[1] - 1):
            for axis in range(2):
                product = field[i, j] * field[i + 1 - axis, j + axis]
                if np.isfinite(product):
                    pairs[axis] += 1.0
                    products[axis] += product
    return pairs, products / np.maximum(pairs, 1.0)
