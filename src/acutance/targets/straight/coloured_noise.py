"""Noise of a straight target's pixels that correlates: texture, or what interpolation left.

The mean of such noise along the line is a random profile, which an edge spread function (ESF) can
follow. Of every frequency along the normal it has the power of the noise there, over the line's
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
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.cosine_sums import cosine_sums
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.noise_spectrum import NoiseSpectrum, lag_waves, padded_shape
from acutance.targets.straight.tuned import (
    BORDER_STRIP,
    MAX_RESAMPLED_POWER,
    MIN_SPECTRUM_PIXELS,
)

__all__ = ["ColouredNoise"]

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
    """Spectra of the noise on the dark and on the bright side of a straight target.

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
        """From residuals about an edge or a pulse.

        Of a side with too few pixels for a spectrum, which only one may be, the noise is as much at
        every frequency as white noise has there, or as the other side's.

        Parameters
        ----------
        standard : (n,) array
            In standard deviations, outliers bounded.
        at : pair of (n,) int arrays
            Rows and columns of the pixels, from 0.
        response : (n,) array
            Of the target: 0 dark, 1 bright.
        normal : (float, float)
            Unit vector (x, y) across it.
        """
        sides = (response < 0.5, response >= 0.5)
        many = [np.count_nonzero(one) >= MIN_SPECTRUM_PIXELS for one in sides]
        told = [
            NoiseSpectrum.of(standard[side], at[0][side], at[1][side])
            for side, is_told in zip(sides, many, strict=True)
            if is_told
        ]
        bound = replace(told[0], least=1.0)
        dark, bright = told[0] if many[0] else bound, told[-1] if many[1] else bound
        waves = lag_waves(normal, _FREQ_CPP)
        along = np.stack([one.along(waves) for one in (dark, bright)])
        return cls((dark, bright), along, at)

    @property
    def white(self) -> Floats:
        """Variance of the white noise of either side, over that of all, (2,)."""
        return np.asarray(np.minimum(self.along.min(axis=1), 1.0))

    @property
    def _ground(self) -> Floats:
        """Share of the noise of either side that is the ground's, no resampled product's, (2,)."""
        return np.asarray(np.maximum(1 - MAX_RESAMPLED_POWER / self.along.max(axis=1), 0.0))

    def scatter_along(
        self, standard: Floats, distances: Sequence[Floats], t: Floats, width_px: float
    ) -> Scatter:
        """How parts of the borders scatter along them, over what this noise makes them.

        Parts of a few pixels are multiplied by the first three derivatives of a line of the blur's
        width: what a rough border, or processing of strong contrasts, adds to the noise is there.

        Parameters
        ----------
        standard : (n,) array
            Residuals in standard deviations, outliers bounded.
        distances : sequence of (n,) arrays
            Of the pixels along the normal, from every border.
        t : (n,) array
            Along the line.
        width_px : float
            Full width at half maximum of the blur.
        """
        u = np.stack(distances) * (FWHM_OF_SIGMA / width_px)
        line = np.exp(-0.5 * u**2)
        shapes = np.concatenate([line * u, line * (u**2 - 1), line * (u**3 - 3 * u)])
        part = np.floor((t - t.min()) / _PART_PX).astype(int)
        parts = int(part.max()) + 1
        sums = np.stack([np.bincount(part, one * standard, parts) for one in shapes])
        squares = np.stack([np.bincount(part, one**2, parts) for one in shapes])
        # Neighbouring parts of either sign: what all have in common is in the fit.
        expected = self.disturbing(shapes * (1 - 2 * (part % 2)), np.ones(2))
        ratio = np.sum(sums**2 / expected[:, None]) / np.sum(squares)
        return Scatter(float(ratio), shapes.shape[0] * (parts - 1))

    def profile_covariance(
        self, sides: Floats, share: Floats, cell_px: float, length_px: float
    ) -> Floats:
        """Of the profile of the noise beside its white part, in coefficients of a spline.

        Parameters
        ----------
        sides : (2,) array
            Variance of the noise of either side.
        share : (m,) array
            Response of the target (0 dark, 1 bright) where the spline's coefficients stand.
        cell_px : float
            From one to the next.
        length_px : float
            Of the target.

        Returns
        -------
        (m, m) array
        """
        apart_px = cell_px * np.arange(share.size)
        # The spline passes no wave beyond the Nyquist frequency of its cells.
        cycles = cell_px * _FREQ_CPP
        passed = np.where(cycles < 0.5, np.sinc(cycles) ** 4, np.inf)
        power = (self.along - self.white[:, None]) / (length_px * passed**2)
        step_cpp = _FREQ_CPP[1] - _FREQ_CPP[0]
        power[:, 1:] *= 2
        by_lag = (sides * step_cpp)[:, None] * cosine_sums(power, 2 * np.pi * cycles, share.size)
        by_lag *= np.exp(-0.5 * (apart_px / _INDEPENDENT_PX) ** 2)
        # What no pixel shows beside a border: a strip along it within the blur.
        along = np.exp(-0.5 * (apart_px / _STRIP_PX) ** 2)
        strip = BORDER_STRIP**2 * float(np.mean(sides * self._ground))
        return _of_both_sides(share, by_lag, strip * along)

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
        waves = fft.rfft2(image).reshape(len(columns), -1)
        power = waves.real**2 + waves.imag**2
        # The frequencies of the other half are not there.
        there = np.ones((shape[0], shape[1] // 2 + 1))
        there[:, 1 : (shape[1] + 1) // 2] = 2.0
        counted = there.ravel()
        noise = counted * (0.5 * sides @ self._planes)
        return np.asarray(power @ noise / np.maximum(power @ counted, 1e-300))

    @cached_property
    def _planes(self) -> Floats:
        """Power on either side at the frequencies of the pixels' image, (2, n)."""
        shape = padded_shape(*self.at)
        return np.stack([one.plane(shape).ravel() for one in self.spectra])


@compiled
def _of_both_sides(share: Floats, by_lag: Floats, strip: Floats) -> Floats:
    """Covariance of coefficients from those of both sides' noise by their distance, (2, m).

    What of the noise ends at the border, and what is there besides, of a half each; a strip (m,)
    is there alone.
    """
    dark, rest = 1 - share, np.sqrt(np.maximum(share * (1 - share), 0.0))
    found = np.empty((share.size, share.size))
    for i in range(share.size):
        for j in range(i + 1):
            first, last, there = by_lag[0, i - j], by_lag[1, i - j], rest[i] * rest[j]
            found[i, j] = (
                (dark[i] * dark[j] + there) * first
                + (share[i] * share[j] + there) * last
                + there * strip[i - j]
            )
            found[j, i] = found[i, j]
    return found
