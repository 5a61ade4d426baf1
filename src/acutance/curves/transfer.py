"""The transfer curve: complex OTF along one direction, its modulus the MTF."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats, sample

__all__ = ["Mtf"]

Complexes = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Mtf:
    """OTF along one direction, normalised to 1 at zero frequency, with its covariance.

    Parameters
    ----------
    freq_cpp : (n,) array
        Regular grid of frequencies in cycles per pixel, from 0 to 1 at least.
    otf : (n,) complex array
        Phase relative to the centroid of the LSF, so that an asymmetric system shows.
    factor : (n, k) complex array
        Factor of the covariance: the error of `otf` is ``factor @ z``, z standard normal.
    """

    freq_cpp: Floats
    otf: Complexes
    factor: Complexes

    def __post_init__(self) -> None:
        n = self.freq_cpp.shape
        if self.otf.shape != n or self.factor.ndim != 2 or self.factor.shape[:1] != n:
            raise ValueError(
                f"an MTF needs (n,) frequencies, (n,) OTF and an (n, k) factor, found shapes "
                f"{n}, {self.otf.shape} and {self.factor.shape}"
            )

    @cached_property
    def _direction(self) -> Complexes:
        modulus = np.abs(self.otf)
        return np.where(modulus > 0, self.otf / np.where(modulus > 0, modulus, 1.0), 1.0 + 0j)

    @cached_property
    def gradient(self) -> Floats:
        """Factor of the covariance of the MTF itself, (n, k): the part in phase with the OTF."""
        inphase = np.conj(self._direction)[:, None] * self.factor
        return np.ascontiguousarray(inphase.real)

    @cached_property
    def value(self) -> Floats:
        """The MTF, (n,): modulus of the OTF, less what noise in quadrature adds to a modulus.

        Noise perpendicular to the OTF lengthens it (Rice), by var / (2 M) to first order.
        """
        quadrature = (np.conj(self._direction)[:, None] * self.factor).imag
        excess = np.einsum("ij,ij->i", quadrature, quadrature)
        return np.sqrt(np.maximum(np.abs(self.otf) ** 2 - excess, 0.0))

    @cached_property
    def std(self) -> Floats:
        """Standard deviation of the MTF at every frequency, (n,)."""
        return np.sqrt(np.einsum("ij,ij->i", self.gradient, self.gradient))

    @cached_property
    def phase_rad(self) -> Floats:
        """Phase of the OTF in radians, relative to the centroid of the LSF, (n,)."""
        return np.angle(self.otf)

    def __call__(self, freq_cpp: float) -> Estimate:
        """The MTF at one frequency (cycles per pixel), by cubic interpolation."""
        gradient = sample(self.freq_cpp, self.gradient, freq_cpp)
        value = float(sample(self.freq_cpp, self.value, freq_cpp))
        return Estimate(value, float(np.sqrt(gradient @ gradient)))

    def to_dict(self) -> dict[str, list[float]]:
        """Frequencies, values, standard deviations and phase as lists."""
        return {
            "freq_cpp": np.round(self.freq_cpp, 6).tolist(),
            "value": self.value.tolist(),
            "std": self.std.tolist(),
            "phase_rad": self.phase_rad.tolist(),
        }
