"""What stands in the place of pixels without data while their neighbours are filtered.

Compared on landscapes whose truth is known (the documentation's page on restoration has the
table): the mean of two continuations errs least. One is the point reflection through the nearest
pixel with data, which goes on with the slope there; the other the mean of the nearest pixels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter

from acutance.curves.grid import Floats

__all__ = ["CONTEXT_PX", "fill_unusable"]

Mask = NDArray[np.bool_]
Indices = NDArray[np.intp]

_SIGMAS_PX = (0.7, 1.4, 2.8, 5.6)
_TRUNCATED = 4.0
_MIN_SHARE = 1e-3
CONTEXT_PX = 23
"""How far from a pixel its substitute looks: the reach of the widest mean. A kernel reaches less,
so what it needs is the same in whatever windows an image is read."""
_CONTEXT = 2 * CONTEXT_PX
_TILE_PX = 256


def fill_unusable(values: NDArray[np.floating], usable: Mask, border_px: int = 0) -> None:
    """Replace unusable pixels near usable ones in place; those farther away become 0.

    Parameters
    ----------
    values : (rows, cols) float array
    usable : (rows, cols) bool array
    border_px : int, optional
        So many pixels along every side only serve the others: they need no substitutes.
    """
    source = values.copy()
    source[~usable] = 0
    values[~usable] = 0
    rows, cols = (size - border_px for size in values.shape)
    for row in range(border_px, rows, _TILE_PX):
        for col in range(border_px, cols, _TILE_PX):
            tile = slice(row, min(row + _TILE_PX, rows)), slice(col, min(col + _TILE_PX, cols))
            if not usable[tile].all():
                _fill_holes(values, source, usable, _holes(usable, tile))


def _fill_holes(
    values: NDArray[np.floating],
    source: NDArray[np.floating],
    usable: Mask,
    inner: tuple[slice, slice],
) -> None:
    """Fill the unusable pixels of a part, from all that their substitutes depend on."""
    around = tuple(slice(max(0, one.start - _CONTEXT), one.stop + _CONTEXT) for one in inner)
    if not usable[around].any():
        return
    row, col = (
        slice(one.start - outer.start, one.stop - outer.start)
        for one, outer in zip(inner, around, strict=True)
    )
    found = _substitutes(source[around].astype(float), usable[around], (row, col))
    values[inner] = np.where(usable[inner], values[inner], found)


def _holes(usable: Mask, tile: tuple[slice, slice]) -> tuple[slice, slice]:
    """The smallest part of a tile that holds all of its unusable pixels."""
    missing = ~usable[tile]
    found = []
    for axis, one in enumerate(tile):
        places = np.flatnonzero(missing.any(axis=1 - axis))
        found.append(slice(one.start + int(places[0]), one.start + int(places[-1]) + 1))
    return found[0], found[1]


def _substitutes(values: Floats, usable: Mask, own: tuple[slice, slice]) -> Floats:
    """Both continuations' mean in a part of an array; 0 where no usable pixel is near."""
    mean, near = _nearby_mean(values, usable, own)
    indices: Indices = distance_transform_edt(~usable, return_distances=False, return_indices=True)
    nearest = [one[own] for one in indices]
    places = [one[own] for one in np.asarray(np.indices(values.shape))]
    mirrored = [2 * one - place for one, place in zip(nearest, places, strict=True)]
    inside = [(one >= 0) & (one < size) for one, size in zip(mirrored, values.shape, strict=True)]
    there = tuple(np.where(ok, one, 0) for one, ok in zip(mirrored, inside, strict=True))
    level = values[tuple(nearest)]
    reflected = inside[0] & inside[1] & usable[there]
    continued = np.where(reflected, 2 * level - values[there], level)
    return np.asarray(np.where(near, 0.5 * (continued + mean), 0.0))


def _nearby_mean(values: Floats, usable: Mask, own: tuple[slice, slice]) -> tuple[Floats, Mask]:
    """Mean of the usable pixels around every place of a part, by the narrowest window with some."""
    weight = usable.astype(float)
    mean, known = np.zeros(values[own].shape), np.zeros(values[own].shape, bool)
    for sigma in _SIGMAS_PX:
        share = _blurred(weight, sigma)[own]
        fresh = ~known & (share > _MIN_SHARE)
        mean[fresh] = _blurred(values, sigma)[own][fresh] / share[fresh]
        known |= fresh
        if known.all():
            break
    return mean, known


def _blurred(values: Floats, sigma_px: float) -> Floats:
    return np.asarray(gaussian_filter(values, sigma_px, truncate=_TRUNCATED, mode="constant"))
