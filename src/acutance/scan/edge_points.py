"""Points on edges: where the gradient of an image is largest along its own direction.

The gradient is that of the image smoothed by a Gaussian of one pixel. A pixel whose gradient is
larger than those one pixel before and behind it along its direction holds an edge point, and the
parabola through the three places it to a fraction of a pixel (J. Canny, IEEE PAMI 8, 1986, 679;
F. Devernay, INRIA research report 2724, 1995, for the place between pixels). Raw numbers of any
type are used as they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["EdgePoints", "Gradient", "edge_points", "gradient"]

_SMOOTHING_PX = 1.0
_REACH_PX = 4
"""Beyond it the smoothing's Gaussian is nothing."""
_QUARTILE = 0.7585
"""Lower quartile of the modulus of two normal variables of unit variance."""
_NOISE_GAIN = 0.1995
"""Noise of the smoothed gradient over that of white noise of the pixels: 1 / sqrt(8 pi) for a
Gaussian of one pixel."""
_ROUNDING = 1e-6
"""Gradients below this share of the largest are the arithmetic's, in images without noise."""
_MIN_SIGMAS = 6.0
"""Gradients of edge points, in units of their noise."""


class Gradient(NamedTuple):
    """Gradient of an image.

    Attributes
    ----------
    by_row, by_col : (rows, cols) array
        Per pixel; 0 where a pixel in reach has no data.
    noise : float
        Standard deviation of either of them on ground without edges.
    """

    by_row: Floats
    by_col: Floats
    noise: float

    @property
    def pixel_noise(self) -> float:
        """Standard deviation of white noise of the pixels, or of what texture counts as such."""
        return self.noise / _NOISE_GAIN


class EdgePoints(NamedTuple):
    """Points on edges, in the order of their pixels.

    Attributes
    ----------
    pixel : (n,) int array
        Flat number of the pixel they were found in.
    row, col : (n,) arrays
        Their place in pixels of the window.
    normal_deg : (n,) array
        Direction of the gradient, from dark to bright, from the column axis towards the row axis.
    magnitude : (n,) array
        Of the gradient, image units per pixel.
    """

    pixel: NDArray[np.intp]
    row: Floats
    col: Floats
    normal_deg: Floats
    magnitude: Floats


def gradient(pixels: Floats) -> Gradient:
    """Gradient of an image, smoothed by a Gaussian of one pixel.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where there is no data.
    """
    known = np.isfinite(pixels)
    whole = bool(known.all())
    filled = pixels if whole else np.where(known, pixels, 0.0)
    by_row = ndimage.gaussian_filter(filled, _SMOOTHING_PX, (1, 0), mode="nearest", truncate=4.0)
    by_col = ndimage.gaussian_filter(filled, _SMOOTHING_PX, (0, 1), mode="nearest", truncate=4.0)
    if not whole:
        size = 2 * _REACH_PX + 1
        inside = ndimage.minimum_filter(known, size, mode="nearest")
        by_row, by_col = np.where(inside, by_row, 0.0), np.where(inside, by_col, 0.0)
    return Gradient(by_row, by_col, _noise(by_row, by_col))


def _noise(by_row: Floats, by_col: Floats) -> float:
    """Noise of a gradient, from the quarter of the pixels where it is smallest."""
    power = by_row * by_row + by_col * by_col
    power = power[power > 0]
    if power.size == 0:
        return 0.0
    quarter = power.size // 4
    return float(np.sqrt(np.partition(power, quarter)[quarter])) / _QUARTILE


def edge_points(slope: Gradient, min_sigmas: float = _MIN_SIGMAS) -> EdgePoints:
    """Points where the gradient is largest along its direction.

    Parameters
    ----------
    slope : Gradient
    min_sigmas : float, optional
        Least gradient in units of its noise.
    """
    rounding = _ROUNDING * max(float(np.abs(part).max(initial=0.0)) for part in slope[:2])
    least = max(min_sigmas * slope.noise, rounding)
    pixel, row, col, x, y, magnitude = _largest(slope.by_row, slope.by_col, least)
    return EdgePoints(pixel, row, col, np.degrees(np.arctan2(y, x)), magnitude)


@compiled
def _largest(
    by_row: Floats, by_col: Floats, least: float
) -> tuple[NDArray[np.intp], Floats, Floats, Floats, Floats, Floats]:
    """Pixel, place, gradient (x, y) and its modulus at every maximum along the gradient."""
    rows, cols = by_row.shape
    modulus = np.sqrt(by_row * by_row + by_col * by_col)
    pixel = np.empty(modulus.size, np.intp)
    found = np.empty((5, modulus.size))
    count = 0
    for i in range(2, rows - 2):
        for j in range(2, cols - 2):
            here = modulus[i, j]
            if here <= least:
                continue
            x, y = by_col[i, j] / here, by_row[i, j] / here
            before = _between(modulus, i - y, j - x)
            behind = _between(modulus, i + y, j + x)
            if before >= here or behind > here:
                continue
            away = 0.5 * (behind - before) / (2 * here - before - behind)
            pixel[count] = i * cols + j
            found[0, count] = i + away * y
            found[1, count] = j + away * x
            found[2, count] = x
            found[3, count] = y
            found[4, count] = here
            count += 1
    return (
        pixel[:count].copy(), found[0, :count].copy(), found[1, :count].copy(),
        found[2, :count].copy(), found[3, :count].copy(), found[4, :count].copy(),
    )  # fmt: skip


@compiled
def _between(values: Floats, row: float, col: float) -> float:
    """Values between four pixels, bilinear."""
    i, j = int(np.floor(row)), int(np.floor(col))
    down, right = row - i, col - j
    upper = values[i, j] * (1 - right) + values[i, j + 1] * right
    lower = values[i + 1, j] * (1 - right) + values[i + 1, j + 1] * right
    return float(upper * (1 - down) + lower * down)
