"""Regions of a pair: their own shift, blur, gain and residual, and the map of the residuals."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.raster import Box
from acutance.targets.pair import tuned
from acutance.targets.pair.residual_slopes import TileSlopes

__all__ = ["LocalFit", "ResidualMap", "fit_regions"]

_MIN_PIXELS = 60
_MAX_SIDE = 384


@dataclass(frozen=True, eq=False)
class LocalFit(ShortRepr):
    """How regions differ from the common kernel, each (rows, columns) of the map.

    NaN where a region has too few pixels, or no structure beyond the reference's noise.

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
    def shift_scatter_px(self) -> float:
        """Standard deviation of the regions' shifts beyond their own uncertainty."""
        usable = np.isfinite(self.shift_row_px) & (self.shift_std_px < 0.5)
        if usable.sum() < 3:
            return 0.0
        own = float(np.mean(self.shift_std_px[usable] ** 2))
        found = max(float(np.var(self.shift_row_px[usable])),
                    float(np.var(self.shift_col_px[usable])))  # fmt: skip
        return float(np.sqrt(max(found - own, 0.0)))


@dataclass(frozen=True, eq=False)
class ResidualMap:
    """Residuals over the low image, thinned to at most 384 pixels a side.

    Parameters
    ----------
    box : Box
        The low pixels shown.
    step : int
        Low pixels from one value to the next.
    values : (rows, cols) array
        In units of the low image; NaN where left out.
    """

    box: Box
    step: int
    values: Floats

    @classmethod
    def empty(cls, box: Box) -> ResidualMap:
        """A map of the low pixels of a box, nothing known yet."""
        step = max(1, -(-max(box.shape) // _MAX_SIDE))
        return cls(box, step, np.full([-(-size // step) for size in box.shape], np.nan))

    def fill(self, place: tuple[int, int], residual: Floats) -> None:
        """Put in a tile's residual, whose first pixel lies at a place of the low image."""
        rows = np.arange(residual.shape[0]) + place[0] - self.box.row
        cols = np.arange(residual.shape[1]) + place[1] - self.box.col
        down = (rows >= 0) & (rows < self.box.height) & (rows % self.step == 0)
        across = (cols >= 0) & (cols < self.box.width) & (cols % self.step == 0)
        part = residual[np.ix_(down, across)]
        places = np.ix_(rows[down] // self.step, cols[across] // self.step)
        self.values[places] = np.where(np.isfinite(part), part, self.values[places])


def fit_regions(
    tiles: Iterable[TileSlopes], shape: tuple[int, int], box: Box, noise: Floats
) -> tuple[LocalFit, ResidualMap]:
    """Fit how every region differs to the residuals of the common kernel, and map these.

    Parameters
    ----------
    tiles : iterable of TileSlopes
    shape : (int, int)
        Rows and columns of the map.
    box : Box
        The low pixels that the map of residuals shows.
    noise : (6, 6) array
        Products of the reference's noise in a pixel's slopes and model. In the slopes it makes a
        regression too small; in residuals it is the model's, with the opposite sign.
    """
    regions = shape[0] * shape[1]
    gram, projection = np.zeros((regions, 6, 6)), np.zeros((regions, 6))
    power, count = np.zeros(regions), np.zeros(regions)
    shown = ResidualMap.empty(box)
    for tile in tiles:
        shown.fill(tile.place, tile.residual)
        rest = tile.rest
        if not rest.size:
            continue
        columns = np.column_stack([tile.columns, np.ones(rest.size)])
        columns[:, 0] -= columns[:, 0].mean()
        for region in np.unique(tile.regions).tolist():
            own = tile.regions == region
            part = columns[own]
            gram[region] += part.T @ part
            projection[region] += part.T @ rest[own]
            power[region] += float(rest[own] @ rest[own])
            count[region] += int(own.sum())
    return _solved(gram, projection, power, count, noise, shape), shown


def _solved(
    gram: Floats,
    projection: Floats,
    power: Floats,
    count: Floats,
    noise: Floats,
    shape: tuple[int, int],
) -> LocalFit:
    updates, stds = np.full((count.size, 6), np.nan), np.full((count.size, 6), np.nan)
    residual = np.full(count.size, np.nan)
    by_noise, into_rest = np.zeros((6, 6)), np.zeros(6)
    by_noise[:5, :5], into_rest[:5] = noise[:5, :5], noise[:5, 5]
    for region in np.flatnonzero(count >= _MIN_PIXELS).tolist():
        whole, number = gram[region], count[region]
        residual[region] = np.sqrt(power[region] / number)
        scale = np.sqrt(np.maximum(whole.diagonal(), 1e-300))
        scaled = whole / np.outer(scale, scale)
        if np.linalg.cond(scaled) > 1e10:
            continue
        taken = number * by_noise / np.outer(scale, scale)
        shares = np.linalg.eigvals(np.linalg.solve(scaled, taken)).real
        if shares.max() > tuned.MAX_NOISE_SHARE:
            continue
        inverse = np.linalg.inv(scaled - taken) / np.outer(scale, scale)
        updates[region] = inverse @ (projection[region] + number * into_rest)
        variance = np.einsum("ij,jk,ik->i", inverse, whole, inverse)
        stds[region] = residual[region] * np.sqrt(variance)
    field = [column.reshape(shape) for column in updates.T]
    deviation = [column.reshape(shape) for column in stds.T]
    return LocalFit(
        shift_row_px=field[1],
        shift_col_px=field[2],
        variance_down_px2=field[3],
        variance_across_px2=field[4],
        shift_std_px=np.maximum(deviation[1], deviation[2]),
        variance_std_px2=np.maximum(deviation[3], deviation[4]),
        gain=1 + field[0],
        residual=residual.reshape(shape),
        pixels=count.reshape(shape),
    )
