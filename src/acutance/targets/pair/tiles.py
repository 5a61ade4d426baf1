"""Tiles of an image pair, read a window at a time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.raster import Box, Fill, Image, Region
from acutance.targets.pair.defects import (
    beyond_any_scene,
    find_defects,
    means_of_cells,
    repaired,
)
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.noise import NO_NOISE, HighNoise
from acutance.targets.pair.tile import (
    FAR_PX,
    PAD_PX,
    PairTile,
    TapAxis,
    TapGrid,
    core,
    first_of_cell,
)
from acutance.targets.region import read_data

__all__ = ["PairTiles"]

_TILE_PX: Final = 96
_REGION_PX: Final = 24
_MAX_REGIONS: Final = 8
_HOLE_PX: Final = 3.0
"""Distance within which a missing sample of the reference spoils a low pixel."""
_SPOILED: Final = 0.02
"""Weight of missing values in an interpolated sample from which it is missing."""
_NOISE_TILES: Final = 16
_GOLDEN: Final = 0.5 * (math.sqrt(5) - 1)
_KEPT_VALUES: Final = 40_000_000
_MIN_SIDE_PX: Final = 16


@dataclass(frozen=True, eq=False)
class PairTiles:
    """The tiles of a pair.

    Parameters
    ----------
    low, high : Image
    grid : PairGrid
    region : Region or None
        Where the low image is looked at, in its own pixels.
    reach_px : float
        How far the taps of a low pixel go, in low pixels.
    max_pixels : int
        Low pixels read at most: of a larger scene, tiles distributed evenly over it.
    keep_defects : bool
        Whether values far beyond all others, which one image alone has, are kept.
    """

    low: Image
    high: Image
    grid: PairGrid
    region: Region | None
    reach_px: float
    max_pixels: int
    keep_defects: bool = False

    @cached_property
    def taps(self) -> TapGrid:
        """The taps of every low pixel."""
        return TapGrid(self.grid.down.taps(self.reach_px), self.grid.across.taps(self.reach_px))

    @cached_property
    def box(self) -> Box:
        """Low pixels that can be used: inside the region, with the reference all around them.

        Raises
        ------
        RegionError
            If there are too few.
        """
        whole = Box.whole(self.low.shape)
        wanted = whole if self.region is None else self.region.box(self.low.shape)
        rows, cols = (
            axis.inner(self.reach_px) for axis in (self.grid.down, self.grid.across)
        )  # fmt: skip
        sides = rows[1] - rows[0], cols[1] - cols[0]
        inner = None
        if min(sides) > 0:
            inner = wanted.intersection(Box(rows[0], cols[0], *sides))
        found = (0, 0) if inner is None else inner.shape
        if inner is None or min(found) < _MIN_SIDE_PX:
            raise RegionError(
                f"{max(found[0], 0)} by {max(found[1], 0)} low pixels lie in the region with the "
                f"high image {self.reach_px:g} low pixels around them, at least {_MIN_SIDE_PX} "
                "both ways are needed: choose a larger region, or a larger high image"
            )
        return inner

    @cached_property
    def _counts(self) -> tuple[int, int]:
        """Regions of the map of local statistics, down and across."""
        rows, cols = (int(np.clip(size // _REGION_PX, 1, _MAX_REGIONS)) for size in self.box.shape)
        return rows, cols

    @property
    def map_shape(self) -> tuple[int, int]:
        """Rows and columns of the map of local statistics."""
        return self._counts

    @cached_property
    def boxes(self) -> tuple[Box, ...]:
        """The low pixels of every tile that is read."""
        return self._boxes(max(1, self.max_pixels // _TILE_PX**2))

    def _boxes(self, most: int) -> tuple[Box, ...]:
        """The low pixels of all tiles, or of so many, distributed evenly over rows and columns."""
        parts = [-(-size // _TILE_PX) for size in self.box.shape]
        rows, cols = (
            list(pairwise(first + _share(k, size, count) for k in range(count + 1)))
            for first, size, count in zip(
                (self.box.row, self.box.col), self.box.shape, parts, strict=True
            )
        )
        places = [(*rows[i], *cols[j]) for i, j in _evenly(len(rows), len(cols), most)]
        return tuple(
            Box(top, left, bottom - top, right - left) for top, bottom, left, right in places
        )

    @property
    def share_read(self) -> float:
        """Share of the usable low pixels that are read."""
        read = sum(box.height * box.width for box in self.boxes)
        return read / (self.box.height * self.box.width)

    @cached_property
    def _kept(self) -> list[PairTile] | None:
        """All tiles, where they fit in memory."""
        per_px = self.taps.down.per_px * self.taps.across.per_px
        values = sum(box.height * box.width for box in self.boxes) * (per_px + 4)
        return [self._read(box) for box in self.boxes] if values <= _KEPT_VALUES else None

    def __call__(self) -> Iterator[PairTile]:
        """The tiles, from the first."""
        if self._kept is not None:
            yield from self._kept
            return
        for box in self.boxes:
            yield self._read(box)

    def some(self, count: int) -> Iterator[PairTile]:
        """Some tiles, distributed evenly."""
        yield from (self._read(box) for box in self._boxes(min(count, len(self.boxes))))

    def high_noise(self, stated_std: float | None) -> HighNoise:
        """The noise in the samples the kernel acts on.

        Parameters
        ----------
        stated_std : float or None
            Standard deviation in a pixel of the high image; None estimates it.
        """
        found = self._estimated_noise() if stated_std is None else HighNoise.of_std(stated_std)
        return found.times(self.noise_stretch)

    def _estimated_noise(self) -> HighNoise:
        """The noise in a pixel of the high image: of the tile with the median one."""
        boxes = self._boxes(min(_NOISE_TILES, len(self.boxes)))
        windows = [self._high_box(box) for box in boxes]
        found = [HighNoise.of_samples(read_data(self.high, window)[0]) for window in windows]
        found = sorted(one for one in found if one.power > 0) or [NO_NOISE]
        return found[len(found) // 2]

    @property
    def noise_stretch(self) -> float:
        """Power of the noise in a sample over that in a pixel of the high image.

        Interpolated samples share the noise of fewer pixels, or average that of more.
        """
        axes = (self.grid.down, self.grid.across)
        return math.prod(1.0 if axis.is_native else axis.per_px / axis.ratio for axis in axes)

    @property
    def parts(self) -> tuple[tuple[Image, Box], tuple[Image, Box]]:
        """Both images, and the part of them that shows the low image's box."""
        return (self.low, self.box), (self.high, self._high_box(self.box))

    @cached_property
    def defects(self) -> tuple[int, int]:
        """Defective pixels of the low image that were left out, and of the high one."""
        counts = [tile.defects for tile in self()]
        return sum(one for one, _ in counts), sum(one for _, one in counts)

    def fills(self) -> list[Fill | None]:
        """Undeclared fill of the low image's tiles, and of the high image's next to them."""
        fills = []
        for box in self.boxes:
            fills += [read_data(self.low, box)[1], read_data(self.high, self._high_box(box))[1]]
        return fills

    def are_empty(self) -> tuple[bool, bool]:
        """Whether the low image holds no data at all in the tiles, and the high one next to them.

        Nothing is read once a pixel with data is found.
        """
        places = [(self.low, self.boxes), (self.high, map(self._high_box, self.boxes))]
        low, high = (
            not any(np.isfinite(read_data(image, box)[0]).any() for box in boxes)
            for image, boxes in places
        )
        return low, high

    def _high_box(self, box: Box) -> Box:
        rows = _window(self.grid.down.taps(self.reach_px), box.row, box.height, far=False)
        cols = _window(self.grid.across.taps(self.reach_px), box.col, box.width, far=False)
        row, height = self.grid.down.window(*rows)
        col, width = self.grid.across.window(*cols)
        return Box(row, col, height, width)

    def _read(self, box: Box) -> PairTile:
        padded = Box(
            box.row - PAD_PX, box.col - PAD_PX, box.height + PAD_PX, box.width + 2 * PAD_PX
        )
        low = self._read_low(padded)
        taps = self.taps
        rows = _window(taps.down, padded.row, padded.height, far=True)
        cols = _window(taps.across, padded.col, padded.width, far=True)
        samples, missing, absurd = self._samples(rows, cols)
        defects = (0, 0)
        if not self.keep_defects:
            low, samples, defects = self._without_defects(low, samples, absurd)
        top, left = (
            FAR_PX * axis.per_px + first_of_cell(axis) * -1 - axis.half
            for axis in (taps.down, taps.across)
        )
        height, width = taps.fine_shape(padded.shape)
        near = slice(top, top + height), slice(left, left + width)
        fine = np.ascontiguousarray(samples[near])
        low[_spoiled(missing[near], taps, padded.shape)] = np.nan
        wide, beyond = means_of_cells(samples, self._per_px), None
        if self.grid.down.leaves_image(*rows) or self.grid.across.leaves_image(*cols):
            mirrored, _, absurd = self._samples(rows, cols, mirrored=True)
            if not self.keep_defects:
                _, mirrored, _ = self._without_defects(low, mirrored, absurd)
            beyond = means_of_cells(mirrored, self._per_px) - wide
        return PairTile(
            low, fine, wide, beyond, (padded.row, padded.col), self._labels(padded), defects
        )

    @property
    def _per_px(self) -> tuple[int, int]:
        """Samples of a low pixel, down and across."""
        return self.taps.down.per_px, self.taps.across.per_px

    def _without_defects(
        self, low: Floats, samples: Floats, absurd: NDArray[np.bool_]
    ) -> tuple[Floats, Floats, tuple[int, int]]:
        """Both images of a tile without their defective pixels, and how many those are."""
        found = find_defects(low, samples, self._per_px)
        of_high = found.high | absurd
        rows, cols = (slice(FAR_PX * per, -FAR_PX * per) for per in self._per_px)
        if found.low.any():
            low = np.where(found.low, np.nan, low)
        if of_high.any():
            samples = repaired(samples, of_high, max(self._per_px))
        return (
            low,
            samples,
            (int(np.count_nonzero(core(found.low))), int(np.count_nonzero(of_high[rows, cols]))),
        )

    def _read_low(self, box: Box) -> Floats:
        """Low pixels, NaN beyond the image, the region and the reference's cover."""
        values = np.full(box.shape, np.nan)
        rows, cols = (
            axis.inner(self.reach_px) for axis in (self.grid.down, self.grid.across)
        )  # fmt: skip
        inner = Box(rows[0], cols[0], rows[1] - rows[0], cols[1] - cols[0])
        shared = box.intersection(inner)
        if shared is None:
            return values
        read, _ = read_data(self.low, shared)
        if self.region is not None:
            read = np.where(self.region.mask(shared), read, np.nan)
        top, left = shared.row - box.row, shared.col - box.col
        values[top : top + shared.height, left : left + shared.width] = read
        return values

    def _samples(
        self, rows: tuple[int, int], cols: tuple[int, int], *, mirrored: bool = False
    ) -> tuple[Floats, NDArray[np.bool_], NDArray[np.bool_]]:
        """Reference samples of a window, holes filled with its mean, where holes are, and absurd
        values."""
        (row, height), (col, width) = self.grid.down.window(*rows), self.grid.across.window(*cols)
        values, _ = read_data(self.high, Box(row, col, height, width))
        missing = ~np.isfinite(values)
        absurd = np.zeros(values.shape, bool) if self.keep_defects else beyond_any_scene(values)
        known = ~(missing | absurd)
        if not known.all():
            values = np.where(known, values, values[known].mean() if known.any() else 0.0)
        down = self.grid.down.weights(*rows, mirrored=mirrored)
        across = self.grid.across.weights(*cols, mirrored=mirrored)
        masks = [
            _resampled(mask.astype(float), np.abs(down), np.abs(across)) > _SPOILED
            for mask in (missing, absurd)
        ]
        return _resampled(values, down, across), masks[0], masks[1]

    def _labels(self, box: Box) -> NDArray[np.intp]:
        """The region of the map that every low pixel of a box belongs to."""
        whole = self.box
        rows = np.clip(np.arange(box.height) + box.row - whole.row, 0, whole.height - 1)
        cols = np.clip(np.arange(box.width) + box.col - whole.col, 0, whole.width - 1)
        down, across = self._counts
        starts = [_share(k, whole.height, down) for k in range(down)]
        sides = [_share(k, whole.width, across) for k in range(across)]
        i = np.searchsorted(starts, rows, side="right") - 1
        j = np.searchsorted(sides, cols, side="right") - 1
        return np.asarray(i[:, None] * across + j[None, :], np.intp)


