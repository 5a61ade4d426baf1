"""The first fit of a straight target: a Gaussian through a pixel, a line and two levels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets.straight.first_fit_model import MIN_SIGMA_PX, gauss_newton
from acutance.targets.straight.step_profile import EDGE, Profile, pulse_profile
from acutance.targets.straight.tuned import APERTURE_PX

__all__ = ["FirstFit", "fit_first"]

_REACH_WIDTHS = 2.5
_TAIL_STD = 0.1
_WIDEST_OF_PULSE_PX = 1.5
"""Aperture of a pulse's blur, at most: a narrow pulse through a wide one is a wide pulse through a
narrow one, so that of pulses no wider than this it is held. Were it held always, blurs of less than
.3 px would not fit (FWHM 3 % off)."""
# Parameters: dark, height, offset, turn, sigma, aperture, tail; of a pulse also width and height
# ratio.
_EXPECTED: Floats = np.array([0.0, 0.0, 0.0, 0.0, 0.0, APERTURE_PX[0], 0.0, 0.0, 0.0])
_LOWEST: Floats = np.array([*[-np.inf] * 4, MIN_SIGMA_PX, 0.2, 0.0, 0.0, 0.0])
_HIGHEST: Floats = np.array([*[np.inf] * 4, np.inf, 4.0, 0.5, np.inf, np.inf])


@dataclass(frozen=True)
class FirstFit:
    """A target blurred by a Gaussian and a detector, fitted to the pixels.

    `height` is that of the first step (bright minus dark for an edge); `noise` the standard
    deviation of the residuals.
    """

    line: Line
    blur: GaussianPixel
    dark: float
    height: float
    noise: float
    profile: Profile = EDGE


def fit_first(
    row: Floats,
    col: Floats,
    value: Floats,
    line: Line,
    *,
    dark: float,
    bright: float,
    sigma_px: float = 0.6,
    noise: float | None = None,
    profile: Profile = EDGE,
    fit_width: bool = False,
) -> FirstFit:
    """Fit line, blur, levels and, of a pulse, its steps by damped Gauss-Newton.

    Parameters
    ----------
    row, col, value : (n,) arrays
        Pixel coordinates (integers are centres) and values.
    line : Line
        First guess of the line, good to about a pixel.
    dark, bright : float
        First guess of the levels.
    sigma_px : float, optional
        First guess of the Gaussian's standard deviation.
    noise : float, optional
        First guess of the noise, the weight of the priors of aperture and tail.
    profile : Profile, optional
        An edge, or the first guess of a pulse's steps.
    fit_width : bool, optional
        Whether a pulse's width is unknown (its height ratio always is).

    Raises
    ------
    NoEdgeError
        If no step survives the fit, or it leaves the pixels.
    """
    s, t = line.distances(row, col)
    # A bad pixel counts with no more than a whole height.
    levels = (dark, bright, dark + (bright - dark) * sum(profile.shares))
    span = max(levels) - min(levels)
    value = np.minimum(np.maximum(value, min(levels) - span), max(levels) + span)
    p = np.array([dark, bright - dark, 0.0, 0.0, sigma_px, APERTURE_PX[0], 0.0, *_steps(profile)])
    scale = noise if noise else 0.02 * abs(bright - dark)
    reach = max(6.0, 4 * _REACH_WIDTHS * sigma_px)
    lowest, highest = _LOWEST[: p.size].copy(), _HIGHEST[: p.size].copy()
    expected, weight = _EXPECTED[: p.size], np.zeros(p.size)
    if p.size > 7:
        if p[7] > _WIDEST_OF_PULSE_PX:
            highest[5] = _WIDEST_OF_PULSE_PX
        else:
            lowest[5] = highest[5] = p[5]
        lowest[7], highest[7] = (0.5 * p[7], 2.0 * p[7]) if fit_width else (p[7], p[7])
    for _ in range(4):
        # The priors of aperture and tail: two more data.
        weight[5:7] = (scale / APERTURE_PX[1]) ** 2, (scale / _TAIL_STD) ** 2
        p, left = gauss_newton(
            s, t, value, p, expected, weight, lowest, highest, profile.positions_px[-1], reach
        )
        blur, height = GaussianPixel(float(p[4]), float(p[5])), float(p[1])
        scale = max(left, 1e-6 * abs(height))
        wanted = _REACH_WIDTHS * blur.width_px
        if wanted <= reach * 1.05:
            break
        reach = 1.2 * wanted
    if not (0 < height < math.inf and height >= scale):
        raise NoEdgeError(
            f"no straight target was found: the best fit is a step of {height:.3g} in noise of "
            f"{scale:.3g}; choose a region with one edge, or one pulse, between uniform plateaus"
        )
    offset_px = float(p[2])
    if not s.min() < offset_px < s.max():
        raise NoEdgeError(
            "no straight target was found: the best fit of a step lies outside the pixels around "
            "the one that was seen; choose a region with one edge, or one pulse, between uniform "
            "plateaus"
        )
    found = profile if p.size == 7 else pulse_profile(float(p[7]), float(p[8]))
    moved = line.moved(offset_px, math.degrees(float(p[3])))
    return FirstFit(moved, blur, float(p[0]), height, scale, found)


def _steps(profile: Profile) -> tuple[float, ...]:
    """The free parameters of a profile: a pulse's width and height ratio."""
    return () if profile.is_edge else (profile.positions_px[1], -profile.shares[1])
