"""Ground that is not uniform: slow trends of the plateaus, kept apart from the sensor's halo.

A slope of the ground beside an edge looks like a halo of the sensor and takes MTF away. Trends
along the edge tell them apart: no sensor makes them. Where they stand out of the noise, every
side of the edge gets low polynomials in both directions, whose common amplitude the data decide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.fit.profile import Sides

__all__ = ["LOG_AMPLITUDE", "ground_trends", "is_sloping", "is_uneven", "steepness"]

LOG_AMPLITUDE: Final = -5.0
"""Hyperprior mean of the trends' amplitude relative to the edge's height, logarithm."""

_STRETCH_PX = 5.0
_MIN_PIXELS = 6
_SIGNIFICANT = 5.0
_BEYOND_WIDTHS = 1.5
_FAR_WIDTHS = 3.0
_TAIL_PX = 0.1
"""The LSF of an aperture falls as a / s^2: a is 0.065 px for a cutoff of 1 c/px, 0.1 for 0.65."""


def ground_trends(sides: Sides, t: Floats) -> Floats:
    """Trends of the two sides, (10, n): five modes a side, each about 1 at its largest.

    Parameters
    ----------
    sides : pairs of (n,) arrays
        For either plateau how much of a pixel sees it, and how far out the pixel lies.
    t : (n,) array
        Distance along the edge, pixels.
    """
    along = t / max(float(np.max(np.abs(t))), 1e-9)
    modes = []
    for share, outwards in sides:
        away = np.maximum(outwards, 0.0)
        away = away / max(float(away.max()), 1e-9)
        for mode in (along, 1.5 * along**2 - 0.5, away, away * along, away**2):
            modes.append(share * mode)
    return np.array(modes)


def is_uneven(standard: Floats, sides: Sides, t: Floats, width_px: float) -> bool:
    """Whether the plateaus change along the edge by more than noise does.

    Parameters
    ----------
    standard : (n,) array
        Residuals in standard deviations, outliers bounded.
    sides, t
        As in `ground_trends`.
    width_px : float
        Width of the blur; pixels nearer than 1.5 widths are left out.
    """
    stretch = ((t - t.min()) / _STRETCH_PX).astype(np.intp)
    number = int(stretch.max()) + 1
    chi_square, freedom = 0.0, 0
    for _, outwards in sides:
        there = outwards > _BEYOND_WIDTHS * width_px
        count = np.bincount(stretch[there], minlength=number)
        total = np.bincount(stretch[there], standard[there], number)
        told = count >= _MIN_PIXELS
        chi_square += float(np.sum(total[told] ** 2 / count[told]))
        freedom += int(np.count_nonzero(told))
    return chi_square > freedom + _SIGNIFICANT * math.sqrt(2 * freedom)


def is_sloping(value: Floats, noise: float, sides: Sides, width_px: float) -> bool:
    """Whether a plateau goes on rising or falling far from the target.

    Parameters
    ----------
    value : (n,) array
        Pixels, 0 on the dark and 1 on the bright ground.
    noise : float
        Their standard deviation.
    sides, width_px
        As in `is_uneven`.
    """
    return any(
        steepness(value, outwards, _FAR_WIDTHS * width_px, noise) > 1 for _, outwards in sides
    )


def steepness(value: Floats, outwards: Floats, from_px: float, noise: float) -> float:
    """Slope of a plateau's outer half, relative to the tail of a small aperture at that distance.

    Above 1 no diffraction explains it; 0 where noise does.

    Parameters
    ----------
    value, outwards : (n,) arrays
        Pixels, and how far outwards from the target they lie.
    from_px : float
        Where the plateau begins.
    noise : float
        Standard deviation of the pixels.
    """
    plateau = outwards > from_px
    if np.count_nonzero(plateau) < 4 * _MIN_PIXELS:
        return 0.0
    far = outwards > 0.5 * (from_px + float(outwards.max()))
    place = outwards[far]
    middle = float(place.sum()) / max(place.size, 1)
    place -= middle
    power = float(place @ place)
    if power <= 0:
        return 0.0
    slope = abs(float(place @ value[far])) / power
    if slope * math.sqrt(power) < _SIGNIFICANT * noise:
        return 0.0
    return slope * middle**2 / _TAIL_PX
