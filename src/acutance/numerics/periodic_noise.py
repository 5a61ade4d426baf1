"""Noise whose variance varies periodically over an image: what interpolation leaves.

An interpolated pixel is a weighted mean of its neighbours in the old grid, and its noise has a
variance that depends on where it lies among them (A. C. Gallagher, Proc. 2nd Canadian Conference on
Computer and Robot Vision, 2005, 65, DOI 10.1109/CRV.2005.33). Where the grid was stretched or
turned that place drifts from pixel to pixel, and the variance beats with the difference of both
grids: with 1 - 1/s cycles per pixel along rows and columns of an image enlarged s times. Rows and
columns of the old grid are at right angles, so there are two beats, at right angles as well.
Stripes of a detector are along one axis alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["STEADY", "PeriodicNoise", "periodic_noise"]

_MIN_SIDE_PX: Final = 128
_SIDE: Final = 256
"""Frequencies of the periodogram along either axis."""
_FLOOR: Final = 0.2
"""Of the median detail, below which differences are the rounding's."""
_LOCAL_PX: Final = 16
"""Side of the square whose mean level is taken out: the ground is rougher here than there."""
_MAX_LEVEL: Final = 1.0
"""Above that mean: borders of objects are no noise."""
_MIN_CPP: Final = 0.03
"""Longer periods are those of the objects."""
_RING: Final = (7, 15)
"""Sides of the squares between which a peak's surroundings lie. Those of a tone are 3 wide."""
_MIN_HEIGHT: Final = 20.0
"""Power of both beats over that of their surroundings. By chance the highest pair of a part has 6;
of 1200 simulated ones with and without stripes, texture and rounding 13.6 at most."""
_MIN_HEIGHT_APART: Final = 40.0
"""Of two beats of different period, one along each axis: fields and streets have some."""
_QUANTILE: Final = 0.75
"""Of several parts, frequency by frequency: in some nothing can be seen, and an orchard or a row of
houses has the same period nowhere else."""
_BLOCK: Final = 8
_BLOCK_REACH: Final = 3
"""JPEG's blocks beat with 1/8, 2/8 and 3/8 cycle per pixel, and these reach so many places."""


class PeriodicNoise(NamedTuple):
    """How the noise of an image varies.

    Attributes
    ----------
    amplitude : float
        Of its standard deviation, relative, as second differences see it; 0 where chance may do it.
        Of a wave of f cycles per pixel down white noise they leave the share ``(2 + cos 2 pi f) /
        3``: their variance is that of three pixels, 1 : 4 : 1.
    beats_cpp : ((row, col), (row, col))
        Frequencies of both beats, cycles per pixel down the rows and along the columns.
    """

    amplitude: float
    beats_cpp: tuple[tuple[float, float], tuple[float, float]]


STEADY: Final = PeriodicNoise(0.0, ((0.0, 0.0), (0.0, 0.0)))
"""Noise that does not vary."""


def periodic_noise(parts: Iterable[Floats]) -> PeriodicNoise:
    """By how much the noise of an image varies periodically, and with which beats.

    Noise is seen in second differences along rows and columns, where little of the ground is left;
    their logarithm less its local mean is transformed to a periodogram.

    Parameters
    ----------
    parts : iterable of (rows, cols) arrays
        Of one image, at most 256 a side; NaN where a pixel is not to be used. Those of fewer than
        128 show nothing.
    """
    found = [_periodogram(one) for one in parts if min(one.shape) >= _MIN_SIDE_PX]
    amplitudes = [one for one in found if one is not None]
    if not amplitudes:
        return STEADY
    each = np.sort([_heights(one**2) for one in amplitudes], axis=0)
    both = _highest_pair(each[math.floor(_QUANTILE * (len(each) - 1))])
    if both is None:
        return STEADY
    amplitude = np.mean([np.median([one[at] for one in amplitudes]) / _left(*at) for at in both])
    first, second = ((_cpp(row), _cpp(col)) for row, col in both)
    return PeriodicNoise(float(amplitude), (first, second))


