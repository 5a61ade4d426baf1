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

    Five weights at a time: a sum is then read and written a fifth as often. Each of them has a
    view of the line of its own, since only indices that cannot be negative are vectorised.
    """
    rows, cols = result.shape
    m, n = weights.shape
    fives = n // 5
    for r in range(rows):
        total = result[r]
        for i in range(m):
            line = image[r + i]
            for five in range(fives):
                j = 5 * five
                a, b, c = weights[i, j], weights[i, j + 1], weights[i, j + 2]
                d, e = weights[i, j + 3], weights[i, j + 4]
                p, q, s = line[j:], line[j + 1 :], line[j + 2 :]
                t, u = line[j + 3 :], line[j + 4 :]
                for x in range(cols):
                    total[x] += a * p[x] + b * q[x] + c * s[x] + d * t[x] + e * u[x]
            for j in range(5 * fives, n):
                a, p = weights[i, j], line[j:]
                for x in range(cols):
                    total[x] += a * p[x]
