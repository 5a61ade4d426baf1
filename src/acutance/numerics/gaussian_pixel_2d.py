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

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.normal_distribution import normal_distribution

__all__ = ["MIN_SIGMA_PX", "WIDE_WIDTHS", "GaussianPixel2d", "PixelSlopes"]

_REACH = 7.0
"""Distance from the aperture's edge, in standard deviations, beyond which the PSF is 0."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
WIDE_WIDTHS: Final = 2.0
"""Width of the wings over that of the core."""
MIN_SIGMA_PX: Final = 0.36
"""Through a pixel's area, a narrower Gaussian looks like a point."""
_Shape = tuple[float, float, float, float, float, float]
"""Standard deviations across, given the height, and along; how far the middle moves across for
every pixel along; the aperture; and the reach across and along."""


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
        return _psf(*self._of(x, y))

    def slopes(self, x: Floats, y: Floats) -> PixelSlopes:
        """The PSF and all of its derivatives at places (x, y), (n,).

        Along y the Gaussian is integrated over the aperture by quadrature, along x in closed
        form, given y. The Gaussian solves the heat equation, so that its derivative by Sigma is
        half of a second derivative by place: a difference of integrands at the aperture's ends.
        """
        return PixelSlopes(*_slopes(*self._of(x, y)))

    def _of(self, x: Floats, y: Floats) -> tuple[Floats, Floats, _Shape]:
        """The places and this blur, for the loops."""
        lean = self.xy / self.yy
        sigma_x = math.sqrt(max(self.xx - lean * self.xy, 1e-12))
        reach_x, reach_y = (
            0.5 * self.aperture_px + _REACH * math.sqrt(one) for one in (self.xx, self.yy)
        )
        sigma_y, aperture = math.sqrt(self.yy), float(self.aperture_px)
        shape = (sigma_x, sigma_y, float(lean), aperture, reach_x, reach_y)
        return np.ascontiguousarray(x), np.ascontiguousarray(y), shape

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


@inlined
def _inner(x: float, t: float, shape: _Shape) -> tuple[float, float, float, float, float]:
    """Integrals over the aperture in x of the Gaussian at height t.

    Plain; derived by x once and twice; mean of its values at both ends; derived by t.
    """
    sigma_x, sigma_y, lean, aperture = shape[0], shape[1], shape[2], shape[3]
    row = normal_distribution(t / sigma_y)[1] / sigma_y
    middle = x - lean * t
    high, low = (middle + 0.5 * aperture) / sigma_x, (middle - 0.5 * aperture) / sigma_x
    below_high, at_high = normal_distribution(high)
    below_low, at_low = normal_distribution(low)
    plain = row * (below_high - below_low)
    by_x = row * (at_high - at_low) / sigma_x
    by_xx = row * (low * at_low - high * at_high) / sigma_x**2
    ends = 0.5 * row * (at_high + at_low) / sigma_x
    return plain, by_x, by_xx, ends, -plain * t / sigma_y**2 - lean * by_x


@compiled
def _psf(x: Floats, y: Floats, shape: _Shape) -> Floats:
    """`GaussianPixel2d.psf`."""
    found = np.zeros(x.size)
    aperture = shape[3]
    for i in range(x.size):
        if abs(x[i]) < shape[4] and abs(y[i]) < shape[5]:
            light = 0.0
            for k in range(_NODES.size):
                light += _WEIGHTS[k] * _inner(x[i], y[i] + 0.5 * aperture * _NODES[k], shape)[0]
            found[i] = 0.5 * light / aperture
    return found


@compiled
def _slopes(x: Floats, y: Floats, shape: _Shape) -> Floats:
    """`GaussianPixel2d.slopes`, (8, n)."""
    found = np.zeros((8, x.size))
    aperture = shape[3]
    half, area = 0.5 * aperture, aperture**2
    for i in range(x.size):
        if abs(x[i]) < shape[4] and abs(y[i]) < shape[5]:
            psf, by_x, by_xx, ends = 0.0, 0.0, 0.0, 0.0
            for k in range(_NODES.size):
                one = _inner(x[i], y[i] + half * _NODES[k], shape)
                weight = half * _WEIGHTS[k]
                psf += weight * one[0]
                by_x += weight * one[1]
                by_xx += weight * one[2]
                ends += weight * one[3]
            top, bottom = _inner(x[i], y[i] + half, shape), _inner(x[i], y[i] - half, shape)
            psf /= area
            found[0, i], found[1, i] = psf, by_x / area
            found[2, i] = (top[0] - bottom[0]) / area
            found[3, i] = 0.5 * by_xx / area
            found[4, i] = (top[1] - bottom[1]) / area
            found[5, i] = 0.5 * (top[4] - bottom[4]) / area
            found[6, i] = ends / area - psf / aperture
            found[7, i] = 0.5 * (top[0] + bottom[0]) / area - psf / aperture
    return found
