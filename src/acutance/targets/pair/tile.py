"""Tiles of an image pair: low pixels, and the reference's samples around each of them.

A low pixel p is a weighted sum of the reference's samples, ``sum_k c_k H(x_p + t_k)``: the places
t_k of the taps against the low pixel's centre are the same for all of them, so the taps are the
kernel, seen from the other side: ``h(-t_k) = c_k``, with the transfer ``sum_k c_k exp(2 pi i u
t_k)``. Nothing is interpolated, and the low image's aliasing is in the sum as it is in the image.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = [
    "FAR_PX",
    "PAD_PX",
    "FarTaps",
    "PairTile",
    "TapAxis",
    "TapGrid",
    "Tiles",
    "blurred",
    "blurred_far",
    "core",
    "correlated",
    "far_taps",
    "filtered",
    "filtered_across",
    "filtered_down",
    "first_of_cell",
]

Complexes = NDArray[np.complex128]
Scalar = TypeVar("Scalar", bound=np.generic)

PAD_PX = 2
"""Low pixels a tile has above, on the left and on the right of those it stands for: its residuals
are whitened with them (`noise`)."""

FAR_PX = 24
"""Distance out to which tails of the kernel act."""


@dataclass(frozen=True)
class TapAxis:
    """The taps along one axis.

    Parameters
    ----------
    per_px : int
        Reference samples in a low pixel.
    offset_px : float
        Place of the middle tap against the low pixel's centre, in low pixels.
    half : int
        Taps on either side of the middle one.
    """

    per_px: int
    offset_px: float
    half: int

    @cached_property
    def places_px(self) -> Floats:
        """Places of the taps against the low pixel's centre, (2 half + 1,), in low pixels."""
        return np.asarray(np.arange(-self.half, self.half + 1) / self.per_px + self.offset_px)

    def waves(self, freq_cpp: Floats) -> Complexes:
        """``exp(2 pi i f t)``, (n, taps)."""
        return np.asarray(np.exp(2j * math.pi * np.outer(freq_cpp, self.places_px)))


@dataclass(frozen=True)
class TapGrid:
    """The taps of a low pixel: an axis of rows and one of columns.

    Parameters
    ----------
    down, across : TapAxis
    """

    down: TapAxis
    across: TapAxis

    def fine_shape(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Reference samples that `shape` low pixels need."""
        axes = (self.down, self.across)
        rows, cols = (
            axis.per_px * (size - 1) + 2 * axis.half + 1
            for axis, size in zip(axes, shape, strict=True)
        )
        return rows, cols


@dataclass(frozen=True, eq=False)
class PairTile:
    """Some low pixels and the reference's samples under and around them.

    Parameters
    ----------
    low : (h, w) array
        NaN where a pixel cannot be used. The first PAD_PX rows, and as many columns on either side,
        belong to other tiles.
    fine : array
        Samples of the reference; those of low pixel (0, 0) begin at its corner. No NaN.
    wide : (h + 2 FAR_PX, w + 2 FAR_PX) array
        The reference's means over the low pixels and those around them. No NaN.
    beyond : array or None
        By how much these differ if the image is mirrored at its border instead of its outermost
        pixel repeated: an error as large as that of either. ``None`` far from the border.
    place : (int, int)
        Row and column of the first pixel in the low image.
    regions : (h, w) int array
        Which region of the map of local statistics every low pixel belongs to.
    defects : (int, int)
        Pixels of the low image and samples of the high one that were left out, since they lie far
        beyond all others and the other image does not show them.
    """

    low: Floats
    fine: Floats
    wide: Floats
    beyond: Floats | None
    place: tuple[int, int]
    regions: NDArray[np.intp]
    defects: tuple[int, int] = (0, 0)


@dataclass(frozen=True, eq=False)
class FarTaps:
    """The taps of an axis out to FAR_PX low pixels, and how they are gathered in low pixels.

    Parameters
    ----------
    places_px : (n,) array
    is_near : (n,) bool array
        Whether they are among the axis' own taps.
    cells : (n, 2 FAR_PX + 1) array
        1 where a tap lies in a low pixel, counted from the furthest one.
    """

    places_px: Floats
    is_near: NDArray[np.bool_]
    cells: Floats


def far_taps(axis: TapAxis) -> FarTaps:
    """The taps of an axis out to FAR_PX low pixels."""
    first = first_of_cell(axis) - FAR_PX * axis.per_px
    count = np.arange((2 * FAR_PX + 1) * axis.per_px)
    cells = np.asarray(count[:, None] // axis.per_px == np.arange(2 * FAR_PX + 1), float)
    order = count + first
    places = np.asarray(order / axis.per_px + axis.offset_px)
    return FarTaps(places, np.abs(order) <= axis.half, cells)


def first_of_cell(axis: TapAxis) -> int:
    """The first of the taps about the middle one that are gathered in one low pixel."""
    return -(axis.per_px // 2)


Tiles = Callable[[], Iterator[PairTile]]
"""Gives the tiles of a pair, from the first again at every call."""


def core(field: NDArray[Scalar]) -> NDArray[Scalar]:
    """The part of a tile's field, (h, w, ...), that belongs to no other tile."""
    return field[PAD_PX:, PAD_PX:-PAD_PX]


def blurred(tile: PairTile, grid: TapGrid, taps: Floats) -> Floats:
    """The low pixels a kernel, given by all its taps, makes of the reference: (h, w)."""
    whole = correlated(tile.fine, taps)
    return np.asarray(whole[:: grid.down.per_px, :: grid.across.per_px])


def blurred_far(tile: PairTile, weights: Floats) -> Floats:
    """The low pixels that weights of whole low pixels make of the reference: (h, w)."""
    return correlated(tile.wide, weights)


def correlated(field: Floats, weights: Floats) -> Floats:
    """Sums over a field wherever all the weights lie inside it."""
    # To load it takes half a second and 50 MB, whatever is measured afterwards.
    from scipy.signal import fftconvolve

    return np.asarray(fftconvolve(field, weights[::-1, ::-1], mode="valid"))


def filtered(tile: PairTile, grid: TapGrid, down: Floats, across: Floats) -> Floats:
    """Every low pixel's sums over the reference with separable kernels.

    Parameters
    ----------
    tile : PairTile
    grid : TapGrid
    down, across : (taps, n) and (taps, m) arrays
        Kernels along rows and columns.

    Returns
    -------
    (h, w, n, m) array
    """
    half = filtered_across(tile, grid, across)
    return filtered_down(half, grid, down)


def filtered_across(tile: PairTile, grid: TapGrid, across: Floats) -> Floats:
    """The reference's rows summed with the kernels along columns: (fine rows, w, m)."""
    windows = sliding_window_view(tile.fine, across.shape[0], axis=1)[:, :: grid.across.per_px]
    return np.asarray(np.ascontiguousarray(windows) @ across)


def filtered_down(half: Floats, grid: TapGrid, down: Floats) -> Floats:
    """What `filtered_across` gave, summed with kernels along rows: (h, w, n, m)."""
    per_px, taps = grid.down.per_px, down.shape[0]
    height = (half.shape[0] - taps) // per_px + 1
    flat = half.reshape(half.shape[0], -1)
    rows = [down.T @ flat[per_px * i : per_px * i + taps] for i in range(height)]
    stacked = np.stack(rows).reshape(height, down.shape[1], *half.shape[1:])
    return np.ascontiguousarray(np.moveaxis(stacked, 1, 2))
