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
from acutance.raster import Box, Image

__all__ = [
    "ProcessingTraces",
    "sample_boxes",
    "surroundings",
    "traces_of_parts",
    "traces_of_pixels",
    "with_surroundings",
]

_SAMPLE_PX: Final = 256
_SAMPLES_A_SIDE: Final = 3
_AROUND_PX: Final = 16
"""How far around a region blocks are looked for. Of 194 edges in JPEG of quality 85 to 96, regions
of 19 to 74 px a side, 155 are named by their own pixels, 186 with those around them."""
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


def with_surroundings(found: ProcessingTraces, image: Image, box: Box) -> ProcessingTraces:
    """The traces in a region, with the blocks of JPEG in what surrounds it.

    An image is compressed as a whole, and a small region holds few whole blocks: a large one does
    without. Copies of pixels are looked for in the region alone, as constant fill around it is no
    resampling.

    Parameters
    ----------
    found : ProcessingTraces
        In the pixels of the region.
    image : Image
    box : Box
        Where the region lies in it.
    """
    frame = surroundings(image.shape, box)
    if frame is None:
        return found
    return found._replace(blocks=max(found.blocks, jpeg_blocks(image.read(frame))))


def surroundings(shape: tuple[int, int], box: Box) -> Box | None:
    """A region with what is read around it for its traces; ``None`` if it does without.

    Parameters
    ----------
    shape : (rows, cols)
        Of the image.
    box : Box
        Where the region lies in it.
    """
    frame = box.grown(_AROUND_PX).intersection(Box.whole(shape))
    return None if frame == box or max(box.shape) > _SAMPLE_PX else frame


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
