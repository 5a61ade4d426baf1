"""The image of a star behind every direction of kernels.

A tap of a kernel shifts the blurred image by whole pixels. So that image is computed once, on a
raster of the star's pixels and those within the kernels' reach.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import SiemensStar
from acutance.numerics.otf_kernels import KERNEL_REACH, kernel_taps
from acutance.targets.periodic.star_waves import BlurredStar

__all__ = ["KERNEL_REACH_PX", "kernel_columns"]

KERNEL_REACH_PX: Final = math.sqrt(2) * KERNEL_REACH
"""Distance of the furthest tap, in a corner."""
_BLOCK: Final = 20000
"""Pixels at a time: 36 MB of windows."""


def kernel_columns(
    blurred: BlurredStar, star: SiemensStar, rows: NDArray[np.intp], cols: NDArray[np.intp]
) -> Floats:
    """The images at pixels (n,), (n, k)."""
    top, left = int(rows.min()) - KERNEL_REACH, int(cols.min()) - KERNEL_REACH
    shape = int(rows.max()) + KERNEL_REACH + 1 - top, int(cols.max()) + KERNEL_REACH + 1 - left
    around = _blurred_raster(blurred, star, top, left, shape)
    side = 2 * KERNEL_REACH + 1
    windows = sliding_window_view(around, (side, side))
    # A tap to the right of the middle brings the image from the left.
    taps = kernel_taps()[::-1, ::-1].reshape(side**2, -1)
    found = np.empty((rows.size, taps.shape[1]))
    for start in range(0, rows.size, _BLOCK):
        here = slice(start, start + _BLOCK)
        seen = windows[rows[here] - top - KERNEL_REACH, cols[here] - left - KERNEL_REACH]
        found[here] = seen.reshape(-1, side**2) @ taps
    return found


def _blurred_raster(
    blurred: BlurredStar, star: SiemensStar, top: int, left: int, shape: tuple[int, int]
) -> Floats:
    """The blurred image on a raster; nothing where no kernel reaches."""
    rows, cols = np.indices(shape).astype(float)
    radius, angle = star.polar(rows + top, cols + left)
    inside = radius < blurred.outer_px
    image = np.zeros(shape)
    phase = star.cycles * angle[inside] + star.alpha_rad
    image[inside] = blurred(radius[inside], phase, angle[inside])
    return image
