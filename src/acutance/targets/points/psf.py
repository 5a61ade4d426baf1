"""The fitted point spread function: a Gaussian through a pixel, corrected, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.numerics.stacked import stacked
from acutance.targets.points.psf_prior import PsfDirections

__all__ = ["PsfModel"]

Complexes = NDArray[np.complex128]
_CONDENSED = 40
_FREQ_CPP: Floats = np.append([0.01, 0.02, 0.03], np.linspace(0.05, 1.0, 20))
_ANGLES_RAD: Floats = np.radians(np.arange(0.0, 180.0, 15.0))


@dataclass(frozen=True, eq=False)
class PsfModel(ShortRepr):
    """A PSF that fills the plane, and its transfer function: an `acutance.curves.OtfModel`.

    Parameters
    ----------
    directions : PsfDirections
        What the PSF is made of.
    weights : (m,) array
        How much of every direction, for a mean blur of unit flux.
    latent : (m, k) array
        Factor of the covariance of `weights`.
    """

    directions: PsfDirections
    weights: Floats
    latent: NDArray[np.floating[Any]]

    def packed(self) -> PsfModel:
        """The same PSF with the most important directions of its covariance, at half precision.

        They are the principal axes of the OTF's errors up to 1 cycle per pixel, in units of their
        deviation at every frequency: small deviations keep as many digits as large ones.
        """
        freq, angle = np.meshgrid(_FREQ_CPP, _ANGLES_RAD)
        factor = self.factor((freq * np.cos(angle)).ravel(), (freq * np.sin(angle)).ravel())
        std = np.sqrt(np.sum(np.abs(factor) ** 2, axis=1, keepdims=True))
        relative = factor / np.maximum(std, np.finfo(float).tiny)
        axes = np.linalg.svd(stacked(relative), full_matrices=False)[2]
        latent = np.asarray(self.latent @ axes[:_CONDENSED].T)
        return replace(self, latent=latent.astype(np.float16))

    @cached_property
    def _latent(self) -> Floats:
        return np.asarray(self.latent, float)

    @property
    def blur(self) -> GaussianPixel2d:
        """The Gaussian through a pixel that is corrected."""
        return self.directions.blur

    @cached_property
    def _volumes(self) -> Floats:
        """Light in every direction, (m,)."""
        nought = np.zeros(1)
        return np.ascontiguousarray(self.directions.transform(nought, nought)[0].real)

    @cached_property
    def volume(self) -> float:
        """Light of the PSF for a mean blur of unit flux: the fit's fluxes have to be times it."""
        return float(1.0 + self._volumes @ self.weights)

    @cached_property
    def volume_gradient(self) -> Floats:
        """Factor of the covariance of `volume`, (k,)."""
        return np.asarray(self._volumes @ self._latent)

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return float(np.clip(0.8 / self.blur.min_sigma_px, 3.0, 6.0))

    def psf(self, x: Floats, y: Floats) -> Floats:
        """Light per square pixel at places (x, y) from the source, pixel area included, (n,)."""
        return self.directions.sum(x, y, self.weights) / self.volume

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF about the fit's origin, exactly 1 at zero frequency, (n,)."""
        otf = self.directions.transform_sum(u_cpp, v_cpp, self.weights) / self.volume
        otf[(u_cpp == 0) & (v_cpp == 0)] = 1.0
        return np.asarray(otf)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of the OTF's covariance, exactly 0 at zero frequency, (n, k)."""
        design = self.directions.transform(u_cpp, v_cpp)
        otf = self.blur.otf(u_cpp, v_cpp) + design.real @ self.weights
        otf = (otf + 1j * (design.imag @ self.weights)) / self.volume
        # What adds light lowers the curve.
        design -= otf[:, None] * self._volumes
        design /= self.volume
        nought = (u_cpp == 0) & (v_cpp == 0)
        design[nought] = 0.0
        return np.asarray(design.real @ self._latent + 1j * (design.imag @ self._latent))
