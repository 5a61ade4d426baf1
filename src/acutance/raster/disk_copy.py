"""Images for other processes: their pixels in a file, by a name that all of them find."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from acutance.raster.image import Image
from acutance.raster.linearization import LinearizedPixels
from acutance.raster.pixels import NpyPixels
from acutance.raster.region import Box

__all__ = ["disk_copy", "named_from_root"]

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


def named_from_root(image: Image) -> Image:
    """The same image, its file named from the root: processes in other folders find it.

    Parameters
    ----------
    image : Image
        Names that the file system does not know (GDAL's own) stay as they are.
    """
    if image.path is None or not os.path.exists(image.path):
        return image
    path = os.path.realpath(image.path)
    return replace(image, path=path, source=_renamed(image.source, path))


def _renamed(source: Any, path: str) -> Any:
    """A source of pixels with another name of its file."""
    if isinstance(source, LinearizedPixels):
        return replace(source, source=_renamed(source.source, path))
    return replace(source, path=path)
