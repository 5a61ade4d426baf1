"""The plainest model of a blurred edge: a Gaussian through a square detector.

LSF = Gaussian(sigma) * box(aperture). It starts every fit, and is the mean of the prior of the
LSF: what the free spline adds is the departure from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats

__all__ = ["Blur", "gaussian"]

_ROOT_TWO_PI = np.sqrt(2 * np.pi)
FWHM_OF_SIGMA = 2.3548200450309493


def gaussian(z: Floats) -> Floats:
    """Standard normal density."""
    return np.asarray(np.exp(-0.5 * z * z) / _ROOT_TWO_PI)


@dataclass(frozen=True)
class Blur:
    """Gaussian of standard deviation `sigma_px` through a box of `aperture_px` (both > 0)."""

    sigma_px: float
    aperture_px: float = 1.0

    @property
    def width_px(self) -> float:
        """FWHM of the Gaussian with the same variance: the unit of distance of a fit."""
        return FWHM_OF_SIGMA * float(np.hypot(self.sigma_px, self.aperture_px / np.sqrt(12)))

    def lsf(self, s: Floats) -> Floats:
        """Line spread function at normal distances `s`, 1/px."""
        high, low = self._ends(s)
        return np.asarray((ndtr(high) - ndtr(low)) / self.aperture_px)

    def esf(self, s: Floats) -> Floats:
        """Edge spread function at normal distances `s`."""
        high, low = self._ends(s)
        ramp = high * ndtr(high) + gaussian(high) - low * ndtr(low) - gaussian(low)
        return np.asarray(self.sigma_px / self.aperture_px * ramp)

    def esf_and_lsf(self, s: Floats) -> tuple[Floats, Floats]:
        """Edge and line spread function at normal distances `s`."""
        high, low = self._ends(s)
        cdf_high, cdf_low = ndtr(high), ndtr(low)
        ramp = high * cdf_high + gaussian(high) - low * cdf_low - gaussian(low)
        esf = self.sigma_px / self.aperture_px * ramp
        return np.asarray(esf), np.asarray((cdf_high - cdf_low) / self.aperture_px)

    def otf(self, freq_cpp: Floats) -> Floats:
        """Transfer function at frequencies in cycles per pixel (real: the blur is symmetric)."""
        fall = np.exp(-2 * np.pi**2 * (self.sigma_px * freq_cpp) ** 2)
        return np.asarray(fall * np.sinc(self.aperture_px * freq_cpp))

    def esf_and_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """ESF with its derivatives by s (the LSF), by sigma and by aperture, each like `s`."""
        high, low = self._ends(s)
        cdf_high, cdf_low = ndtr(high), ndtr(low)
        pdf_high, pdf_low = gaussian(high), gaussian(low)
        ramp = high * cdf_high + pdf_high - low * cdf_low - pdf_low
        esf = self.sigma_px / self.aperture_px * ramp
        lsf = (cdf_high - cdf_low) / self.aperture_px
        by_sigma = (pdf_high - pdf_low) / self.aperture_px
        by_aperture = (0.5 * (cdf_high + cdf_low) - esf) / self.aperture_px
        return esf, lsf, by_sigma, by_aperture

    def lsf_slopes(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the LSF by s, by sigma and by aperture."""
        high, low = self._ends(s)
        pdf_high, pdf_low = gaussian(high), gaussian(low)
        scale = 1 / (self.sigma_px * self.aperture_px)
        lsf = (ndtr(high) - ndtr(low)) / self.aperture_px
        by_sigma = -(high * pdf_high - low * pdf_low) * scale
        by_aperture = 0.5 * (pdf_high + pdf_low) * scale - lsf / self.aperture_px
        return (pdf_high - pdf_low) * scale, by_sigma, by_aperture

    def _ends(self, s: Floats) -> tuple[Floats, Floats]:
        half = 0.5 * self.aperture_px
        return (s + half) / self.sigma_px, (s - half) / self.sigma_px
