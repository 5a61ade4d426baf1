"""What every low pixel would change by if the kernel did, beside its residual.

The parametric kernel has slopes: gain, shift and variance along rows and columns. Fitted to the
residuals of the common kernel they show how a part of the pixels differs from the whole: regions
(`local`), or strong and weak structures (`equal_blur`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.noise import WHITE, noise_gram
from acutance.targets.pair.tile import TapGrid, Tiles, core, filtered

__all__ = ["SLOPES", "TileSlopes", "noise_products", "residual_slopes"]

SLOPES: Final = ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2))
"""Columns of `AxisGaussian.taps` along rows and columns: gain, shifts, variances."""


class TileSlopes(NamedTuple):
    """The low pixels of a tile: what is left of them, and the slopes there.

    Attributes
    ----------
    place : (int, int)
        Row and column of the tile's first pixel in the low image.
    residual : (h, w) array
        Of the tile with its pads; NaN where left out.
    usable : (h', w') bool array
        Which pixels of its core have a residual: n.
    columns : (n, 5) array
        Their slopes, in the order of `SLOPES`.
    regions : (n,) int array
        Which region of the map of local statistics each belongs to.
    """

    place: tuple[int, int]
    residual: Floats
    usable: NDArray[np.bool_]
    columns: Floats
    regions: NDArray[np.intp]

    @property
    def rest(self) -> Floats:
        """Residuals of the usable pixels, (n,)."""
        return core(self.residual)[self.usable]


def residual_slopes(
    tiles: Tiles, grid: TapGrid, gaussian: GaussianFit, fit: KernelFit
) -> Iterator[TileSlopes]:
    """Slopes and residuals, tile by tile.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    gaussian : GaussianFit
        Its slopes are those of the kernel.
    fit : KernelFit
        The common kernel.
    """
    down, across = gaussian.down.taps(grid.down)[:, :3], gaussian.across.taps(grid.across)[:, :3]
    for tile, residual in zip(tiles(), fit.residuals(tiles), strict=True):
        usable = np.isfinite(core(residual))
        field = core(filtered(tile, grid, down, across))[usable]
        columns = gaussian.gain * np.stack([field[:, i, j] for i, j in SLOPES], axis=1)
        yield TileSlopes(tile.place, residual, usable, columns, core(tile.regions)[usable])


def noise_products(grid: TapGrid, gaussian: GaussianFit, fit: KernelFit) -> Floats:
    """Products (6, 6) of the reference's noise of variance 1 in the slopes and in the model.

    Parameters
    ----------
    grid : TapGrid
    gaussian : GaussianFit
        Its slopes are those of the kernel.
    fit : KernelFit
        The common kernel, which makes the model.
    """
    down = gaussian.down.taps(grid.down).T
    across = gaussian.across.taps(grid.across).T
    slopes = [gaussian.gain * np.outer(down[i], across[j]) for i, j in SLOPES]
    return noise_gram(np.stack([*slopes, fit.kernel.taps]), grid, WHITE)
