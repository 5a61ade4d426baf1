"""The numbers read from the curves, each with its standard deviation by propagation.

Every function returns a `Reading`. Definitions: the documentation's page "Conventions"; RER and
half extents follow GIQE, the 40-60 % slope follows Kohm (2004).

The error of a curve at x is F(x) z, with F(x) the `row` of its factor there and z the latent
variables that all curves of a measurement share. A place where the curve passes a level moves by
-F(x) z / f'(x), with f' the `slope` of the curve. So every number has a row g of its own, and with
the covariance L L^T of z the variance g L L^T g^T. Any part of that covariance, the share of one
cause, gives its part of the variance by the same row.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

import numpy as np

from acutance.curves.grid import Cubic, crossing
from acutance.curves.reading import UNDEFINED, Reading
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
    "mtf_at",
    "mtf_crossing",
    "overshoot",
    "rer",
    "undershoot",
]

NYQUIST_CPP = 0.5
RerCentre = Literal["half", "peak"]
_ROUNDING = 1e-12
"""What of a level plateau is interpolation between numbers of finite length."""


def _level_position(esf: Esf, level: float) -> Reading:
    """Where the ESF passes `level` next to its 50 % point."""
    middle = esf.half_point.value
    return UNDEFINED if math.isnan(middle) else esf.passing(level, middle, 1 if level > 0.5 else -1)


def rer(esf: Esf, lsf: Lsf, centre: RerCentre = "half") -> Reading:
    """Relative edge response: rise of the ESF over the central pixel, ER(+0.5) - ER(-0.5).

    Parameters
    ----------
    esf, lsf : Esf, Lsf
    centre : {"half", "peak"}
        The 50 % point (GIQE), or the peak of the line spread function (LSF) (KOMPSAT-3 draft, step
        9b).
    """
    grid = esf.distance_px
    # The place of the peak counts as known: it moves the RER by the difference of the LSF half a
    # pixel before and behind it, which is little beside the deviation even of uneven ones.
    middle = esf.half_point if centre == "half" else Reading(_peak(lsf), np.zeros(1))
    before, behind = middle.value - 0.5, middle.value + 0.5
    if not (grid[0] <= before and behind <= grid[-1]):
        return UNDEFINED
    low, high = esf.at(before), esf.at(behind)
    value = high.sample(esf.value) - low.sample(esf.value)
    tilt = high.slope(esf.value) - low.slope(esf.value)
    row = high.sample(esf.factor) - low.sample(esf.factor)
    return Reading(value, row + tilt * middle.row)


def _peak(lsf: Lsf) -> float:
    """Place of the LSF's maximum, by the parabola through its three highest points."""
    i = min(max(int(lsf.value.argmax()), 1), lsf.value.size - 2)
    a, b, c = lsf.value[i - 1 : i + 2].tolist()
    bend = a - 2 * b + c
    step = lsf.distance_px.item(1) - lsf.distance_px.item(0)
    return lsf.distance_px.item(i) + (0.5 * step * (a - c) / bend if bend < 0 else 0.0)


def full_width(lsf: Lsf, level: float = 0.5) -> Reading:
    """Full width of the LSF at `level` of its maximum, in pixels (level 0.5: the FWHM)."""
    grid = lsf.distance_px
    top = _peak(lsf)
    height = level * lsf.at(top).sample(lsf.value)
    left = crossing(grid, lsf.value, height, top, -1)
    right = crossing(grid, lsf.value, height, top, +1)
    if math.isnan(left) or math.isnan(right):
        return UNDEFINED
    rise, low, high = level * lsf.row(top), lsf.at(left), lsf.at(right)
    row = (rise - high.sample(lsf.factor)) / high.slope(lsf.value)
    row -= (rise - low.sample(lsf.factor)) / low.slope(lsf.value)
    return Reading(right - left, row, lowest=0.0)


def mtf_at(mtf: Mtf, freq_cpp: float) -> Reading:
    """The MTF at one frequency."""
    return Reading(*mtf.value_and_row(freq_cpp), lowest=0.0)


