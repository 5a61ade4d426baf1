"""The shape of a bright spot from the few pixels it covers, free of its sub-pixel phase.

Second moments under a Gaussian window (so that noise far from the spot counts little) are what a
Gaussian seen through a pixel would give at the same phase: a table turns them into variances.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.points import tuned

__all__ = ["BROAD_WINDOW_PX", "WINDOW_PX", "SpotShape", "half_window_px", "spot_shape"]

WINDOW_PX: Final = 1.2
"""Standard deviation of the window, in which spots up to 2.5 px wide (FWHM) are told apart."""
BROAD_WINDOW_PX: Final = 2.2
"""The same for broader ones."""
_HALF_WINDOWS: Final = 1.6
_CENTRINGS: Final = 6
_PIXEL_PX2: Final = 1 / 12
_PHASES: Final[Floats] = np.linspace(-0.5, 0.5, 21)
_SIGMAS_PX: Final[Floats] = np.geomspace(0.05, 4.0, 60)


@dataclass(frozen=True)
class SpotShape:
    """Where a spot is and how wide, pixel area included.

    Parameters
    ----------
    row, col : float
        Its centroid.
    narrow_px2, wide_px2 : float
        Variances along its minor and its major axis.
    narrow_at_most_px2, wide_at_least_px2 : float
        The same, as far towards a harmless spot as three standard deviations of noise and what
        depends on the optics reach.
    narrow_std_px2, wide_std_px2 : float
        Standard deviations of both variances by the noise alone.
    """

    row: float
    col: float
    narrow_px2: float
    wide_px2: float
    narrow_at_most_px2: float
    wide_at_least_px2: float
    narrow_std_px2: float
    wide_std_px2: float


def spot_shape(
    residual: Floats,
    middle: tuple[int, int],
    noise: float,
    background: float = 0.0,
    window_px: float = WINDOW_PX,
) -> SpotShape:
    """Centroid and variances of what lies within two pixels of a spot's brightest pixel.

    Parameters
    ----------
    residual : (rows, cols) array
        The image less its background.
    middle : (row, col) ints
        The brightest pixel.
    noise : float
        Standard deviation of the noise of a pixel.
    background : float, optional
        Level of `residual` around the spot.
    window_px : float, optional
        Standard deviation of the window.
    """
    row, col = middle
    half = half_window_px(window_px)
    top, side = max(row - half, 0), max(col - half, 0)
    light = np.ascontiguousarray(residual[top : row + half + 1, side : col + half + 1], float)
    y, x, down, across, lean, *spread = _windowed_moments(
        light - background, float(top - row), float(side - col), window_px
    ).tolist()
    by_noise = tuned.MOMENT_SIGMAS * noise * np.array(spread)
    doubt = np.hypot(tuned.MOMENT_LENIENCE_PX2, by_noise)
    likely, wider, narrower, noisier = (
        _axes(down + away[0], across + away[1], lean, (y, x), window_px)
        for away in (0.0 * doubt, doubt, -doubt, by_noise)
    )
    narrow_std, wide_std = (noisier - likely) / tuned.MOMENT_SIGMAS
    return SpotShape(
        row + y, col + x, float(likely[0]), float(likely[1]), float(wider[0]), float(narrower[1]),
        float(narrow_std), float(wide_std),
    )  # fmt: skip


def half_window_px(window_px: float) -> int:
    """Pixels on either side of the brightest one that a window reaches."""
    return round(_HALF_WINDOWS * window_px)


@compiled
def _windowed_moments(light: Floats, top: float, side: float, window_px: float) -> Floats:
    """Centroid and second moments of what a window about the centroid shows.

    Parameters
    ----------
    light : (rows, cols) array
    top, side : float
        Row and column of its first pixel, from the brightest one.
    window_px : float

    Returns
    -------
    (7,) array
        Row and column of the centroid, from the brightest pixel; moments down, across, and mixed;
        standard deviations of the first two for noise of one.
    """
    height, width = light.shape
    found = np.zeros(7)
    down, across = np.empty(height), np.empty(width)
    y = x = 0.0
    for _ in range(_CENTRINGS):
        for i in range(height):
            down[i] = np.exp(-0.5 * ((top + i - y) / window_px) ** 2)
        for j in range(width):
            across[j] = np.exp(-0.5 * ((side + j - x) / window_px) ** 2)
        total, by_y, by_x = 0.0, 0.0, 0.0
        for i in range(height):
            for j in range(width):
                seen = max(light[i, j] * (down[i] * across[j]), 0.0)
                total += seen
                by_y += (top + i - y) * seen
                by_x += (side + j - x) * seen
        total = max(total, 1e-300)
        # The window holds the centroid back: twice the step is right for a spot as wide as it.
        y = min(max(y + 1.5 * by_y / total, -1.0), 1.0)
        x = min(max(x + 1.5 * by_x / total, -1.0), 1.0)
    total, modulus = 0.0, 0.0
    for i in range(height):
        for j in range(width):
            dy, dx = top + i - y, side + j - x
            seen = light[i, j] * np.exp(-0.5 * (dy * dy + dx * dx) / window_px**2)
            total += seen
            modulus += abs(seen)
            found[2] += dy * dy * seen
            found[3] += dx * dx * seen
            found[4] += dy * dx * seen
    # Where light and what is missing cancel, there is no spot: it is as wide as may be.
    total = max(total, 0.1 * modulus, 1e-300)
    found[2:5] /= total
    for i in range(height):
        for j in range(width):
            dy, dx = top + i - y, side + j - x
            window = np.exp(-0.5 * (dy * dy + dx * dx) / window_px**2)
            found[5] += (window * (dy * dy - found[2])) ** 2
            found[6] += (window * (dx * dx - found[3])) ** 2
    found[5], found[6] = np.sqrt(found[5]) / total, np.sqrt(found[6]) / total
    found[0], found[1] = y, x
    return found


def _fall(distance: Floats, window_px: float) -> Floats:
    return np.asarray(np.exp(-0.5 * (distance / window_px) ** 2))


def _axes(
    down: float, across: float, lean: float, phase: tuple[float, float], window_px: float
) -> Floats:
    """Variances along the minor and the major axis from windowed moments."""
    yy, xx = (
        _unwindowed(one, at, window_px) for one, at in zip((down, across), phase, strict=True)
    )
    # To first order in the lean, the window multiplies it by this.
    whole = window_px**4 / ((yy + window_px**2) * (xx + window_px**2))
    xy = lean / whole
    half_apart = math.hypot(0.5 * (yy - xx), xy)
    return 0.5 * (yy + xx) + half_apart * np.array([-1.0, 1.0])


def _unwindowed(moment: float, phase: float, window_px: float) -> float:
    """Variance, pixel area included, of the Gaussian that shows a windowed moment at a phase."""
    column = int(np.argmin(np.abs(_PHASES - phase)))
    sigma = float(np.interp(moment, _moments(window_px)[column], _SIGMAS_PX))
    return sigma**2 + _PIXEL_PX2


@cache
def _moments(window_px: float) -> Floats:
    """Windowed second moments of Gaussians through a pixel, (phases, sigmas), rising."""
    half = half_window_px(window_px)
    steps = np.arange(-half, half + 1)
    distance = (steps - _PHASES[:, None])[:, None, :]
    sigma = _SIGMAS_PX[:, None]
    light = ndtr((distance + 0.5) / sigma) - ndtr((distance - 0.5) / sigma)
    seen = light * _fall(distance, window_px)
    moments = (seen * distance**2).sum(axis=2) / seen.sum(axis=2)
    return np.asarray(np.maximum.accumulate(moments, axis=1))