def _resampled(
    values: Floats, down: Floats | NDArray[np.intp], across: Floats | NDArray[np.intp]
) -> Floats:
    """Samples taken by their numbers, or by the weights of all."""
    values = values[down.astype(np.intp)] if down.ndim == 1 else down @ values
    if across.ndim == 1:
        return np.asarray(values[:, across.astype(np.intp)], float)
    return np.asarray(values @ across.T, float)


def _share(part: int, size: int, parts: int) -> int:
    return part * size // parts


def _evenly(rows: int, cols: int, most: int) -> list[tuple[int, int]]:
    """All places of a grid, or so many of them that leave out no part of it: (row, column).

    Every row has its share of them, equally far apart; from row to row they move by the golden
    ratio of that distance, which never comes back to the same columns.
    """
    wanted = min(most, rows * cols)
    starts = [(2 * row * wanted + rows) // (2 * rows) for row in range(rows + 1)]
    used = [(row, end - start) for row, (start, end) in enumerate(pairwise(starts)) if end > start]
    return [
        (row, int((k + (0.5 + turn * _GOLDEN) % 1) * cols / share))
        for turn, (row, share) in enumerate(used)
        for k in range(share)
    ]


def _window(axis: TapAxis, first_px: int, count_px: int, *, far: bool) -> tuple[int, int]:
    """First sample and number of samples of a run of low pixels: near taps, or whole cells."""
    if not far:
        return axis.per_px * first_px - axis.half, axis.per_px * (count_px - 1) + 2 * axis.half + 1
    first = axis.per_px * (first_px - FAR_PX) + first_of_cell(axis)
    return first, axis.per_px * (count_px + 2 * FAR_PX)


def _spoiled(
    missing: NDArray[np.bool_], taps: TapGrid, shape: tuple[int, int]
) -> NDArray[np.bool_]:
    """Low pixels with a hole in the reference close to them."""
    if not missing.any():
        return np.zeros(shape, bool)
    total = np.zeros((missing.shape[0] + 1, missing.shape[1] + 1), np.int64)
    total[1:, 1:] = np.cumsum(np.cumsum(missing, axis=0), axis=1)
    edges = []
    for axis, size in zip((taps.down, taps.across), shape, strict=True):
        reach = min(axis.half, round(_HOLE_PX * axis.per_px))
        middle = axis.half + axis.per_px * np.arange(size)
        edges.append((middle - reach, middle + reach + 1))
    (top, bottom), (left, right) = edges
    count = total[np.ix_(bottom, right)] - total[np.ix_(top, right)]
    count = count - total[np.ix_(bottom, left)] + total[np.ix_(top, left)]
    return np.asarray(count > 0)
