"""The numbers read from the curves, each with its standard deviation by propagation.

Every function returns an `Estimate`. Definitions: the documentation's page
"Conventions"; RER and half extents follow GIQE, the 40-60 % slope follows Kohm (2004).

The error of a curve at x is F(x) z, with z standard normal and F(x) its `gradient` there: a row of
the factor of its covariance. A place where the curve passes a level moves by -F(x) z / f'(x), with
f' the `slope` of the curve. So every number has a row g of its own, and the variance g g^T.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats, crossing, sample, slope
from acutance.curves.spread import Esf, Lsf
from acutance.curves.transfer import Mtf

__all__ = [
    "NYQUIST_CPP",
    "RerCentre",
    "edge_slope",
    "full_width",
    "giqe_h",
    "half_extent",
    "mtf_area",
    "mtf_crossing",
    "overshoot",
    "rer",
    "undershoot",
]

NYQUIST_CPP = 0.5
RerCentre = Literal["half", "peak"]

_UNDEFINED = Estimate(math.nan, math.nan)


def _estimate(value: float, gradient: Floats) -> Estimate:
    return Estimate(float(value), math.sqrt(float(gradient @ gradient)))


def _non_negative(value: float, gradient: Floats) -> Estimate:
    return replace(_estimate(value, gradient), lowest=0.0)


def _level_position(esf: Esf, level: float) -> tuple[float, Floats]:
    """Where the ESF passes `level` next to its centre, with the gradient of that place."""
    centre = crossing(esf.distance_px, esf.value, 0.5, _start(esf))
    if level == 0.5 or math.isnan(centre):
        place = centre
    else:
        place = crossing(esf.distance_px, esf.value, level, centre, 1 if level > 0.5 else -1)
    if math.isnan(place):
        return math.nan, np.array([math.nan])
    steepness = slope(esf.distance_px, esf.value, place)
    return place, -esf.gradient(place) / steepness


def _start(esf: Esf) -> float:
    """A place on the dark side within the steep part, from where 50 % is the next crossing."""
    steepest = int(np.argmax(esf.value[1:] - esf.value[:-1]))
    below = (esf.value[: steepest + 2] < 0.5).nonzero()[0]
    return float(esf.distance_px[below[-1]]) if below.size else float(esf.distance_px[0])


def rer(esf: Esf, lsf: Lsf, centre: RerCentre = "half") -> Estimate:
    """Relative edge response: rise of the ESF over the central pixel, ER(+0.5) - ER(-0.5).

    Parameters
    ----------
    esf, lsf : Esf, Lsf
    centre : {"half", "peak"}
        The 50 % point (GIQE), or the peak of the line spread function (LSF) (KOMPSAT-3 draft, step
        9b).
    """
    grid = esf.distance_px
    if centre == "half":
        middle, moves = _level_position(esf, 0.5)
    else:
        # The peak is stationary, so its own uncertainty does not move the RER to first order.
        middle, moves = _peak(lsf), np.zeros(1)
    if math.isnan(middle) or middle - 0.5 < grid[0] or middle + 0.5 > grid[-1]:
        return _UNDEFINED
    value = sample(grid, esf.value, middle + 0.5) - sample(grid, esf.value, middle - 0.5)
    gradient = esf.gradient(middle + 0.5) - esf.gradient(middle - 0.5)
    tilt = slope(grid, esf.value, middle + 0.5) - slope(grid, esf.value, middle - 0.5)
    return _estimate(value, gradient + tilt * moves)


def _peak(lsf: Lsf) -> float:
    """Place of the LSF's maximum, by the parabola through its three highest points."""
    i = min(max(int(np.argmax(lsf.value)), 1), lsf.value.size - 2)
    a, b, c = lsf.value[i - 1 : i + 2]
    bend = a - 2 * b + c
    step = lsf.distance_px[1] - lsf.distance_px[0]
    return float(lsf.distance_px[i] + (0.5 * step * (a - c) / bend if bend < 0 else 0.0))


