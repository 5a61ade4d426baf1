"""The simplest model of a blurred edge: a Gaussian seen through the width of a pixel.

Line spread function (LSF) = Gaussian(sigma) * box(aperture). It is the first fit of every straight
target and the mean of the prior of its LSF: the free spline is a correction of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.normal_distribution import normal_distribution

__all__ = ["FWHM_OF_SIGMA", "GaussianPixel", "blurred_step", "gaussian", "gaussian_pixel_width"]

_Curves = Callable[[Floats, float, float], Floats]
_PEAK = 1 / math.sqrt(2 * math.pi)
_ROOT_TWELVE = math.sqrt(12)
FWHM_OF_SIGMA: Final = 2.3548200450309493
"""Full width at half maximum (FWHM) of a Gaussian of unit standard deviation."""


def gaussian_pixel_width(sigma_px: float, aperture_px: float) -> float:
    """FWHM of the Gaussian with the variance of a Gaussian through a pixel."""
    return FWHM_OF_SIGMA * math.hypot(sigma_px, aperture_px / _ROOT_TWELVE)


def gaussian(z: Floats) -> Floats:
    """Standard normal density."""
    power = z * z
    power *= -0.5
    np.exp(power, out=power)
    power *= _PEAK
    return np.asarray(power)


@inlined
def blurred_step(s: float, sigma: float, aperture: float) -> tuple[float, float, float, float]:
    """ESF of a Gaussian through a pixel and its derivatives by s (the LSF), sigma and aperture.

    At one normal distance `s`, for compiled loops.
    """
    # The ends of the aperture as standard normal variables.
    high, low = (s + 0.5 * aperture) / sigma, (s - 0.5 * aperture) / sigma
    below_high, at_high = normal_distribution(high)
    below_low, at_low = normal_distribution(low)
    # The integral of the normal distribution between the ends.
    esf = sigma / aperture * (high * below_high + at_high - (low * below_low + at_low))
    by_aperture = (0.5 * (below_high + below_low) - esf) / aperture
    return esf, (below_high - below_low) / aperture, (at_high - at_low) / aperture, by_aperture


@inlined
def _blurred_line(s: float, sigma: float, aperture: float) -> tuple[float, float, float, float]:
    """LSF at one distance, and its derivatives by s, sigma and aperture."""
    high, low = (s + 0.5 * aperture) / sigma, (s - 0.5 * aperture) / sigma
    below_high, at_high = normal_distribution(high)
    below_low, at_low = normal_distribution(low)
    scale = 1 / (sigma * aperture)
    lsf = (below_high - below_low) / aperture
    by_aperture = 0.5 * (at_high + at_low) * scale - lsf / aperture
    return lsf, (at_high - at_low) * scale, (low * at_low - high * at_high) * scale, by_aperture


@compiled
def _blurred_steps(s: Floats, sigma: float, aperture: float) -> Floats:
    """`blurred_step` at many distances, (4, n)."""
    found = np.empty((4, s.size))
    for k in range(s.size):
        found[0, k], found[1, k], found[2, k], found[3, k] = blurred_step(s[k], sigma, aperture)
    return found


@compiled
def _blurred_lines(s: Floats, sigma: float, aperture: float) -> Floats:
    """`_blurred_line` at many distances, (4, n)."""
    found = np.empty((4, s.size))
    for k in range(s.size):
        found[0, k], found[1, k], found[2, k], found[3, k] = _blurred_line(s[k], sigma, aperture)
    return found


@dataclass(frozen=True)
class GaussianPixel:
    """Gaussian of standard deviation `sigma_px` through a box of `aperture_px` (both > 0)."""

    sigma_px: float
    aperture_px: float = 1.0

    @property
    def width_px(self) -> float:
        """FWHM of the Gaussian with the same variance: the unit of distance of a fit."""
        return gaussian_pixel_width(self.sigma_px, self.aperture_px)

    def lsf(self, s: Floats) -> Floats:
        """LSF at normal distances `s`, 1/px."""
        return self.esf_and_lsf(s)[1]

    def esf(self, s: Floats) -> Floats:
        """Edge spread function (ESF) at normal distances `s`."""
        return self.esf_and_lsf(s)[0]

    def esf_and_lsf(self, s: Floats) -> tuple[Floats, Floats]:
        """ESF and LSF at normal distances `s`."""
        return self.esf_and_slopes(s)[:2]

    def otf(self, freq_cpp: Floats) -> Floats:
        """Transfer function at frequencies in cycles per pixel (real: the LSF is symmetric)."""
        gauss = np.exp(-2 * np.pi**2 * (self.sigma_px * freq_cpp) ** 2)
        return np.asarray(gauss * np.sinc(self.aperture_px * freq_cpp))

    def esf_and_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """ESF with its derivatives by s (the LSF), by sigma and by aperture, each like `s`."""
        return self._along(_blurred_steps, s)

    def lsf_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """LSF with its derivatives by s, by sigma and by aperture, each like `s`."""
        return self._along(_blurred_lines, s)

    def _along(self, curves: _Curves, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Four curves at the distances `s`, each of its shape."""
        flat = np.ascontiguousarray(s, float).reshape(-1)
        found = curves(flat, float(self.sigma_px), float(self.aperture_px))
        one, two, three, four = found.reshape(4, *s.shape)
        return one, two, three, four
