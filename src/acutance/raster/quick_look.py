"""A small picture of a large image."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.raster.image import Image
from acutance.raster.region import Box

__all__ = ["quick_look"]

_MOST_PX = 1000


def quick_look(image: Image, box: Box) -> Floats:
    """Every so many rows and columns of a part of an image, at most 1000 of each, all of fewer.

    Parameters
    ----------
    image : Image
    box : Box
        Inside the image.
    """
    down, right = (math.ceil(size / _MOST_PX) for size in box.shape)
    if down == right == 1:
        return image.read(box)
    rows = range(box.row + down // 2, box.row + box.height, down)
    lines = [image.read(Box(row, box.col, 1, box.width))[0, right // 2 :: right] for row in rows]
    return np.array(lines)
