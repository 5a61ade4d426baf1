"""Residuals of a pair: their outliers, their correlation, and what the reference's noise does.

Residuals of real pairs are not white: the two bands see other colours, so fields differ as a
whole. A causal autoregression of the residuals (Whittle, Biometrika 41, 434, 1954) takes the
correlation out: the fit is made on the part of a pixel that its neighbours do not predict.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.noise import Correlation, correlation
from acutance.targets.pair import tuned
from acutance.targets.pair.tile import PAD_PX, TapGrid, core

__all__ = ["NO_NOISE", "HighNoise", "Whitening", "noise_gram", "whitening_of"]

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
_LOW_ORDER = 3
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


class HighNoise(NamedTuple):
    """The reference's noise in a sample.

    Attributes
    ----------
    power : float
        Its variance.
    power_std : float
        Standard deviation of that.
    """

    power: float
    power_std: float

    @classmethod
    def of_std(cls, std: float) -> HighNoise:
        """Noise of a standard deviation that was stated."""
        return cls(std**2, tuned.NOISE_POWER_STD * std**2)

    @classmethod
    def of_samples(cls, fine: Floats) -> HighNoise:
        """Noise of a reference's samples, from the quietest quarter of its blocks.

        Sixth differences along both axes see only what is next to Nyquist both ways, where a sensor
        passes least of the scene. Noise has the same power in third differences, which reach to
        lower frequencies, and texture about twice as much: by so much as they have more, what is
        next to Nyquist may be texture. Half of that is taken for it.
        """
        powers = [_block_powers(fine, order) for order in (_ORDER, _LOW_ORDER)]
        usable = np.isfinite(powers[0]) & np.isfinite(powers[1])
        if not usable.any():
            return NO_NOISE
        high, low = (part[usable] for part in powers)
        bound = float(np.quantile(high, tuned.QUIET_SHARE))
        # Of blocks whose sixth differences are small by chance, third ones are less so: chosen by
        # these they would show texture in white noise.
        chosen_by = low + tuned.QUIET_TEXTURE * (low - high)
        quiet = chosen_by <= np.quantile(chosen_by, tuned.QUIET_SHARE)
        texture = float(np.clip(np.mean((low - high)[quiet]), 0.0, bound))
        power = bound - 0.5 * texture
        return cls(power, math.hypot(tuned.NOISE_POWER_STD * power, 0.5 * texture))

    def times(self, factor: float) -> HighNoise:
        """The noise with its power multiplied."""
        return HighNoise(factor * self.power, factor * self.power_std)

    @property
    def std(self) -> float:
        """Standard deviation of the noise."""
        return math.sqrt(self.power)


NO_NOISE: Final = HighNoise(0.0, 0.0)


def _block_powers(fine: Floats, order: int) -> Floats:
    """Power of differences along both axes in every block, that of white noise of variance 1."""
    both = np.diff(np.diff(fine, order, axis=0), order, axis=1)
    height, width = ((size - 2 * _ORDER) // _BLOCK for size in fine.shape)
    if min(height, width) < 1:
        return np.zeros(0)
    start = (_ORDER - order) // 2
    blocks = both[start : start + height * _BLOCK, start : start + width * _BLOCK]
    blocks = blocks.reshape(height, _BLOCK, width, _BLOCK).transpose(0, 2, 1, 3)
    powers = np.mean(blocks.reshape(height * width, -1) ** 2, axis=1)
    return np.asarray(powers / math.comb(2 * order, order) ** 2)


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
