"""The simplest model of a blurred edge: a Gaussian seen through the width of a pixel.

Line spread function (LSF) = Gaussian(sigma) * box(aperture). It is the first fit of every straight
target and the mean of the prior of its LSF: the free spline is a correction of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats

__all__ = ["FWHM_OF_SIGMA", "GaussianPixel", "gaussian"]

_PEAK = 1 / math.sqrt(2 * math.pi)
_ROOT_TWELVE = math.sqrt(12)
FWHM_OF_SIGMA: Final = 2.3548200450309493
"""Full width at half maximum (FWHM) of a Gaussian of unit standard deviation."""


def gaussian(z: Floats) -> Floats:
    """Standard normal density."""
    power = z * z
    power *= -0.5
    np.exp(power, out=power)
    power *= _PEAK
    return np.asarray(power)


@dataclass(frozen=True)
class GaussianPixel:
    """Gaussian of standard deviation `sigma_px` through a box of `aperture_px` (both > 0)."""

    sigma_px: float
    aperture_px: float = 1.0

    @property
    def width_px(self) -> float:
        """FWHM of the Gaussian with the same variance: the unit of distance of a fit."""
        return FWHM_OF_SIGMA * math.hypot(self.sigma_px, self.aperture_px / _ROOT_TWELVE)

    def lsf(self, s: Floats) -> Floats:
        """LSF at normal distances `s`, 1/px."""
        return self.esf_and_lsf(s)[1]

    def esf(self, s: Floats) -> Floats:
        """Edge spread function (ESF) at normal distances `s`."""
        return self.esf_and_lsf(s)[0]

    def esf_and_lsf(self, s: Floats) -> tuple[Floats, Floats]:
        """ESF and LSF at normal distances `s`."""
        esf, lsf = np.asarray(s > 0, float), np.zeros(s.shape)
        # Beyond nine standard deviations from the aperture's ends the ESF is 0 or 1.
        near = np.abs(s) < 0.5 * self.aperture_px + 9.0 * self.sigma_px
        ends = self._ends(s[near])
        cdf = ndtr(ends)
        esf[near] = self._ramp(ends, cdf, gaussian(ends))
        lsf[near] = (cdf[0] - cdf[1]) / self.aperture_px
        return esf, lsf

    def otf(self, freq_cpp: Floats) -> Floats:
        """Transfer function at frequencies in cycles per pixel (real: the LSF is symmetric)."""
        gauss = np.exp(-2 * np.pi**2 * (self.sigma_px * freq_cpp) ** 2)
        return np.asarray(gauss * np.sinc(self.aperture_px * freq_cpp))

    def esf_and_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """ESF with its derivatives by s (the LSF), by sigma and by aperture, each like `s`."""
        ends = self._ends(s)
        cdf, pdf = ndtr(ends), gaussian(ends)
        esf = self._ramp(ends, cdf, pdf)
        lsf = (cdf[0] - cdf[1]) / self.aperture_px
        by_sigma = (pdf[0] - pdf[1]) / self.aperture_px
        by_aperture = (0.5 * (cdf[0] + cdf[1]) - esf) / self.aperture_px
        return esf, lsf, by_sigma, by_aperture

    def lsf_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """LSF with its derivatives by s, by sigma and by aperture, each like `s`."""
        ends = self._ends(s)
        cdf, pdf = ndtr(ends), gaussian(ends)
        scale = 1 / (self.sigma_px * self.aperture_px)
        lsf = (cdf[0] - cdf[1]) / self.aperture_px
        by_sigma = (ends[1] * pdf[1] - ends[0] * pdf[0]) * scale
        by_aperture = 0.5 * (pdf[0] + pdf[1]) * scale - lsf / self.aperture_px
        return lsf, (pdf[0] - pdf[1]) * scale, by_sigma, by_aperture

    def _ends(self, s: Floats) -> Floats:
        """The two ends of the aperture as standard normal variables, (2, n)."""
        ends = np.empty((2, s.size))
        half = 0.5 * self.aperture_px
        np.add(s, half, out=ends[0])
        np.subtract(s, half, out=ends[1])
        ends *= 1 / self.sigma_px
        return ends

    def _ramp(self, ends: Floats, cdf: Floats, pdf: Floats) -> Floats:
        """The ESF: the integral of the normal distribution between the ends."""
        ramp = ends * cdf
        ramp += pdf
        return np.asarray((self.sigma_px / self.aperture_px) * (ramp[0] - ramp[1]))
