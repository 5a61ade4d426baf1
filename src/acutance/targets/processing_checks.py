"""Checks of what processing left in the pixels, whatever the target: repeated pixels, JPEG blocks.

Both are known from the numbers alone, without a fit. Parts of 256 pixels are enough of any image.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.jpeg_blocks import jpeg_blocks
from acutance.numerics.repeated_pixels import repeated_share
from acutance.raster import Box, Image
from acutance.targets.check import Check, Limits, answer
from acutance.targets.region import read_data

__all__ = ["PROCESSING_CHECKS", "image_processing_checks", "processing_checks", "sample_boxes"]

PROCESSING_CHECKS = ("repeated_pixels", "jpeg_blocks")
"""Names of these checks."""

_SAMPLE_PX: Final = 256
_SAMPLES_A_SIDE: Final = 3
_QUANTILE: Final = 0.75
"""Of several parts: some are water or cloud, where nothing can be seen."""


def processing_checks(pixels: Floats, limits: Limits) -> tuple[Check, Check]:
    """Whether pixels of a region repeat their neighbours, and whether JPEG compressed them.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    limits : mapping of str to float
        Limits the caller changed.
    """
    boxes = sample_boxes(Box.whole(pixels.shape))
    return _answers(*_traces(pixels[box.slices] for box in boxes), limits)


def image_processing_checks(
    images: Sequence[tuple[Image, Box]], limits: Limits
) -> tuple[Check, Check]:
    """The same of parts of images, which are read here: of the worse image.

    Parameters
    ----------
    images : sequence of (Image, Box)
    limits : mapping of str to float
        Limits the caller changed.
    """
    found = [_traces(read_data(one, part)[0] for part in sample_boxes(box)) for one, box in images]
    repeated, blocks = zip(*found, strict=True)
    return _answers(max(repeated), max(blocks), limits)


def _traces(parts: Iterable[Floats]) -> tuple[float, float]:
    """Share of repeated pixels, and how distinct blocks are, of parts of an image."""
    found = [(repeated_share(one), jpeg_blocks(one)) for one in map(np.ascontiguousarray, parts)]
    repeated, blocks = np.quantile(found, _QUANTILE, axis=0) if len(found) > 1 else found[0]
    return float(repeated), float(blocks)


def _answers(repeated: float, blocks: float, limits: Limits) -> tuple[Check, Check]:
    return (
        answer(
            "repeated_pixels", repeated,
            f"{100 * repeated:.1f} % of the pixels repeat the one above or beside them", limits,
        ),
        answer(
            "jpeg_blocks", blocks,
            f"detail is {blocks:.2f} times rarer in blocks of 8 x 8 pixels cut at one place than "
            "at any other", limits,
        ),
    )  # fmt: skip


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
