"""Parts of a pair that do not show the same ground: clouds, their shadows, changes.

Robust weights cope with what is the smaller part of a scene. A cloud over half of it has to go
before: block by block, where the low image does not follow the high one at all. Of a block that
single defective pixels keep from following only these are taken out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.pair import tuned
from acutance.targets.pair.axis_gaussian import AxisGaussian
from acutance.targets.pair.tile import PairTile, TapGrid, Tiles, core, filtered

__all__ = ["ScreenedTiles", "screened"]

_BLOCK_PX = 8
_MIN_PIXELS = 16
_MAX_SINGLE = 2
"""Pixels of a block that may be defective one by one; where more are off, the block is."""


@dataclass(frozen=True, eq=False)
class ScreenedTiles:
    """Tiles without the blocks that do not show the same.

    Parameters
    ----------
    tiles : Tiles
    masks : mapping from place to (h, w) bool arrays
        The pixels that were taken out of the tile at that place.
    left_out : int
        How many pixels those are.
    """

    tiles: Tiles
    masks: Mapping[tuple[int, int], NDArray[np.bool_]]
    left_out: int

    def __call__(self) -> Iterator[PairTile]:
        """The tiles, from the first."""
        for tile in self.tiles():
            mask = self.masks.get(tile.place)
            yield tile if mask is None else replace(tile, low=np.where(mask, np.nan, tile.low))


@dataclass(frozen=True, eq=False)
class _Block:
    """The usable pixels of a block, low ones and model about their means, and their products."""

    tile: tuple[int, int]
    rows: slice
    cols: slice
    usable: NDArray[np.bool_]
    y: Floats
    m: Floats
    low: float
    model: float
    product: float

    @classmethod
    def of(
        cls, tile: tuple[int, int], rows: slice, cols: slice,
        usable: NDArray[np.bool_], y: Floats, m: Floats,
    ) -> _Block:  # fmt: skip
        y, m = y - y.mean(), m - m.mean()
        return cls(tile, rows, cols, usable, y, m, float(y @ y), float(m @ m), float(y @ m))

    @property
    def count(self) -> int:
        return self.y.size

    @property
    def follows(self) -> bool:
        return self.product > tuned.BLOCK_FOLLOWS * math.sqrt(self.low * self.model) > 0

    def residual(self, gain: float) -> float:
        """Power that the model with this gain leaves."""
        return max(self.low - 2 * gain * self.product + gain**2 * self.model, 0.0)

    def is_off(self, gain: float, noise: float) -> bool:
        """Whether it does not show the same, noise being the power of a pixel."""
        rest = self.residual(gain)
        return (
            rest > tuned.BLOCK_NOISES**2 * noise * self.count
            and rest > tuned.BLOCK_OFF**2 * gain**2 * self.model
        )

    def taken_out(self, gain: float, noise: float) -> NDArray[np.bool_]:
        """The pixels of a block that is off: single ones, if it shows the same without them."""
        rest = self.y - gain * self.m
        order = np.argsort(np.abs(rest - np.median(rest)))
        for single in range(1, _MAX_SINGLE + 1):
            kept = order[:-single]
            block = _Block.of(
                self.tile, self.rows, self.cols, self.usable, self.y[kept], self.m[kept]
            )
            if not block.is_off(gain, noise):
                found = np.zeros(self.usable.shape, bool)
                found[tuple(place[order[-single:]] for place in np.nonzero(self.usable))] = True
                return found
        return np.ones(self.usable.shape, bool)


def screened(
    tiles: Tiles, grid: TapGrid, down: AxisGaussian, across: AxisGaussian
) -> ScreenedTiles:
    """Take out the blocks in which the low image does not follow the blurred high one.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    down, across : AxisGaussian
        A rough kernel; its shift has to be right to some tenths of a pixel.

    Returns
    -------
    ScreenedTiles
        All tiles as they are, if hardly any block follows: then this is no cloud.
    """
    blocks, shapes = [], {}
    for tile in tiles():
        shapes[tile.place] = tile.low.shape
        model = filtered(tile, grid, down.taps(grid.down)[:, :1], across.taps(grid.across)[:, :1])
        blocks += list(_blocks(tile.place, tile.low, model[:, :, 0, 0]))
    following = [one for one in blocks if one.follows]
    if not following:
        return ScreenedTiles(tiles, {}, 0)
    gain = float(np.median([one.product / one.model for one in following]))
    noise = float(np.median([one.residual(gain) / one.count for one in following]))
    structured = [
        one for one in blocks if gain**2 * one.model > tuned.BLOCK_NOISES**2 * noise * one.count
    ]
    off = [one for one in blocks if one.is_off(gain, noise)]
    if sum(one.follows for one in structured) < tuned.FEW_BLOCKS_FOLLOW * len(structured):
        return ScreenedTiles(tiles, {}, 0)
    masks: dict[tuple[int, int], NDArray[np.bool_]] = {}
    for one in off:
        whole = masks.setdefault(one.tile, np.zeros(shapes[one.tile], bool))
        whole[one.rows, one.cols] = one.taken_out(gain, noise)
    lost = sum(
        int((core(mask) & np.isfinite(core(tile.low))).sum())
        for tile in tiles()
        if (mask := masks.get(tile.place)) is not None
    )
    return ScreenedTiles(tiles, masks, lost)


def _blocks(place: tuple[int, int], low: Floats, model: Floats) -> Iterator[_Block]:
    for i in range(0, low.shape[0], _BLOCK_PX):
        for j in range(0, low.shape[1], _BLOCK_PX):
            rows, cols = slice(i, i + _BLOCK_PX), slice(j, j + _BLOCK_PX)
            y, m = low[rows, cols], model[rows, cols]
            usable = np.isfinite(y)
            if usable.sum() < _MIN_PIXELS:
                continue
            yield _Block.of(place, rows, cols, usable, y[usable], m[usable])