def full_width(lsf: Lsf, level: float = 0.5) -> Estimate:
    """Full width of the LSF at `level` of its maximum, in pixels (level 0.5: the FWHM)."""
    grid = lsf.distance_px
    top = _peak(lsf)
    peak = float(sample(grid, lsf.value, top))
    peak_gradient = lsf.gradient(top)
    left = crossing(grid, lsf.value, level * peak, top, -1)
    right = crossing(grid, lsf.value, level * peak, top, +1)
    if math.isnan(left) or math.isnan(right):
        return _UNDEFINED
    gradient = np.zeros_like(peak_gradient)
    for place, sign in ((left, -1.0), (right, 1.0)):
        shortfall = level * peak_gradient - lsf.gradient(place)
        gradient = gradient + sign * shortfall / slope(grid, lsf.value, place)
    return _non_negative(right - left, gradient)


def mtf_crossing(mtf: Mtf, level: float) -> Estimate:
    """Lowest frequency at which the MTF falls to `level`, cycles per pixel (MTF50: 0.5)."""
    place = crossing(mtf.freq_cpp, mtf.value, level, 0.0)
    if math.isnan(place):
        return _UNDEFINED
    gradient = -mtf.gradient(place) / slope(mtf.freq_cpp, mtf.value, place)
    return _non_negative(place, gradient)


def mtf_area(mtf: Mtf) -> Estimate:
    """Area under the MTF from 0 to Nyquist, cycles per pixel (trapezoid rule)."""
    inside = mtf.freq_cpp <= NYQUIST_CPP + 1e-9
    weights = np.full(int(inside.sum()), mtf.freq_cpp[1] - mtf.freq_cpp[0])
    weights[[0, -1]] /= 2
    return _non_negative(
        float(weights @ mtf.value[inside]), weights @ mtf.covariance_factor[inside]
    )


def edge_slope(esf: Esf) -> Estimate:
    """Mean slope of the edge spread function (ESF) between its 40 % and 60 % points, 1/px."""
    low, low_moves = _level_position(esf, 0.4)
    high, high_moves = _level_position(esf, 0.6)
    if math.isnan(low) or math.isnan(high):
        return _UNDEFINED
    run = high - low
    return _non_negative(0.2 / run, -0.2 / run**2 * (high_moves - low_moves))


def half_extent(esf: Esf, side: Literal["dark", "bright"]) -> Estimate:
    """Distance from the 50 % point to the 5 % (dark) or 95 % (bright) point, in pixels."""
    middle, middle_moves = _level_position(esf, 0.5)
    end, end_moves = _level_position(esf, 0.05 if side == "dark" else 0.95)
    if math.isnan(middle) or math.isnan(end):
        return _UNDEFINED
    sign = 1.0 if end > middle else -1.0
    return _non_negative(abs(end - middle), sign * (end_moves - middle_moves))


def overshoot(esf: Esf) -> Estimate:
    """How far the ESF rises above the bright plateau at most (0 where it never does)."""
    i = int(np.argmax(esf.value))
    return _non_negative(max(esf.value[i] - 1.0, 0.0), esf.gradient(float(esf.distance_px[i])))


def undershoot(esf: Esf) -> Estimate:
    """How far the ESF falls below the dark plateau at most (0 where it never does)."""
    i = int(np.argmin(esf.value))
    return _non_negative(max(-esf.value[i], 0.0), esf.gradient(float(esf.distance_px[i])))


def giqe_h(esf: Esf) -> Estimate:
    """Edge height overshoot H of GIQE 4.

    The maximum of ER between 1.0 and 3.0 px from the 50 % point in steps of 0.25 px, or the
    value at 1.25 px when ER only rises there, within its standard deviation (Leachtenauer et al.
    1997, doi:10.1364/AO.36.008322).
    """
    middle, moves = _level_position(esf, 0.5)
    places = middle + np.arange(1.0, 3.01, 0.25)
    if math.isnan(middle) or places[-1] > esf.distance_px[-1]:
        return _UNDEFINED
    values = np.array([sample(esf.distance_px, esf.value, place) for place in places])
    rises = np.diff(values)
    moves_apart = np.diff([esf.gradient(place) for place in places], axis=0)
    # Noise alone makes ER fall here and there: a fall has to be more than two deviations deep.
    falls = rises < -2 * np.linalg.norm(moves_apart, axis=1)
    chosen = places[int(np.argmax(values))] if falls.any() else places[1]
    gradient = esf.gradient(chosen)
    tilt = slope(esf.distance_px, esf.value, chosen)
    return _estimate(sample(esf.distance_px, esf.value, chosen), gradient + tilt * moves)
