"""The simplest model of a point's image: an elliptical, rotated Gaussian seen through a pixel.

Point spread function (PSF) = Gaussian(Sigma) * square of side `aperture_px`, of unit volume, with x
the column and y the row direction. It is the first fit of point sources and the mean of the prior
of their PSF, and the mean of the transfer function of bars and stars.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, gaussian

__all__ = ["MIN_SIGMA_PX", "WIDE_WIDTHS", "GaussianPixel2d", "PixelSlopes"]

_REACH = 7.0
"""Distance from the aperture's edge, in standard deviations, beyond which the PSF is 0."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
WIDE_WIDTHS: Final = 2.0
"""Width of the wings over that of the core."""
MIN_SIGMA_PX: Final = 0.36
"""Through a pixel's area, a narrower Gaussian looks like a point."""


class PixelSlopes(NamedTuple):
    """A PSF and its derivatives, (n,) each.

    Attributes
    ----------
    psf
        Light per square pixel.
    by_x, by_y
        By the position.
    by_xx, by_xy, by_yy
        By the elements of Sigma (`by_xy` moves both off-diagonal elements).
    by_width_x, by_width_y
        By the aperture's width in either direction.
    """

    psf: Floats
    by_x: Floats
    by_y: Floats
    by_xx: Floats
    by_xy: Floats
    by_yy: Floats
    by_width_x: Floats
    by_width_y: Floats


