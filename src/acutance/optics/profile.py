"""From the OTF along one direction to the edge and line spread functions, at any distance."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_floats
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import Transfer

__all__ = ["Profile"]

PERIOD_PX = 1024
"""Length of the table; its ends meet, so everything must have died away in it."""

BANDS_CPP = (64, 128, 256, 512)
"""Highest frequency of the table: the first one that the OTF does not reach."""

ENDS_CPP = (8, 16, 32)
"""Where an OTF may end; the reference's is below 1e-17 there."""

TAIL_PX, CORE_PX = 1.0, 0.3
"""Scales of the reference's Lorentzian and logistic curve, which is subtracted and added again."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Edge and line spread functions of one direction.

    Both are inverse Fourier transforms of the optical transfer function (OTF) h(f), taken as sums
    over a regular grid of frequencies::

        LSF(s) = 2 Re integral_0^inf h(f) exp(2 pi i f s) df
        ESF(s) = 1/2 + integral_0^inf [Re h sin(2 pi f s) + Im h cos(2 pi f s)] / (pi f) df

    A sum makes the curves periodic, which is harmless only for curves that die away. An aperture
    gives its LSF tails like 1/s^2, seen as a kink of the OTF at zero frequency. So a reference
    with the same kink, the same centroid and closed forms in both domains (a Lorentzian and a
    logistic curve) is subtracted before the sum and added after it; what remains dies away faster
    than 1/s^2 in the ESF.

    Errors of the ESF: below 1e-7 for systems with a Gaussian, an aperture or any other blur that
    stops high frequencies. A bare detector (OTF ~ 1/f) has an ESF with corners: the error is 1e-4
    at a corner and below 1e-6 from 0.01 px on, while the LSF rings at its jumps.

    Parameters
    ----------
    step_px : float
        Spacing of the tables.
    esf_rest, lsf_rest : (n,) array
        What is left of ESF and LSF without the reference, at ``(k - n // 2) step_px`` from the
        centroid.
    tail : float
        Weight of the Lorentzian in the reference.
    centroid_px : float
        Centroid of the LSF, measured from the origin of the point spread function.
    half_px : float
        Where the ESF passes 50 %, measured from the same origin.
    """

    step_px: float
    esf_rest: Floats
    lsf_rest: Floats
    tail: float
    centroid_px: float
    half_px: float

    @classmethod
    def of_otf(cls, otf: Callable[[Floats], Transfer]) -> Profile:
        """The profile of an OTF given as a function of frequency (cycles per pixel, >= 0).

        Raises
        ------
        ModelError
            If the OTF does not fall off: an infinitely sharp system has no profile.
        """
        centroid, tail = _at_zero(otf)
        band = _band_cpp(otf)
        # The transform fills the rest of the table with zeros.
        freq = np.arange(PERIOD_PX * _end_cpp(otf, band) + 1) / PERIOD_PX
        centred = otf(freq) * np.exp(2j * math.pi * freq * centroid)
        rest = centred - _reference_otf(freq, tail)
        size = 2 * PERIOD_PX * band
        integrated = np.zeros_like(rest)
        integrated[1:] = rest[1:] / (2j * math.pi * freq[1:])
        esf_rest = np.fft.fftshift(np.fft.irfft(integrated, size)) * 2 * band
        lsf_rest = np.fft.fftshift(np.fft.irfft(rest, size)) * 2 * band
        about = cls(1 / (2 * band), esf_rest, lsf_rest, tail, centroid, centroid)
        return cls(about.step_px, esf_rest, lsf_rest, tail, centroid, _half_point(about))

    def esf(self, distance_px: ArrayLike) -> Floats:
        """ESF (0 to 1) at distances in pixels from the origin of the point spread function."""
        s = require_floats("distance_px", distance_px) - self.centroid_px
        smooth = self.tail * (0.5 + np.arctan(s / TAIL_PX) / math.pi)
        smooth = smooth + (1 - self.tail) * 0.5 * (1 + np.tanh(s / (2 * CORE_PX)))
        return np.asarray(smooth + self._lookup(self.esf_rest, s))

    def lsf(self, distance_px: ArrayLike) -> Floats:
        """LSF (1/px) at distances in pixels from the origin of the point spread function."""
        s = require_floats("distance_px", distance_px) - self.centroid_px
        lorentzian = TAIL_PX / (math.pi * (s**2 + TAIL_PX**2))
        logistic = (1 - np.tanh(s / (2 * CORE_PX)) ** 2) / (4 * CORE_PX)
        smooth = self.tail * lorentzian + (1 - self.tail) * logistic
        return np.asarray(smooth + self._lookup(self.lsf_rest, s))

    def _lookup(self, table: Floats, s: Floats) -> Floats:
        """Cubic interpolation in a table; nothing is left beyond its ends."""
        position = s / self.step_px + table.size // 2
        first = np.clip(np.floor(position).astype(int) - 1, 0, table.size - 4)
        t = np.clip(position - first, 0.0, 3.0)
        a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
        outer = -b * c * d * table[first] + a * b * c * table[first + 3]
        inner = a * c * d * table[first + 1] - a * b * d * table[first + 2]
        return np.asarray(outer / 6 + inner / 2)


