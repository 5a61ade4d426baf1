"""Interpolation by a kernel that is nearly that of a band limit: splines, windowed sines.

Products on a map's grid are interpolated at phases that drift, and have the mean transfer of all
phases: the Fourier transform of the kernel. Cubic convolution is smooth; splines, with which
Sentinel-2 and many others are resampled, and Lanczos' kernels keep more and end more steeply, at
the Nyquist frequency of the old grid. Cardinal splines of degree m - 1 have the transfer

    K(f) = 1 / sum_k |f / (f - k)|^m,

of every m between a linear interpolation (2), a cubic spline (4) and a band limit (infinity);
Lanczos' kernel of three lobes is within .03 of m = 4, Keys' cubic convolution within .04 of 2.8
(M. Unser, IEEE Signal Processing Magazine 16-6, 1999, 22, section "cardinal splines").
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.term import Term, columns

__all__ = ["RESAMPLING"]

_ORDERS: Final[Floats] = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
"""Of the repetitions of the old grid's spectrum that have a part."""
_TINY: Final = 1e-9
_MOST: Final = 300.0
"""Logarithm of what is as good as infinite: next to a multiple of the old grid's sampling."""


class _Images(NamedTuple):
    """Repetitions of the spectrum along one axis, relative to the spectrum itself.

    Attributes
    ----------
    apart_cpp : (..., n, 6) array
        Frequencies in cycles per old pixel, from the middle of each repetition.
    log_ratio, size : (..., n, 6) arrays
    """

    apart_cpp: Floats
    log_ratio: Floats
    size: Floats

    @property
    def left(self) -> Floats:
        """The transfer, (..., n)."""
        return np.asarray(1 / (1 + self.size.sum(axis=-1)))


def _resampling(p: Floats, plane: Plane) -> Floats:
    """By the logarithms of m, and of the size of an old pixel in new ones."""
    across, along = (_images(p, freq).left for freq in (plane.u_cpp, plane.v_cpp))
    return np.asarray(across * along)


def _resampling_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = (_images(p, freq) for freq in (plane.u_cpp, plane.v_cpp))
    one, other = across.left, along.left
    power = np.exp(p[..., :1])
    by_one, by_other = _slopes(power, across, one), _slopes(power, along, other)
    return np.asarray(by_one * other[..., None, :] + one[..., None, :] * by_other)


def _images(p: Floats, freq_cpp: Floats) -> _Images:
    power, size = columns(np.exp(p))
    old_cpp = (size * freq_cpp)[..., None]
    apart = old_cpp - _ORDERS
    apart = np.where(np.abs(apart) < _TINY, _TINY, apart)
    log_ratio = np.log(np.maximum(np.abs(old_cpp / apart), _TINY))
    return _Images(apart, log_ratio, np.exp(np.minimum(power[..., None] * log_ratio, _MOST)))


def _slopes(power: Floats, images: _Images, left: Floats) -> Floats:
    """Derivatives of the transfer along one axis by both parameters, (..., 2, n)."""
    growth = power * left**2
    by_power = -growth * np.sum(images.size * images.log_ratio, axis=-1)
    by_size = growth * np.sum(images.size * _ORDERS / images.apart_cpp, axis=-1)
    return np.stack([by_power, by_size], axis=-2)


def _resampling_numbers(p: Floats) -> dict[str, float]:
    return {"spline_degree": math.exp(p[0]) - 1, "old_pixel_px": math.exp(p[1])}


RESAMPLING: Final = Term(
    _resampling, (math.log(3.5), 0.0), (0.35, 0.15), _resampling_numbers, _resampling_slopes
)
"""Prior: degrees of 1.5 to 4, old pixels between .85 and 1.16 new ones."""
