"""Images in memory, kept in a file for as long as several processes read them."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from acutance.raster.image import Image
from acutance.raster.pixels import NpyPixels
from acutance.raster.region import Box

__all__ = ["disk_copy"]

_STRIP_PIXELS = 2**21


def disk_copy(image: Image, folder: Path) -> Image:
    """The same image, its pixels in a file: small when pickled, and read a window at a time.

    Parameters
    ----------
    image : Image
        One that was opened from a file is returned as it is.
    folder : Path
        Where the file is made, under a name of its own; whoever made the folder removes it.
    """
    if image.path is not None:
        return image
    with tempfile.NamedTemporaryFile(dir=folder, suffix=".npy", delete=False) as file:
        path = file.name
    rows, cols = image.shape
    pixels = np.lib.format.open_memmap(path, "w+", np.float64, image.shape)
    step = max(1, _STRIP_PIXELS // cols)
    for row in range(0, rows, step):
        strip = Box(row, 0, min(step, rows - row), cols)
        pixels[strip.slices] = image.read(strip)
    pixels.flush()
    return replace(image, source=NpyPixels(path))
