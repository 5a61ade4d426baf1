"""Noise of an edge's pixels that correlates: texture of the ground, or what interpolation left.

The mean of such noise along the edge is a random profile, which an edge spread function (ESF) can
follow. Of every frequency along the normal it has the power of the noise there, over the edge's
length: grains of the ground hardly disturb high frequencies, and a sharpened product's noise hardly
low ones. So the noise is white noise of the least power, and a profile beside it, a random process
that is integrated out of the equations (generalised least squares; C. E. Rasmussen and C. K. I.
Williams, Gaussian Processes for Machine Learning, 2006, section 2.7). Texture ends at the border of
its ground as the border is blurred: each side has a process of its own, as large as its share in
the pixels. What varies along the edge, such as a rotation of the line, is disturbed by noise that
no profile has: such unknowns have the noise of their own frequencies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.noise_spectrum import NoiseSpectrum, padded_shape
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.spline import CELL, CELLS, HALF_SUPPORT
from acutance.targets.straight.tuned import BORDER_STRIP, MAX_RESAMPLED_POWER

__all__ = ["ColouredNoise", "RandomProfile", "places"]

_SIZE: Final = CELLS + 3
_PLACES: Final[Floats] = np.asarray(-HALF_SUPPORT + CELL * (np.arange(_SIZE) - 1.0))
"""Where the cubic B-splines of an ESF are centred, in widths."""
_APART: Final = np.abs(np.subtract.outer(np.arange(_SIZE), np.arange(_SIZE)))
_FREQ_CPP: Final[Floats] = np.arange(0.0, 2.2, 0.02)
"""Beyond 1.4 cycles per pixel, where the power of the diagonals comes again."""
_STRIP_PX: Final = 1.0
"""Standard deviation of the strip's profile; wider ones are seen beside the blur."""
_PART_PX: Final = 4.0
"""Length of the parts of a border that are compared."""
_SIGNIFICANT: Final = 3.0
_INDEPENDENT_PX: Final = 8.0
"""Standard deviation of the window of the profile's covariance, which is none beyond 12 px."""


class Scatter(NamedTuple):
    """A power over the expected one, and how many squares it is the mean of."""

    ratio: float
    freedom: int

    @property
    def is_more(self) -> bool:
        """Whether chance does not explain it."""
        return self.ratio > 1 + _SIGNIFICANT * math.sqrt(2 / max(self.freedom, 1))


