"""Convolution of an image with a small kernel, where the kernel lies inside the image."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.numerics.compiled import compiled

__all__ = ["convolve_inside"]


def convolve_inside(image: NDArray[Any], kernel: NDArray[Any]) -> NDArray[Any]:
    """The convolution at the pixels whose whole neighbourhood lies in the image.

    Parameters
    ----------
    image : (rows, cols) float32 or float64 array
        C-contiguous.
    kernel : (m, n) array
        Odd sizes; its element (i, j) weights the pixel ``(m // 2 - i, n // 2 - j)`` away.

    Returns
    -------
    (rows - m + 1, cols - n + 1) array
        Of the image's type.
    """
    rows, cols = image.shape
    turned = np.ascontiguousarray(kernel[::-1, ::-1], image.dtype)
    result = np.zeros((rows - turned.shape[0] + 1, cols - turned.shape[1] + 1), image.dtype)
    _add_products(image, turned, result)
    return result


@compiled
def _add_products(image: NDArray[Any], weights: NDArray[Any], result: NDArray[Any]) -> None:
    """Add to `result` the sums of products under `weights`.

    Four weights at a time: a sum is then read and written a quarter as often.
    """
    rows, cols = result.shape
    m, n = weights.shape
    fours = n - n % 4
    for r in range(rows):
        total = result[r]
        for i in range(m):
            line = image[r + i]
            for j in range(0, fours, 4):
                a, b, c, d = weights[i, j], weights[i, j + 1], weights[i, j + 2], weights[i, j + 3]
                for x in range(cols):
                    total[x] += (
                        a * line[x + j]
                        + b * line[x + j + 1]
                        + c * line[x + j + 2]
                        + d * line[x + j + 3]
                    )
            for j in range(fours, n):
                a = weights[i, j]
                for x in range(cols):
                    total[x] += a * line[x + j]
