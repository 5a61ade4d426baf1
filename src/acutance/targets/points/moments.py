"""The shape of a bright spot from the few pixels it covers, free of its sub-pixel phase.

Second moments under a Gaussian window (so that noise far from the spot counts little) are what a
Gaussian seen through a pixel would give at the same phase: a table turns them into variances.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats
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
    light = residual[top : row + half + 1, side : col + half + 1] - background
    rows = np.arange(top, top + light.shape[0]) - float(row)
    cols = np.arange(side, side + light.shape[1]) - float(col)
    y = x = 0.0
    for _ in range(_CENTRINGS):
        window = np.outer(_fall(rows - y, window_px), _fall(cols - x, window_px))
        seen = np.maximum(light * window, 0.0)
        total = max(float(seen.sum()), 1e-300)
        # The window holds the centroid back: twice the step is right for a spot as wide as it.
        y = float(np.clip(y + 1.5 * float((rows - y) @ seen.sum(axis=1)) / total, -1.0, 1.0))
        x = float(np.clip(x + 1.5 * float((cols - x) @ seen.sum(axis=0)) / total, -1.0, 1.0))
    dy, dx = rows - y, cols - x
    window = np.outer(_fall(dy, window_px), _fall(dx, window_px))
    seen = light * window
    # Where light and what is missing cancel, there is no spot: it is as wide as may be.
    total = max(float(seen.sum()), 0.1 * float(np.abs(seen).sum()), 1e-300)
    down, across = float(dy**2 @ seen.sum(axis=1)) / total, float(seen.sum(axis=0) @ dx**2) / total
    lean = float(dy @ seen @ dx) / total
    by_noise = np.array(
        [
            tuned.MOMENT_SIGMAS * noise * np.sqrt(np.sum((window * (power - moment)) ** 2)) / total
            for power, moment in ((dy[:, None] ** 2, down), (dx[None, :] ** 2, across))
        ]
    )
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
    return np.asarray(np.linalg.eigvalsh(np.array([[yy, xy], [xy, xx]])))


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
