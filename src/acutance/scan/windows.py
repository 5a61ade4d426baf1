"""A large image in windows: each is read once, with a margin for the edges near its border."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from acutance.raster import Box

__all__ = ["MARGIN_PX", "Window", "windows"]

MARGIN_PX = 32


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


def windows(box: Box, side_px: int, shape: tuple[int, int]) -> Iterator[Window]:
    """Windows of a box, row by row; their cores are about square, and cover it once.

    Parameters
    ----------
    box : Box
        Inside the image.
    side_px : int
        Largest side of a core.
    shape : (rows, cols)
        Of the image.
    """
    for row, height in _cuts(box.row, box.height, side_px):
        for col, width in _cuts(box.col, box.width, side_px):
            core = Box(row, col, height, width)
            whole = core.grown(MARGIN_PX).intersection(Box.whole(shape))
            yield Window(core, core if whole is None else whole)


def _cuts(start: int, size: int, side_px: int) -> Iterator[tuple[int, int]]:
    """Starts and sizes of parts of equal size, as few as there can be."""
    count = -(-size // side_px)
    ends = [start + round(size * k / count) for k in range(count + 1)]
    for first, last in pairwise(ends):
        yield first, last - first
