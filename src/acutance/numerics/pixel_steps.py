"""The range of an image's numbers and their step, from pixel to pixel.

`acutance.numerics.noise.smallest_step` finds the step of any values by sorting them. Of an image
neighbours are enough, as some differ by one step only, and each pixel is looked at once.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["smallest_neighbour_step", "value_range"]


@compiled
def smallest_neighbour_step(pixels: Floats) -> float:
    """The smallest difference of neighbours that are not equal; infinite where there is none.

    In the units of the pixels.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    rows, cols = pixels.shape
    smallest = np.inf
    for i in range(rows):
        for j in range(cols):
            right = abs(pixels[i, j] - pixels[i, j + 1]) if j + 1 < cols else 0.0
            down = abs(pixels[i, j] - pixels[i + 1, j]) if i + 1 < rows else 0.0
            smallest = min(smallest, right if right > 0 else np.inf, down if down > 0 else np.inf)
    return smallest


@compiled
def value_range(pixels: Floats) -> float:
    """Largest minus smallest of the known pixels, in their units; minus infinity of none.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    low, high = np.inf, -np.inf
    for i in range(pixels.shape[0]):
        for j in range(pixels.shape[1]):
            if np.isfinite(pixels[i, j]):
                low, high = min(low, pixels[i, j]), max(high, pixels[i, j])
    return high - low