def _reference_otf(freq_cpp: Floats, tail: float) -> Floats:
    lorentzian = np.exp(-2 * math.pi * TAIL_PX * freq_cpp)
    x = 2 * math.pi**2 * CORE_PX * np.maximum(freq_cpp, 1e-12)
    # x / sinh x, without overflow.
    logistic = 2 * x * np.exp(-x) / -np.expm1(-2 * x)
    return np.asarray(tail * lorentzian + (1 - tail) * logistic)


def _at_zero(otf: Callable[[Floats], Transfer]) -> tuple[float, float]:
    """Centroid of the LSF and weight of its Lorentzian tail, from the slope of the OTF at 0+."""
    step = 1e-5
    one, two, four = otf(step * np.array([1.0, 2.0, 4.0])) - 1.0
    # Richardson: the terms in f^2 and f^3 drop out.
    slope = complex(32 * one - 12 * two + four) / (12 * step)
    return 0.0 - slope.imag / (2 * math.pi), 0.0 - slope.real / (2 * math.pi * TAIL_PX)


def _band_cpp(otf: Callable[[Floats], Transfer]) -> int:
    for band in BANDS_CPP:
        beyond = float(np.max(np.abs(otf(np.linspace(0.6 * band, band, 397)))))
        if beyond < 1e-8:
            return band
    if beyond > 0.02:
        raise ModelError(
            f"the sensor still transfers {beyond:.2g} of the contrast at {BANDS_CPP[-1]} cycles "
            "per pixel: add the blur that limits it, such as Detector() or Gaussian(0.3)"
        )
    return BANDS_CPP[-1]


def _end_cpp(otf: Callable[[Floats], Transfer], band: int) -> int:
    """Frequency from which the OTF is zero to the last bit: most end long before the table does."""
    for end in ENDS_CPP:
        if np.max(np.abs(otf(np.linspace(end, band, 397)))) < 1e-17:
            return end
    return band


def _half_point(profile: Profile) -> float:
    """Where the ESF passes 50 %, by bisection around the steepest rise."""
    near = profile.centroid_px + np.arange(-12.0, 12.0, 0.05)
    peak = float(near[np.argmax(profile.lsf(near))])
    grid = peak + np.arange(-12.0, 12.0, 0.05)
    above = profile.esf(grid) >= 0.5
    rises = np.flatnonzero(above[1:] & ~above[:-1])
    if rises.size == 0:
        raise ModelError("the ESF of this sensor does not pass 50 % within 12 px of its steepest")
    first = int(rises[np.argmin(np.abs(grid[rises] - peak))])
    low, high = float(grid[first]), float(grid[first + 1])
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if profile.esf(middle) < 0.5 else (low, middle)
    return 0.5 * (low + high)