@dataclass(frozen=True, eq=False)
class ColouredNoise:
    """Spectra of the noise on the dark and on the bright side of an edge.

    Attributes
    ----------
    spectra : pair of NoiseSpectrum
    along : (2, k) array
        Power along the normal, over that of white noise.
    at : pair of (n,) int arrays
        Rows and columns of the pixels, from 0.
    """

    spectra: tuple[NoiseSpectrum, NoiseSpectrum]
    along: Floats
    at: tuple[NDArray[np.intp], NDArray[np.intp]]

    @classmethod
    def of(
        cls,
        standard: Floats,
        at: tuple[NDArray[np.intp], NDArray[np.intp]],
        response: Floats,
        normal: tuple[float, float],
    ) -> ColouredNoise:
        """From residuals about an edge.

        Parameters
        ----------
        standard : (n,) array
            In standard deviations, outliers bounded.
        at : pair of (n,) int arrays
            Rows and columns of the pixels, from 0.
        response : (n,) array
            Of the edge: 0 dark, 1 bright.
        normal : (float, float)
            Unit vector (x, y) across it.
        """
        dark, bright = (
            NoiseSpectrum.of(standard[side], at[0][side], at[1][side])
            for side in (response < 0.5, response >= 0.5)
        )
        along = np.stack([one.along(normal, _FREQ_CPP) for one in (dark, bright)])
        return cls((dark, bright), along, at)

    @property
    def white(self) -> Floats:
        """Variance of the white noise of either side, over that of all, (2,)."""
        return np.asarray(np.minimum(self.along.min(axis=1), 1.0))

    @property
    def _ground(self) -> Floats:
        """Share of the noise of either side that is the ground's, no resampled product's, (2,)."""
        return np.asarray(np.maximum(1 - MAX_RESAMPLED_POWER / self.along.max(axis=1), 0.0))

    def scatter_along(self, standard: Floats, s: Floats, t: Floats, width_px: float) -> Scatter:
        """How parts of the border scatter along it, over what this noise makes them.

        Parts of a few pixels are multiplied by the first three derivatives of a line of the blur's
        width: what a rough border, or processing of strong contrasts, adds to the noise is there.

        Parameters
        ----------
        standard : (n,) array
            Residuals in standard deviations, outliers bounded.
        s, t : (n,) arrays
            Distance of the pixels along the normal and along the line.
        width_px : float
            Full width at half maximum of the blur.
        """
        u = s * (FWHM_OF_SIGMA / width_px)
        line = np.exp(-0.5 * u**2)
        shapes = line * np.stack([u, u**2 - 1, u**3 - 3 * u])
        part = np.floor((t - t.min()) / _PART_PX).astype(int)
        parts = int(part.max()) + 1
        sums = np.stack([np.bincount(part, one * standard, parts) for one in shapes])
        squares = np.stack([np.bincount(part, one**2, parts) for one in shapes])
        # Neighbouring parts of either sign: what all have in common is in the fit.
        expected = self.disturbing(shapes * (1 - 2 * (part % 2)), np.ones(2))
        ratio = np.sum(sums**2 / expected[:, None]) / np.sum(squares)
        return Scatter(float(ratio), shapes.shape[0] * (parts - 1))

    def profile(
        self, sides: Floats, share: Floats, width_px: float, length_px: float
    ) -> RandomProfile:
        """The profile of the noise beside its white part, in coefficients of the ESF's spline.

        Parameters
        ----------
        sides : (2,) array
            Variance of the noise of either side.
        share : (CELLS + 3,) array
            Response of the edge at the `places` of the spline.
        width_px : float
            The unit of the spline.
        length_px : float
            Of the edge.
        """
        apart_px = CELL * width_px * np.arange(_SIZE)
        # The spline passes no wave beyond the Nyquist frequency of its cells.
        cycles = CELL * width_px * _FREQ_CPP
        passed = np.where(cycles < 0.5, np.sinc(cycles) ** 4, np.inf)
        waves = np.cos(2 * np.pi * apart_px[:, None] * _FREQ_CPP)
        power = (self.along - self.white[:, None]) / (length_px * passed**2)
        step_cpp = _FREQ_CPP[1] - _FREQ_CPP[0]
        power[:, 1:] *= 2
        by_lag = step_cpp * (power @ waves.T) * np.exp(-0.5 * (apart_px / _INDEPENDENT_PX) ** 2)
        covariance = np.zeros((_SIZE, _SIZE))
        # What of the noise ends at the border, and what is there besides, of a half each.
        rest = np.sqrt(np.maximum(share * (1 - share), 0.0))
        there = np.outer(rest, rest)
        for own, variance, lags in zip((1 - share, share), sides, by_lag, strict=True):
            covariance += variance * (np.outer(own, own) + there) * lags[_APART]
        # What no pixel shows beside a border: a strip along it within the blur.
        along = np.exp(-0.5 * (apart_px / _STRIP_PX) ** 2)
        strip = BORDER_STRIP**2 * float(np.mean(sides * self._ground))
        covariance += strip * there * along[_APART]
        return RandomProfile(covariance)

    def disturbing(self, columns: Floats, sides: Floats) -> Floats:
        """Variance of white noise that would disturb regressors as much, (q,).

        Parameters
        ----------
        columns : (q, n) array
        sides : (2,) array
            Variance of the noise of either side.
        """
        shape = padded_shape(*self.at)
        image = np.zeros((len(columns), *shape))
        image[:, self.at[0], self.at[1]] = columns
        power = np.abs(fft.rfft2(image)) ** 2
        # The frequencies of the other half are not there.
        power[:, :, 1 : (shape[1] + 1) // 2] *= 2
        noise = 0.5 * sum(
            variance * one.plane(shape) for variance, one in zip(sides, self.spectra, strict=True)
        )
        total = np.maximum(power.sum(axis=(1, 2)), 1e-300)
        return np.asarray(np.tensordot(power, noise, 2) / total)


def places() -> Floats:
    """Where the coefficients of the ESF's spline stand, in widths, (CELLS + 3,)."""
    return _PLACES


@dataclass(frozen=True, eq=False)
class RandomProfile:
    """A random profile across an edge.

    Attributes
    ----------
    covariance : (CELLS + 3, CELLS + 3) array
        Of its coefficients in the spline of the ESF, in units of the noise of unit weight.
    """

    covariance: Floats

    def integrated_out(self, normal: Normal, disturbing: Sequence[float] | Floats) -> Normal:
        """The equations of pixels without what the profile explains.

        Parameters
        ----------
        normal : Normal
            Of the spline's coefficients, and q further unknowns.
        disturbing : (q,) array
            Variance of the noise that disturbs those, where that of unit weight is 1.
        """
        rows = normal.gram[:_SIZE]
        explained = self._gain(normal)
        gram = normal.gram - rows.T @ explained @ rows
        projection = normal.projection - rows.T @ (explained @ normal.projection[:_SIZE])
        # Regressors of a noise of their own weigh less, by themselves and beside others.
        weight = np.concatenate([np.ones(_SIZE), 1 / np.maximum(disturbing, 1.0)])
        gram *= np.minimum(weight[:, None], weight)
        return replace(normal, gram=gram, projection=projection * weight)

    def likeliest(self, normal: Normal, coefficients: Floats) -> Floats:
        """The profile under given coefficients of spline and regressors, (CELLS + 3,)."""
        left = normal.projection[:_SIZE] - normal.gram[:_SIZE] @ coefficients
        return np.asarray(self._gain(normal) @ left)

    def _gain(self, normal: Normal) -> Floats:
        """Covariance of the profile as the pixels leave it, symmetric."""
        seen = np.eye(_SIZE) + normal.gram[:_SIZE, :_SIZE] @ self.covariance
        gain = np.linalg.solve(seen.T, self.covariance).T
        return np.asarray(0.5 * (gain + gain.T))
