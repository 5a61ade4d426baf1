"""White noise of a plane without bounds, in windows that agree where they meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats
from acutance.raster import Box

__all__ = ["CELL_PX", "generator_at", "white_noise"]

CELL_PX = 64
"""The plane is made of squares of this side, each with a generator of its own."""


def generator_at(seed: Sequence[int], row: int, col: int) -> np.random.Generator:
    """A generator that belongs to a place of the plane, whichever other places are drawn."""
    place = (row % 2**32, col % 2**32)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=place))


def white_noise(seed: Sequence[int], box: Box) -> Floats:
    """White noise of unit variance in a window.

    Parameters
    ----------
    seed : sequence of int
        Of the plane.
    box : Box
        Its first row and column may be below 0.

    Returns
    -------
    (height, width) array
    """
    top, left = box.row // CELL_PX, box.col // CELL_PX
    bottom, right = -(-(box.row + box.height) // CELL_PX), -(-(box.col + box.width) // CELL_PX)
    cells = [
        [
            generator_at(seed, row, col).standard_normal((CELL_PX, CELL_PX))
            for col in range(left, right)
        ]
        for row in range(top, bottom)
    ]
    return np.block(cells)[
        Box(box.row - top * CELL_PX, box.col - left * CELL_PX, *box.shape).slices
    ]
