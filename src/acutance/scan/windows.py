"""A large image in windows: each is read once, with a margin for the edges near its border."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from acutance.raster import Box

__all__ = ["Window", "windows"]

_MIN_MARGIN_PX = 32
"""As far edges are sought beyond a core."""
_MIN_SIDE_PX = 512
"""Smaller windows would cut many edges at their borders."""
_A_SIDE = 4
"""Windows along the longer side of a box, at least, so that several processes have some."""


class Window(NamedTuple):
    """A part of an image.

    Attributes
    ----------
    core : Box
        Edges, or the parts of them, that lie in it are the window's own.
    whole : Box
        What is read: the core and a margin.
    """

    core: Box
    whole: Box


def windows(
    box: Box, side_px: int, shape: tuple[int, int], half_width_px: float
) -> Iterator[Window]:
    """Windows of a box, row by row; their cores are about square, and cover it once.

    They depend on the box alone, so that results are the same whatever number of processes.

    Parameters
    ----------
    box : Box
        Inside the image.
    side_px : int
        Largest side of a core; a box of fewer than four a side has smaller ones, down to 512.
    shape : (rows, cols)
        Of the image.
    half_width_px : float
        As far the pixels of an edge reach on either side.
    """
    margin_px = max(_MIN_MARGIN_PX, math.ceil(half_width_px))
    shared = -(-max(box.shape) // _A_SIDE)
    side_px = min(side_px, max(shared, _MIN_SIDE_PX))
    for row, height in _cuts(box.row, box.height, side_px):
        for col, width in _cuts(box.col, box.width, side_px):
            core = Box(row, col, height, width)
            whole = core.grown(margin_px).intersection(Box.whole(shape))
            yield Window(core, core if whole is None else whole)


def _cuts(start: int, size: int, side_px: int) -> Iterator[tuple[int, int]]:
    """Starts and sizes of parts of equal size, as few as there can be."""
    count = -(-size // side_px)
    ends = [start + round(size * k / count) for k in range(count + 1)]
    for first, last in pairwise(ends):
        yield first, last - first
