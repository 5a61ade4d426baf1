"""Regions of a pair: their own shift, blur, gain and residual, and the map of the residuals."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.raster import Box
from acutance.targets.pair import tuned
from acutance.targets.pair.residual_slopes import TileSlopes

__all__ = ["LocalFit", "ResidualMap", "fit_regions"]

_MIN_PIXELS = 60
_MIN_FREEDOM = 6
"""Quarters beyond one a region from which their scatter is read, as `tuned.MIN_REGIONS`."""
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
        Their standard deviations (the larger one of both axes), the correlation of neighbouring
        residuals counted.
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
    shown = ResidualMap.empty(box)
    quarters: dict[tuple[int, int], Floats] = defaultdict(lambda: np.zeros((7, 7)))
    level = None
    for tile in tiles:
        shown.fill(tile.place, tile.residual)
        rest = tile.rest
        if not rest.size:
            continue
        columns = np.column_stack([tile.columns, np.ones(rest.size), rest])
        level = columns[:, 0].mean() if level is None else level
        columns[:, 0] -= level
        places, of = np.unique(
            np.stack([tile.regions, _quarters(tile, shape, box)]), axis=1, return_inverse=True
        )
        for number, (region, quarter) in enumerate(places.T.tolist()):
            part = columns[of.ravel() == number]
            quarters[region, quarter] += part.T @ part
    return _solved(quarters, noise, shape), shown


def _quarters(tile: TileSlopes, shape: tuple[int, int], box: Box) -> NDArray[np.intp]:
    """Which quarter of its region each usable pixel of a tile lies in, (n,)."""
    down, across = (
        (place + start - first) * 2 * parts // size % 2
        for place, start, first, parts, size in zip(
            np.nonzero(tile.usable), tile.place, (box.row, box.col), shape, box.shape, strict=True
        )
    )
    return np.asarray(2 * down + across)


def _solved(
    quarters: Mapping[tuple[int, int], Floats], noise: Floats, shape: tuple[int, int]
) -> LocalFit:
    """Fit every region to the products of its quarters' slopes, constant and residuals, (7, 7)."""
    regions = defaultdict(list)
    for (region, _), products in quarters.items():
        regions[region].append(products)
    size = shape[0] * shape[1]
    count, residual = np.zeros(size), np.full(size, np.nan)
    updates, variances = np.full((size, 6), np.nan), np.full((size, 6), np.nan)
    found, expected = np.zeros(6), np.zeros(6)
    for region, own in regions.items():
        parts = np.stack(own)
        count[region] = parts[:, 5, 5].sum()
        if count[region] < _MIN_PIXELS:
            continue
        residual[region] = math.sqrt(parts[:, 6, 6].sum() / count[region])
        fit = _region_fit(parts, noise)
        if fit is None:
            continue
        updates[region], variances[region] = fit.update, fit.variance
        found += fit.scatter
        expected += fit.white_scatter
    # A region has four quarters: how much more these scatter than by white residuals is of all.
    enough = expected >= _MIN_FREEDOM
    inflation = np.where(enough, np.maximum(found / np.where(enough, expected, 1.0), 1.0), 1.0)
    field = [column.reshape(shape) for column in updates.T]
    deviation = [column.reshape(shape) for column in np.sqrt(inflation * variances).T]
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


class _RegionFit(NamedTuple):
    """What a region's slopes and constant explain of its residuals, (6,) each.

    Attributes
    ----------
    update, variance : (6,) array
        The coefficients, and their variances if residuals are white.
    scatter, white_scatter : (6,) array
        Sum over the quarters of the square of what each moves a coefficient by, about that of all,
        over that variance; and what white residuals would give.
    """

    update: Floats
    variance: Floats
    scatter: Floats
    white_scatter: Floats


def _region_fit(parts: Floats, noise: Floats) -> _RegionFit | None:
    """The fit of a region by the products of its quarters; ``None`` where these determine none."""
    count = parts[:, 5, 5]
    by_noise = np.zeros((7, 7))
    by_noise[:5, :5] = noise[:5, :5]
    # The model is taken off the low image in a residual.
    by_noise[:5, 6] = by_noise[6, :5] = -noise[:5, 5]
    whole = parts.sum(axis=0)
    gram, projection = whole[:6, :6], whole[:6, 6]
    scale = np.sqrt(np.maximum(gram.diagonal(), 1e-300))
    scaled = gram / np.outer(scale, scale)
    if np.linalg.cond(scaled) > 1e10:
        return None
    taken = count.sum() * by_noise[:6, :6] / np.outer(scale, scale)
    shares = np.linalg.eigvals(np.linalg.solve(scaled, taken)).real
    if shares.max() > tuned.MAX_NOISE_SHARE:
        return None
    inverse = np.linalg.inv(scaled - taken) / np.outer(scale, scale)
    update = inverse @ (projection - count.sum() * by_noise[:6, 6])
    left = max(float(whole[6, 6] - 2 * update @ projection + update @ gram @ update), 0.0)
    white = np.einsum("ij,jk,ik->i", inverse, gram, inverse)
    variance = left / (count.sum() - 6) * white
    true = parts - count[:, None, None] * by_noise
    scores = (true[:, :6, 6] - true[:, :6, :6] @ update) @ inverse.T
    share = np.einsum("ij,bjk,ik->bi", inverse, parts[:, :6, :6], inverse) / white
    scatter = np.sum(scores**2, axis=0) / np.where(variance > 0, variance, np.inf)
    return _RegionFit(update, variance, scatter, np.sum(share * (1 - share), axis=0))