def _periodogram(pixels: Floats) -> Floats | None:
    """Amplitudes of what the logarithm of the noise has of every frequency, (256, 256).

    None where the pixels have no noise, or are not known.
    """
    detail = np.abs(_second_differences(_second_differences(pixels).T).T)
    known = np.isfinite(detail)
    scale = float(np.median(detail[known])) if known.any() else 0.0
    if not scale > 0:
        return None
    detail = np.where(known, detail, scale)
    level = np.where(known, _levelled(np.log(detail + _FLOOR * scale), known), 0.0)
    window = np.outer(*(np.hanning(size + 2)[1:-1] for size in level.shape)) * known
    # A change of the noise by 1 % changes the levels by less, because of the floor.
    follows = float(np.mean(detail[known] / (detail[known] + _FLOOR * scale)))
    waves = np.abs(np.fft.fft2(level * window, (_SIDE, _SIDE)))
    return np.asarray(waves * (2 / (window.sum() * follows)))


def _second_differences(pixels: Floats) -> Floats:
    """Down the columns, (n - 2, m)."""
    return np.asarray(pixels[2:] - 2 * pixels[1:-1] + pixels[:-2])


def _levelled(level: Floats, known: NDArray[np.bool_]) -> Floats:
    """Levels (n, m) less the mean of what is known around, cut off where objects stand out."""
    both = np.where(known, level, 0.0), known.astype(float)
    sums, counts = (_square_sums(one, _LOCAL_PX, "reflect") for one in both)
    return np.asarray(np.minimum(level - sums / np.maximum(counts, 1.0), _MAX_LEVEL))


def _square_sums(values: Floats, side: int, beyond: Literal["reflect", "wrap"]) -> Floats:
    """Sums over the square of so many pixels around every pixel, in the shape of the values."""
    before, behind = side // 2, side - side // 2 - 1
    padded = np.pad(values, (before + 1, behind), mode=beyond)
    sums = padded.cumsum(axis=0).cumsum(axis=1)
    rows = sums[side:] - sums[:-side]
    return np.asarray(rows[:, side:] - rows[:, :-side])


def _heights(power: Floats) -> Floats:
    """Power over that of its surroundings, whose root mean square counts the highest most."""
    power = power / power.mean()
    inner, outer = (_square_sums(power**2, side, "wrap") for side in _RING)
    around = np.maximum(outer - inner, 0.0) / (_RING[1] ** 2 - _RING[0] ** 2)
    # Of noise the mean square of the power is twice the square of its mean.
    return np.asarray(power / np.sqrt(np.maximum(around / 2, 1e-20)))


def _highest_pair(heights: Floats) -> tuple[tuple[int, int], tuple[int, int]] | None:
    """Two beats at right angles, as places (row, col); None where neither pair is high enough.

    Either they are as fast, in any direction, or one runs along each axis.
    """
    half = np.arange(_SIDE // 2 + 1)
    quarter = np.where(_SEEN, heights[: half.size, : half.size], 0.0)
    turned = np.where(_SEEN, heights[-half, : half.size].T, 0.0)
    # Along the axes a pair has two places, of which one will do.
    alike = np.minimum(quarter, turned) * (half > 0)[:, None]
    row, col = map(int, np.unravel_index(int(alike.argmax()), alike.shape))
    down, right = int(quarter[:, 0].argmax()), int(quarter[0].argmax())
    along_axes = min(quarter[down, 0], quarter[0, right])
    if alike[row, col] >= _MIN_HEIGHT:
        return (row, col), (-col, row)
    return ((down, 0), (0, right)) if along_axes >= _MIN_HEIGHT_APART else None


def _seen() -> NDArray[np.bool_]:
    """Which frequencies (row, col) from 0 to .5 count: neither slow ones nor those of JPEG."""
    places = np.arange(_SIDE // 2 + 1)
    step = _SIDE // _BLOCK
    off = np.abs(places - step * np.rint(places / step))
    of_block = (off <= _BLOCK_REACH) & (places > step / 2) & (places < _SIDE / 2 - step / 2)
    on_axis = places <= 1
    of_jpeg = np.outer(of_block | on_axis, of_block) | np.outer(of_block, on_axis)
    slow = np.hypot(places[:, None], places) < _MIN_CPP * _SIDE
    return np.asarray(~(of_jpeg | slow))


_SEEN: Final = _seen()


def _left(row: int, col: int) -> float:
    """Share of a beat at a place that is left when local means are taken out."""
    mean = np.sinc(_LOCAL_PX * _cpp(row)) * np.sinc(_LOCAL_PX * _cpp(col))
    return float(1 - mean)


def _cpp(place: int) -> float:
    return place / _SIDE
