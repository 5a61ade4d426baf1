"""What point sources stand on: the level of the ground, block by block."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from acutance.curves.grid import Floats

__all__ = ["block_background"]

_BLOCK_PX: Final = 24


def block_background(image: Floats) -> Floats:
    """Medians of blocks, joined by bilinear interpolation.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where there is no data.

    Returns
    -------
    (rows, cols) array
    """
    height, width = image.shape
    rows = _borders(height)
    cols = _borders(width)
    table = np.empty((rows.size - 1, cols.size - 1))
    whole = float(np.median(image[np.isfinite(image)]))
    for i, (top, bottom) in enumerate(pairwise(rows)):
        for j, (left, right) in enumerate(pairwise(cols)):
            block = image[top:bottom, left:right]
            usable = block[np.isfinite(block)]
            table[i, j] = np.median(usable) if usable.size else whole
    places = np.meshgrid(
        _in_blocks(height, rows), _in_blocks(width, cols), indexing="ij", sparse=False
    )
    return np.asarray(map_coordinates(table, places, order=1, mode="nearest"))


def _borders(length: int) -> NDArray[np.intp]:
    return np.linspace(0, length, max(round(length / _BLOCK_PX), 1) + 1).astype(np.intp)


def _in_blocks(length: int, borders: NDArray[np.intp]) -> Floats:
    """Every pixel's place counted in blocks, from the centre of the first one."""
    centres = 0.5 * (borders[:-1] + borders[1:] - 1)
    return np.interp(np.arange(length), centres, np.arange(centres.size))
