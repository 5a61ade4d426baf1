"""Blur made by a telescope that is out of alignment: aberrations of low order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import fft, ndimage

from acutance.curves.grid import Floats
from acutance.optics.aperture import Diffraction
from acutance.optics.block import Transfer, require

__all__ = ["Aberrations"]

_ACROSS = 256
"""Samples across the pupil."""
_NO_OVERLAP = 1e-5
"""Share of the pupil below which what two shifted pupils have in common is no longer sampled."""


@dataclass(frozen=True)
class Aberrations:
    """A circular aperture with aberrations, diffraction included: use it instead of `Diffraction`.

    The autocorrelation of the pupil ``exp(2 pi i W)``, with the wavefront W a sum of Zernike
    polynomials of the whole disc, each of mean square one over it (Noll, JOSA 66, 207, 1976)::

        W = sqrt(3) d (2 r^2 - 1) + sqrt(6) r^2 (a_0 cos 2t + a_45 sin 2t)
            + sqrt(8) (3 r^3 - 2 r) (c_x cos t + c_y sin t) + sqrt(5) s (6 r^4 - 6 r^2 + 1)

    Coma makes the spread function uneven: where it is positive, the tail points towards lower
    columns (c_x) or rows (c_y).

    The pupil is sampled, 256 times across, and autocorrelated by Fourier transforms, with and
    without aberrations; their ratio multiplies the exact OTF without them. It has kinks at shifts
    at which rims of pupil and obscuration touch, where errors are largest: below 2e-4 for .15
    waves in all and an obscuration of up to .3, 4e-4 for one of .6; beyond, with large
    obscurations, they grow to 2e-3 (.4 waves, .9 obscured) and 3e-2 (1 wave, .99 obscured).

    Parameters
    ----------
    cutoff_cpp : float
        Cut-off frequency of the aperture in cycles per pixel, as in `Diffraction`.
    obscuration : float, optional
        Diameter of the obscuration over that of the aperture, 0 to below 1.
    defocus_waves, astigmatism_waves, astigmatism_45_waves, coma_across_waves, coma_along_waves,
    spherical_waves : float, optional
        Coefficients d, a_0, a_45, c_x, c_y and s: root mean square over the disc, in wavelengths.
    """

    cutoff_cpp: float
    obscuration: float = 0.0
    defocus_waves: float = 0.0
    astigmatism_waves: float = 0.0
    astigmatism_45_waves: float = 0.0
    coma_across_waves: float = 0.0
    coma_along_waves: float = 0.0
    spherical_waves: float = 0.0

    def __post_init__(self) -> None:
        require(self, above=True, cutoff_cpp=self.cutoff_cpp)
        require(self, 0.0, 0.99, obscuration=self.obscuration)
        require(
            self, -1.0, 1.0,
            defocus_waves=self.defocus_waves, astigmatism_waves=self.astigmatism_waves,
            astigmatism_45_waves=self.astigmatism_45_waves,
            coma_across_waves=self.coma_across_waves, coma_along_waves=self.coma_along_waves,
            spherical_waves=self.spherical_waves,
        )  # fmt: skip

    def otf(self, u: Floats, v: Floats) -> Transfer:
        bare = np.asarray(Diffraction(self.cutoff_cpp, self.obscuration).otf(u, v))
        inside = bare > 0
        # A shift by the whole pupil is the cut-off.
        places = [
            _ACROSS * (1 + np.broadcast_to(w, bare.shape)[inside] / self.cutoff_cpp) for w in (v, u)
        ]
        real, imaginary = (
            ndimage.map_coordinates(part, places, order=3, prefilter=False, mode="mirror")
            for part in _factors(
                self.obscuration, self.defocus_waves, self.astigmatism_waves,
                self.astigmatism_45_waves, self.coma_across_waves, self.coma_along_waves,
                self.spherical_waves,
            )
        )  # fmt: skip
        otf = bare.astype(complex)
        otf[inside] *= 1 + real + 1j * imaginary
        return otf


@lru_cache(maxsize=16)
def _factors(obscuration: float, *waves: float) -> tuple[Floats, Floats]:
    """The factor of an OTF that aberrations are, less one: real and imaginary part, as splines.

    Coefficients, both (2 n, 2 n), over shifts of -n to n - 1 samples of the pupil, rows along.
    """
    across = np.asarray((np.arange(_ACROSS) - 0.5 * (_ACROSS - 1)) / (0.5 * _ACROSS), float)
    x, y = across, across[:, None]
    seen = _disc(np.hypot(x, y), 1.0)
    if obscuration > 0:
        seen = seen - _disc(np.hypot(x, y), obscuration)
    bare = _autocorrelation(seen.astype(complex)).real
    aberrated = _autocorrelation(seen * np.exp(2j * math.pi * _wavefront(x, y, waves)))
    overlap = bare > _NO_OVERLAP * bare.max()
    change = np.divide(aberrated - bare, bare, out=np.zeros_like(aberrated), where=overlap)
    return ndimage.spline_filter(change.real, 3), ndimage.spline_filter(change.imag, 3)


def _disc(radius: Floats, limit: float) -> Floats:
    """Share of every sample that a disc covers, nearly."""
    return np.clip(0.5 + (limit - radius) * (_ACROSS / 2), 0.0, 1.0)


def _wavefront(x: Floats, y: Floats, waves: tuple[float, ...]) -> Floats:
    defocus, astigmatism, astigmatism_45, across, along, spherical = waves
    square = x**2 + y**2
    found = math.sqrt(3) * defocus * (2 * square - 1)
    found = found + math.sqrt(6) * (astigmatism * (x**2 - y**2) + astigmatism_45 * 2 * x * y)
    found = found + math.sqrt(8) * (3 * square - 2) * (across * x + along * y)
    return np.asarray(found + math.sqrt(5) * spherical * (6 * square**2 - 6 * square + 1))


def _autocorrelation(pupil: Transfer) -> Transfer:
    """Of a pupil padded to twice its size; that of no shift is in the middle."""
    power = np.abs(fft.fft2(pupil, (2 * _ACROSS, 2 * _ACROSS))) ** 2
    return np.asarray(fft.fftshift(fft.ifft2(power)))
