"""Residuals of a pair: their outliers, their correlation, and what the reference's noise does.

Residuals of real pairs are not white: the two bands see other colours, so fields differ as a
whole. A causal autoregression of the residuals (Whittle, Biometrika 41, 434, 1954) takes the
correlation out: the fit is made on the part of a pixel that its neighbours do not predict.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.noise import Correlation, correlation
from acutance.targets.pair import tuned
from acutance.targets.pair.tile import PAD_PX, TapGrid, core

__all__ = ["Whitening", "fine_noise", "noise_gram", "whitening_of"]

LAGS: Final = tuple(
    (down, right)
    for down in range(PAD_PX + 1)
    for right in range(-PAD_PX, PAD_PX + 1)
    if (down, right) > (0, 0)
)
"""Neighbours above, and to the left in the same row: (rows up, columns to the left)."""
_MIN_PAIRS = 400
_GAP_PX = 2
NO_CORRELATION: Final = Correlation(1.0, 0.0, 0.0)
_RIDGE = 1e-6
_ORDER = 6
_BLOCK = 24


@dataclass(frozen=True, eq=False)
class Whitening:
    """A pixel minus what its neighbours predict.

    Parameters
    ----------
    weights : (12,) array
        Of the neighbours; all 0 for white residuals.
    correlation : Correlation
        Of the residuals before whitening.
    """

    weights: Floats
    correlation: Correlation = NO_CORRELATION

    @property
    def needed(self) -> bool:
        """Whether it changes anything."""
        return bool(np.any(self.weights))

    def __call__(self, field: Floats) -> Floats:
        """The core of a tile's field, (h, w, ...), whitened; NaN where a neighbour is missing."""
        result = core(field)
        if not self.needed:
            return result
        height, width = result.shape[:2]
        result = result.copy()
        for weight, (down, right) in zip(self.weights, LAGS, strict=True):
            top, left = PAD_PX - down, PAD_PX - right
            result -= weight * field[top : top + height, left : left + width]
        return result


WHITE: Final = Whitening(np.zeros(len(LAGS)))


def whitening_of(residuals: Iterable[Floats]) -> Whitening:
    """The autoregression of residual fields (with their pads; NaN where unusable)."""
    size = len(LAGS)
    gram, projection = np.zeros((size, size)), np.zeros(size)
    count, cores = 0, []
    for field in residuals:
        own = core(field)
        height, width = own.shape
        near = np.stack(
            [
                field[PAD_PX - d : PAD_PX - d + height, PAD_PX - r : PAD_PX - r + width]
                for d, r in LAGS
            ],
            axis=-1,
        )
        usable = np.isfinite(own) & np.isfinite(near).all(axis=-1)
        x, y = near[usable], own[usable]
        gram += x.T @ x
        projection += x.T @ y
        count += y.size
        cores.append(own)
    if count < _MIN_PAIRS or not np.trace(gram) > 0:
        return WHITE
    found = _correlation(cores)
    if found.significant == 0:
        return Whitening(np.zeros(size), found)
    ridge = _RIDGE * np.trace(gram) / size * np.eye(size)
    return Whitening(np.linalg.solve(gram + ridge, projection), found)


def _correlation(fields: list[Floats]) -> Correlation:
    """Correlation within fields: one below the other, further apart than it is looked for."""
    height = np.cumsum([0, *(field.shape[0] + _GAP_PX for field in fields)])
    usable = [np.isfinite(field) for field in fields]
    rows, cols = zip(*map(np.nonzero, usable), strict=True)
    return correlation(
        np.concatenate([field[known] for field, known in zip(fields, usable, strict=True)]),
        np.concatenate([row + top for row, top in zip(rows, height[:-1], strict=True)]),
        np.concatenate(cols),
    )


def fine_noise(fine: Floats) -> float:
    """Standard deviation of the reference's noise, from the quietest quarter of its blocks.

    Sixth differences along both axes see only what is next to Nyquist both ways, where a sensor
    passes least of the scene; what is left of its texture counts as noise.
    """
    both = np.diff(np.diff(fine, _ORDER, axis=0), _ORDER, axis=1)
    height, width = (size // _BLOCK for size in both.shape)
    if height * width == 0:
        return 0.0
    blocks = both[: height * _BLOCK, : width * _BLOCK]
    blocks = blocks.reshape(height, _BLOCK, width, _BLOCK).transpose(0, 2, 1, 3)
    powers = np.mean(blocks.reshape(height * width, -1) ** 2, axis=1)
    usable = powers[np.isfinite(powers)]
    if usable.size == 0:
        return 0.0
    return math.sqrt(float(np.quantile(usable, tuned.QUIET_SHARE))) / math.comb(2 * _ORDER, _ORDER)


def noise_gram(taps: Floats, grid: TapGrid, whitening: Whitening) -> Floats:
    """Products (k, k) that white noise of variance 1 in the reference's samples makes.

    Parameters
    ----------
    taps : (k, taps down, taps across) array
        The columns of the design as kernels.
    grid : TapGrid
    whitening : Whitening
    """
    if not whitening.needed:
        flat = taps.reshape(taps.shape[0], -1)
        return np.asarray(flat @ flat.T)
    down, across = grid.down.per_px, grid.across.per_px
    rows, cols = PAD_PX * down, PAD_PX * across
    wide = np.pad(taps, ((0, 0), (rows, 0), (cols, cols)))
    height, width = taps.shape[1:]
    for weight, (up, left) in zip(whitening.weights, LAGS, strict=True):
        top, first = rows - up * down, cols - left * across
        wide[:, top : top + height, first : first + width] -= weight * taps
    flat = wide.reshape(taps.shape[0], -1)
    return np.asarray(flat @ flat.T)
