"""Whether strong and weak structures are blurred equally, as a kernel blurs everything.

A filter that removes noise and keeps edges blurs what is weak and leaves what is strong; clamped
sharpening does the reverse; where the borders of fields have shadows in one image alone, these have
a blur of their own. A single kernel is then none of either. So the low pixels are parted by the
gradient of the model, and the residuals of both parts are fitted by the slopes of the parametric
kernel: gain, shift and variance along rows and columns. The variances have to be equal.

The reference's noise, which is a larger share of weak structures, is taken off as in the fit of
the kernel. Deviations come from the scatter of blocks, so residuals need not be white.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.pair import tuned
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.residual_slopes import TileSlopes, noise_products
from acutance.targets.pair.tile import TapGrid

__all__ = ["blur_difference"]

_VARIANCE: Final[Floats] = np.array([0.0, 0.0, 0.0, 0.5, 0.5])
"""The mean of both variances."""
_BLOCK_PX: Final = 16
_MIN_BLOCKS: Final = 6
_MIN_PIXELS: Final = 60
_MIN_SHARE: Final = 0.01
"""Of the power of a combination of columns, what has to be left without the reference's noise."""
UNKNOWN: Final = Estimate(0.0, math.inf)


class _Pixels(NamedTuple):
    """Low pixels with their columns (n, 5), residuals, and the block they lie in."""

    columns: Floats
    residual: Floats
    block: NDArray[np.intp]

    def part(self, which: NDArray[np.bool_]) -> _Pixels:
        return _Pixels(self.columns[which], self.residual[which], self.block[which])


def blur_difference(
    tiles: Iterable[TileSlopes], grid: TapGrid, gaussian: GaussianFit, fit: KernelFit
) -> Estimate:
    """Variance of the blur of strong structures less that of weak ones, low pixels squared.

    Parameters
    ----------
    tiles : iterable of TileSlopes
    grid : TapGrid
    gaussian : GaussianFit
    fit : KernelFit

    Returns
    -------
    Estimate
        With an infinite deviation where there are too few pixels of either.
    """
    found = [_pixels(tile) for tile in tiles if tile.columns.size]
    if not found:
        return UNKNOWN
    every = _Pixels(*(np.concatenate(column) for column in zip(*found, strict=True)))
    steepness = np.sum(every.columns[:, 1:3] ** 2, axis=1)
    products = noise_products(grid, gaussian, fit)
    strong = steepness > _parting(steepness)
    fits = [_variance(every.part(which), products, fit) for which in (strong, ~strong)]
    (one, one_std), (other, other_std) = fits
    std = math.hypot(one_std, other_std)
    return Estimate(one - other, std) if math.isfinite(std) else UNKNOWN


def _pixels(tile: TileSlopes) -> _Pixels:
    """The usable low pixels of a tile, its columns about their mean."""
    down, across = (
        (place + start) // _BLOCK_PX
        for place, start in zip(np.nonzero(tile.usable), tile.place, strict=True)
    )
    columns = tile.columns - tile.columns.mean(axis=0)
    return _Pixels(columns, tile.rest, down * 2**20 + across)


def _parting(steepness: Floats) -> float:
    """The steepness below which lies the share of its sum that counts as weak."""
    ordered = np.sort(steepness)
    total = np.cumsum(ordered)
    return float(ordered[np.searchsorted(total, tuned.WEAK_SHARE * total[-1])])


def _variance(pixels: _Pixels, products: Floats, fit: KernelFit) -> tuple[float, float]:
    """By how much the blur's variance differs in some pixels, and its standard deviation."""
    nothing = 0.0, math.inf
    count = pixels.residual.size
    blocks, of = np.unique(pixels.block, return_inverse=True)
    if blocks.size < _MIN_BLOCKS or count < _MIN_PIXELS:
        return nothing
    columns = pixels.columns - pixels.columns.mean(axis=0)
    rest = pixels.residual - pixels.residual.mean()
    own, cross = products[:5, :5], products[:5, 5]
    whole = columns.T @ columns
    power = fit.high_noise.power
    gram = whole - count * power * own
    scale = np.sqrt(whole.diagonal())
    if not np.linalg.eigvalsh(gram / np.outer(scale, scale))[0] > _MIN_SHARE:
        return nothing
    response = np.linalg.solve(gram, _VARIANCE)
    update = np.linalg.solve(gram, columns.T @ rest + count * power * cross)
    left = rest - columns @ update
    by_noise = cross + own @ update
    scores = left * (columns @ response) + power * float(response @ by_noise)
    scatter = np.bincount(of, scores)
    white = float(np.mean(left**2) * (response @ whole @ response))
    variance = max(float(scatter @ scatter) * blocks.size / (blocks.size - 1), white)
    uncertain = count * fit.high_noise.power_std * float(response @ by_noise)
    return float(_VARIANCE @ update), math.hypot(math.sqrt(variance), uncertain)
