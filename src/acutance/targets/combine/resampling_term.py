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
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.term import Term

__all__ = ["RESAMPLING"]

_IMAGES: Final[Floats] = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
"""Repetitions of the old grid's spectrum that have a part."""
_TINY: Final = 1e-9
_MOST: Final = 300.0
"""Logarithm of what is as good as infinite: next to a multiple of the old grid's sampling."""


def _resampling(p: Floats, plane: Plane) -> Floats:
    """By the logarithms of m, and of the size of an old pixel in new ones."""
    across, along = (_along_axis(p, freq)[0] for freq in (plane.u_cpp, plane.v_cpp))
    return np.asarray(across * along)


def _resampling_slopes(p: Floats, plane: Plane) -> Floats:
    (across, *by_across), (along, *by_along) = (
        _along_axis(p, freq) for freq in (plane.u_cpp, plane.v_cpp)
    )
    slopes = [one * along + across * other for one, other in zip(by_across, by_along, strict=True)]
    return np.stack(slopes, axis=1)


def _along_axis(p: Floats, freq_cpp: Floats) -> tuple[Floats, Floats, Floats]:
    """The transfer along one axis, (n,), and its derivatives by both parameters."""
    power = math.exp(p[0])
    old = math.exp(p[1]) * freq_cpp[:, None]
    apart = old - _IMAGES
    apart = np.where(np.abs(apart) < _TINY, _TINY, apart)
    log_ratio = np.log(np.maximum(np.abs(old / apart), _TINY))
    image = np.exp(np.minimum(power * log_ratio, _MOST))
    values = 1 / (1 + image.sum(axis=1))
    by_power = -(values**2) * power * np.sum(image * log_ratio, axis=1)
    by_size = (values**2) * power * np.sum(image * _IMAGES / apart, axis=1)
    return values, by_power, by_size


def _resampling_numbers(p: Floats) -> dict[str, float]:
    return {"spline_degree": math.exp(p[0]) - 1, "old_pixel_px": math.exp(p[1])}


RESAMPLING: Final = Term(
    _resampling, (math.log(3.5), 0.0), (0.35, 0.15), _resampling_numbers, _resampling_slopes
)
"""Prior: degrees of 1.5 to 4, old pixels between .85 and 1.16 new ones."""
