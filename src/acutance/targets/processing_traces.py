"""What resampling and compression left in the numbers of an image, whatever it shows.

Both traces are known without a fit. Parts of 256 pixels are enough of any image.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.jpeg_blocks import jpeg_blocks
from acutance.numerics.repeated_pixels import repeated_share
from acutance.raster import Box

__all__ = ["ProcessingTraces", "sample_boxes", "traces_of_parts", "traces_of_pixels"]

_SAMPLE_PX: Final = 256
_SAMPLES_A_SIDE: Final = 3
_QUANTILE: Final = 0.75
"""Of several parts: some are water or cloud, where nothing can be seen."""


class ProcessingTraces(NamedTuple):
    """What was found.

    Attributes
    ----------
    repeated : float
        Share of the pixels that repeat a neighbour (`acutance.numerics.repeated_pixels`).
    blocks : float
        How many times rarer detail is in blocks cut at one place (`acutance.numerics.jpeg_blocks`).
    """

    repeated: float
    blocks: float


def traces_of_pixels(pixels: Floats) -> ProcessingTraces:
    """The traces in the pixels of a region.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    return traces_of_parts(pixels[box.slices] for box in sample_boxes(Box.whole(pixels.shape)))


def traces_of_parts(parts: Iterable[Floats]) -> ProcessingTraces:
    """The traces in parts of an image, of which one at least is given: their upper quarter.

    Parameters
    ----------
    parts : iterable of (rows, cols) arrays
        NaN where a pixel is not to be used.
    """
    found = [(repeated_share(one), jpeg_blocks(one)) for one in map(np.ascontiguousarray, parts)]
    repeated, blocks = np.quantile(found, _QUANTILE, axis=0) if len(found) > 1 else found[0]
    return ProcessingTraces(float(repeated), float(blocks))


def sample_boxes(box: Box) -> Iterator[Box]:
    """Parts of a box, at most three a side and 256 pixels large; all of a small one."""
    sides = [list(_samples(*one)) for one in ((box.row, box.height), (box.col, box.width))]
    for (row, height), (col, width) in product(*sides):
        yield Box(row, col, height, width)


def _samples(start: int, size: int) -> Iterator[tuple[int, int]]:
    """Starts and sizes of parts, evenly over a side."""
    count = min(-(-size // _SAMPLE_PX), _SAMPLES_A_SIDE)
    side = min(size, _SAMPLE_PX)
    for k in range(count):
        yield start + round((size - side) * (k + 0.5) / count), side
