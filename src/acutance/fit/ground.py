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

__all__ = ["LOG_AMPLITUDE", "ground_trends", "is_uneven"]

LOG_AMPLITUDE: Final = -5.0
"""Hyperprior mean of the trends' amplitude relative to the edge's height, logarithm."""

Sides = tuple[tuple[Floats, Floats], ...]

_STRETCH_PX = 5.0
_MIN_PIXELS = 6
_SIGNIFICANT = 5.0
_BEYOND_WIDTHS = 1.5


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
