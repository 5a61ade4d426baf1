"""What single regions of a pair say: their own shift, blur, gain and residual."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.pair.first_fit import BlurFit
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.tile import TapGrid, Tiles, core, filtered

__all__ = ["LocalFit", "fit_regions"]

_LEAST_PIXELS = 60


@dataclass(frozen=True, eq=False)
class LocalFit:
    """Departures of the regions from the common kernel, each (rows, columns) of the map.

    NaN where a region has too few pixels.

    Parameters
    ----------
    shift_row_px, shift_col_px : array
        Displacement against the common one, in low pixels.
    variance_down_px2, variance_across_px2 : array
        Additional variance of the kernel along rows and columns.
    shift_std_px, variance_std_px2 : array
        Their standard deviations (the larger one of both axes).
    gain : array
        Relative to the common one.
    residual : array
        Root mean square, in units of the low image.
    pixels : array
        Number of low pixels used.
    """

    shift_row_px: Floats
    shift_col_px: Floats
    variance_down_px2: Floats
    variance_across_px2: Floats
    shift_std_px: Floats
    variance_std_px2: Floats
    gain: Floats
    residual: Floats
    pixels: Floats

    @property
    def shift_spread_px(self) -> float:
        """Standard deviation of the regions' shifts beyond their own uncertainty."""
        usable = np.isfinite(self.shift_row_px) & (self.shift_std_px < 0.5)
        if usable.sum() < 3:
            return 0.0
        own = float(np.mean(self.shift_std_px[usable] ** 2))
        found = max(float(np.var(self.shift_row_px[usable])),
                    float(np.var(self.shift_col_px[usable])))  # fmt: skip
        return float(np.sqrt(max(found - own, 0.0)))


def fit_regions(
    tiles: Tiles,
    grid: TapGrid,
    blur: BlurFit,
    fit: KernelFit,
    shape: tuple[int, int],
    keep: Callable[[tuple[int, int], Floats], None],
) -> LocalFit:
    """Fit every region's departures to the residuals of the common kernel.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    blur : BlurFit
        Its slopes are those of the kernel.
    fit : KernelFit
    shape : (int, int)
        Rows and columns of the map.
    keep : function of (place, residual)
        Gets every tile's residual and the place of its first pixel.
    """
    regions = shape[0] * shape[1]
    gram, projection = np.zeros((regions, 6, 6)), np.zeros((regions, 6))
    power, count = np.zeros(regions), np.zeros(regions)
    for tile, residual in zip(tiles(), fit.residuals(tiles), strict=True):
        keep(tile.place, residual)
        rest = core(residual)
        usable = np.isfinite(rest)
        if not usable.any():
            continue
        slopes = blur.down.taps(grid.down)[:, :3], blur.across.taps(grid.across)[:, :3]
        field = core(filtered(tile, grid, *slopes))
        pairs = ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2))
        columns = np.stack([field[usable][:, i, j] for i, j in pairs], axis=1) * blur.gain
        columns = np.column_stack([columns, np.ones(columns.shape[0])])
        columns[:, 0] -= columns[:, 0].mean()
        rest, of = rest[usable], core(tile.regions)[usable]
        for region in np.unique(of).tolist():
            own = of == region
            part = columns[own]
            gram[region] += part.T @ part
            projection[region] += part.T @ rest[own]
            power[region] += float(rest[own] @ rest[own])
            count[region] += int(own.sum())
    return _solved(gram, projection, power, count, shape)


def _solved(
    gram: Floats, projection: Floats, power: Floats, count: Floats, shape: tuple[int, int]
) -> LocalFit:
    moves, stds = np.full((count.size, 6), np.nan), np.full((count.size, 6), np.nan)
    noise = np.full(count.size, np.nan)
    for region in np.flatnonzero(count >= _LEAST_PIXELS).tolist():
        scale = np.sqrt(np.maximum(gram[region].diagonal(), 1e-300))
        scaled = gram[region] / np.outer(scale, scale)
        noise[region] = np.sqrt(power[region] / count[region])
        if np.linalg.cond(scaled) > 1e10:
            continue
        inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
        moves[region] = inverse @ projection[region]
        stds[region] = noise[region] * np.sqrt(inverse.diagonal())
    field = [column.reshape(shape) for column in moves.T]
    spread = [column.reshape(shape) for column in stds.T]
    return LocalFit(
        shift_row_px=field[1],
        shift_col_px=field[2],
        variance_down_px2=field[3],
        variance_across_px2=field[4],
        shift_std_px=np.maximum(spread[1], spread[2]),
        variance_std_px2=np.maximum(spread[3], spread[4]),
        gain=1 + field[0],
        residual=noise.reshape(shape),
        pixels=count.reshape(shape),
    )