def mtf_crossing(mtf: Mtf, level: float) -> Reading:
    """Lowest frequency at which the MTF falls to `level`, cycles per pixel (MTF50: 0.5)."""
    place = crossing(mtf.freq_cpp, mtf.value, level, 0.0)
    if math.isnan(place):
        return UNDEFINED
    row = mtf.row(place) / -Cubic.at(mtf.freq_cpp, place).slope(mtf.value)
    return Reading(place, row, lowest=0.0)


def mtf_area(mtf: Mtf) -> Reading:
    """Area under the MTF from 0 to Nyquist, cycles per pixel (trapezoid rule)."""
    count = int(mtf.freq_cpp.searchsorted(NYQUIST_CPP + 1e-9))
    weights = np.full(count, mtf.freq_cpp[1] - mtf.freq_cpp[0])
    weights[[0, -1]] /= 2
    return Reading(float(weights @ mtf.value[:count]), weights @ mtf.rows[:count], lowest=0.0)


def edge_slope(esf: Esf) -> Reading:
    """Mean slope of the edge spread function (ESF) between its 40 % and 60 % points, 1/px."""
    low, high = _level_position(esf, 0.4), _level_position(esf, 0.6)
    if math.isnan(low.value) or math.isnan(high.value):
        return UNDEFINED
    run = high.value - low.value
    return Reading(0.2 / run, -0.2 / run**2 * (high.row - low.row), lowest=0.0)


def half_extent(esf: Esf, side: Literal["dark", "bright"]) -> Reading:
    """Distance from the 50 % point to the 5 % (dark) or 95 % (bright) point, in pixels."""
    middle, end = esf.half_point, _level_position(esf, 0.05 if side == "dark" else 0.95)
    if math.isnan(middle.value) or math.isnan(end.value):
        return UNDEFINED
    sign = 1.0 if end.value > middle.value else -1.0
    return Reading(abs(end.value - middle.value), sign * (end.row - middle.row), lowest=0.0)


def overshoot(esf: Esf) -> Reading:
    """How far the ESF rises above the bright plateau at most (0 where it never does)."""
    i = int(esf.value.argmax())
    return Reading(max(esf.value.item(i) - 1.0, 0.0), esf.row(esf.distance_px.item(i)), lowest=0.0)


def undershoot(esf: Esf) -> Reading:
    """How far the ESF falls below the dark plateau at most (0 where it never does)."""
    i = int(esf.value.argmin())
    return Reading(max(-esf.value.item(i), 0.0), esf.row(esf.distance_px.item(i)), lowest=0.0)


def giqe_h(esf: Esf) -> Reading:
    """Edge height overshoot H of GIQE 4.

    The maximum of ER between 1.0 and 3.0 px from the 50 % point in steps of 0.25 px, or the
    value at 1.25 px when ER only rises there, within its standard deviation (Leachtenauer et al.
    1997, doi:10.1364/AO.36.008322).
    """
    middle = esf.half_point
    if not middle.value + 3.0 <= esf.distance_px[-1]:
        return UNDEFINED
    places = [esf.at(middle.value + 1.0 + 0.25 * i) for i in range(9)]
    values = [place.sample(esf.value) for place in places]
    highest = values.index(max(values)) if _falls(esf, places, values) else 1
    there = places[highest]
    row = there.sample(esf.factor) + there.slope(esf.value) * middle.row
    return Reading(values[highest], row)


def _falls(esf: Esf, places: list[Cubic], values: list[float]) -> bool:
    """Whether the ESF falls from one place to the next anywhere.

    Noise alone makes it fall here and there: a fall has to be more than two deviations deep.
    """
    depth = [before - behind for before, behind in pairwise(values)]
    falls = [i for i, one in enumerate(depth) if one > _ROUNDING]
    if not falls:
        return False
    row = {i: places[i].sample(esf.factor) for i in {*falls, *(fall + 1 for fall in falls)}}
    rows = np.array([row[i + 1] - row[i] for i in falls])
    std = np.linalg.norm(rows if esf.latent is None else rows @ esf.latent, axis=1)
    return any(depth[i] > 2 * one + _ROUNDING for i, one in zip(falls, std.tolist(), strict=True))