@dataclass(frozen=True)
class GaussianPixel2d:
    """Gaussian of covariance ((xx, xy), (xy, yy)) in square pixels, through a square aperture."""

    xx: float
    xy: float
    yy: float
    aperture_px: float = 1.0

    @cached_property
    def widths_px(self) -> tuple[float, float]:
        """Full widths at half maximum across and along of Gaussians with the same variances."""
        box = self.aperture_px**2 / 12
        return (
            FWHM_OF_SIGMA * math.sqrt(self.xx + box),
            FWHM_OF_SIGMA * math.sqrt(self.yy + box),
        )

    @property
    def min_sigma_px(self) -> float:
        """Standard deviation along the minor axis of the ellipse."""
        mean = 0.5 * (self.xx + self.yy)
        half_difference = math.hypot(0.5 * (self.xx - self.yy), self.xy)
        return math.sqrt(max(mean - half_difference, 0.0))

    @property
    def peak(self) -> float:
        """PSF at its centre: the value of a pixel with a source of unit flux in its middle."""
        return float(self.psf(np.zeros(1), np.zeros(1))[0])

    def moved(self, xx: float, xy: float, yy: float) -> GaussianPixel2d:
        """The PSF with Sigma changed by a step, kept positive definite and not too narrow."""
        sigma = np.array([[self.xx + xx, self.xy + xy], [self.xy + xy, self.yy + yy]])
        power, axes = np.linalg.eigh(sigma)
        old = max(self.xx, self.yy)
        power = np.clip(power, max(MIN_SIGMA_PX**2, 0.1 * self.min_sigma_px**2), 4 * old)
        sigma = (axes * power) @ axes.T
        return GaussianPixel2d(
            float(sigma[0, 0]), float(sigma[0, 1]), float(sigma[1, 1]), self.aperture_px
        )

    def widened(self, widths: float) -> GaussianPixel2d:
        """The PSF `widths` times as wide, through the same aperture."""
        more = widths**2
        box = (more - 1) * self.aperture_px**2 / 12
        return GaussianPixel2d(
            more * self.xx + box, more * self.xy, more * self.yy + box, self.aperture_px
        )

    def psf(self, x: Floats, y: Floats) -> Floats:
        """The PSF at places (x, y), (n,)."""
        half = 0.5 * self.aperture_px
        found = np.zeros(x.size)
        near = self._near(x, y)
        nodes = y[near] + half * _NODES[:, None]
        row, high, low, _ = self._ends(x[near], nodes)
        found[near] = (half / self.aperture_px**2) * _WEIGHTS @ (row * (ndtr(high) - ndtr(low)))
        return found

    def slopes(self, x: Floats, y: Floats) -> PixelSlopes:
        """The PSF and all of its derivatives at places (x, y), (n,).

        Along y the Gaussian is integrated over the aperture by quadrature, along x in closed
        form, given y. The Gaussian solves the heat equation, so that its derivative by Sigma is
        half of a second derivative by place: a difference of integrands at the aperture's ends.
        """
        found = np.zeros((len(PixelSlopes._fields), x.size))
        near = self._near(x, y)
        found[:, near] = self._slopes_near(x[near], y[near])
        return PixelSlopes(*found)

    def _near(self, x: Floats, y: Floats) -> NDArray[np.intp]:
        """Indices of the places within reach of the PSF."""
        half = 0.5 * self.aperture_px
        near = np.abs(x) < half + _REACH * math.sqrt(self.xx)
        near &= np.abs(y) < half + _REACH * math.sqrt(self.yy)
        return np.flatnonzero(near)

    def _slopes_near(self, x: Floats, y: Floats) -> tuple[Floats, ...]:
        half = 0.5 * self.aperture_px
        nodes = y[None, :] + half * _NODES[:, None]
        inner = self._inner(x, nodes)
        weights = half * _WEIGHTS
        psf, by_x, by_xx, ends_x = (np.einsum("i,ij->j", weights, part) for part in inner[:4])
        top, bottom = self._inner(x, y + half), self._inner(x, y - half)
        area = self.aperture_px**2
        psf = psf / area
        return (
            psf,
            by_x / area,
            (top[0] - bottom[0]) / area,
            0.5 * by_xx / area,
            (top[1] - bottom[1]) / area,
            0.5 * (top[4] - bottom[4]) / area,
            ends_x / area - psf / self.aperture_px,
            0.5 * (top[0] + bottom[0]) / area - psf / self.aperture_px,
        )

    def _inner(self, x: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Integrals over the aperture in x of the Gaussian at height t.

        Plain; derived by x once and twice; mean of its values at both ends; derived by t.
        """
        lean = self.xy / self.yy
        row, high, low, sigma_x = self._ends(x, t)
        pdf_high, pdf_low = gaussian(high) / sigma_x, gaussian(low) / sigma_x
        plain = row * (ndtr(high) - ndtr(low))
        by_x = row * (pdf_high - pdf_low)
        by_xx = row * (low * pdf_low - high * pdf_high) / sigma_x
        ends = 0.5 * row * (pdf_high + pdf_low)
        return plain, by_x, by_xx, ends, -plain * t / self.yy - lean * by_x

    def _ends(self, x: Floats, t: Floats) -> tuple[Floats, Floats, Floats, float]:
        """The Gaussian's marginal at height t, the aperture's ends in x in units of its width.

        The last number is that width: the standard deviation across, given the height.
        """
        half = 0.5 * self.aperture_px
        sigma_y = math.sqrt(self.yy)
        lean = self.xy / self.yy
        sigma_x = math.sqrt(max(self.xx - lean * self.xy, 1e-12))
        row = gaussian(t / sigma_y) / sigma_y
        middle = x - lean * t
        return row, (middle + half) / sigma_x, (middle - half) / sigma_x, sigma_x

    def otf(self, u: Floats, v: Floats) -> Floats:
        """Transfer function at frequencies in cycles per pixel (real: the PSF is symmetric)."""
        power = self.xx * u * u + 2 * self.xy * u * v + self.yy * v * v
        box = np.sinc(self.aperture_px * u) * np.sinc(self.aperture_px * v)
        return np.asarray(np.exp(-2 * np.pi**2 * power) * box)

    def otf_slopes(self, u: Floats, v: Floats) -> Floats:
        """Transforms of the last five of `PixelSlopes`: by Sigma and by the aperture, (n, 5)."""
        whole = self.otf(u, v)
        power = self.xx * u * u + 2 * self.xy * u * v + self.yy * v * v
        gauss = np.exp(-2 * np.pi**2 * power)
        a = self.aperture_px
        by_a = [
            gauss * (np.cos(np.pi * a * own) - np.sinc(a * own)) / a * np.sinc(a * other)
            for own, other in ((u, v), (v, u))
        ]
        return np.stack(
            [
                -2 * np.pi**2 * u * u * whole,
                -4 * np.pi**2 * u * v * whole,
                -2 * np.pi**2 * v * v * whole,
                *by_a,
            ],
            axis=1,
        )
