"""Power spectra of noise that correlates, from residuals at any pixels of an image.

The covariances of pixels some lags apart are tapered by Parzen's window, and transformed (R. B.
Blackman and J. W. Tukey, The Measurement of Power Spectra, 1959; E. Parzen, Technometrics 3, 1961,
167). Pixels may be missing. Sums over pairs are divided by the number of pixels, not of pairs: the
power is nowhere negative then, and few pixels tell of no power that is much below the largest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.curves.grid import Floats

__all__ = ["NoiseSpectrum", "lag_waves", "padded_shape"]

_REACH: Final = 8
"""Pixels this far apart are taken to be independent: grains of 1.5 px, and kernels of resampling,
are within it."""
_LAG: Final = np.arange(-_REACH, _REACH + 1)
_LEAST: Final = 0.01
"""Of white noise: less is beyond what a few thousand pixels tell of a power."""


def _parzen(distance: Floats) -> Floats:
    """Parzen's window of distances relative to its reach."""
    near = 1 - 6 * distance**2 + 6 * distance**3
    return np.where(distance < 0.5, near, 2 * np.maximum(1 - distance, 0.0) ** 3)


_DOWN, _RIGHT = (lag.ravel() for lag in np.meshgrid(_LAG, _LAG, indexing="ij"))
_TAPER: Final[Floats] = _parzen(np.hypot(_DOWN, _RIGHT) / _REACH)


@dataclass(frozen=True, eq=False)
class NoiseSpectrum:
    """Power spectrum of noise, over that of white noise of the same variance.

    Attributes
    ----------
    covariance : (289,) array
        Tapered covariance of pixels -8 to 8 rows and columns apart, over the variance.
    least : float
        Power that is taken at least, at every frequency.
    """

    covariance: Floats
    least: float = _LEAST

    @classmethod
    def of(cls, residual: Floats, rows: NDArray[np.intp], cols: NDArray[np.intp]) -> NoiseSpectrum:
        """From residuals of some pixels.

        Parameters
        ----------
        residual : (n,) array
            Outliers bounded; where all are 0 the spectrum is that of white noise.
        rows, cols : (n,) int arrays
            Their pixels, from 0.
        """
        shape = padded_shape(rows, cols)
        image = np.zeros(shape)
        image[rows, cols] = residual
        waves = fft.rfft2(image)
        sums = fft.irfft2(waves.real**2 + waves.imag**2, shape)[_DOWN, _RIGHT]
        middle = sums.size // 2
        if not sums[middle] > 0:
            return cls(np.eye(1, sums.size, middle)[0])
        return cls(sums * _TAPER / sums[middle])

    def along(self, waves: Floats) -> Floats:
        """Power at frequencies along a direction whose `lag_waves` (k, n) are given, (k,).

        Pixels are a lattice: beyond their Nyquist frequency the power comes again.
        """
        middle = self.covariance.size // 2
        power = self.covariance[middle] + 2 * waves @ self.covariance[:middle]
        return np.asarray(np.maximum(power, self.least))

    def plane(self, shape: tuple[int, int]) -> Floats:
        """Power at the frequencies of `scipy.fft.rfft2` of an image, (rows, cols // 2 + 1)."""
        impulse = np.zeros(shape)
        impulse[_DOWN, _RIGHT] = self.covariance
        return np.asarray(np.maximum(fft.rfft2(impulse).real, self.least))


def padded_shape(rows: NDArray[np.intp], cols: NDArray[np.intp]) -> tuple[int, int]:
    """Shape of an image of some pixels, with room for the lags, that is transformed fast."""
    height, width = (fft.next_fast_len(int(one.max()) + 1 + _REACH, True) for one in (rows, cols))
    return height, width


def lag_waves(normal: tuple[float, float], freq_cpp: Floats) -> Floats:
    """Cosines over one half of the lags, of frequencies (k,) along a direction (x, y), (k, n).

    Covariances are the same either way.
    """
    along_px = (normal[0] * _RIGHT + normal[1] * _DOWN)[: _RIGHT.size // 2]
    return np.asarray(np.cos(2 * np.pi * freq_cpp[:, None] * along_px))
