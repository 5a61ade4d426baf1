"""The transfer curve: complex OTF along one direction, its modulus the MTF."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats, one_place, sample
from acutance.curves.one_line import OneLine

__all__ = ["Mtf"]

Complexes = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Mtf(OneLine):
    """OTF along one direction, normalised to 1 at zero frequency, with its covariance.

    Parameters
    ----------
    freq_cpp : (n,) array
        Regular grid of frequencies in cycles per pixel, from 0 to 1 at least.
    otf : (n,) complex array
        Phase relative to the centroid of the LSF, so that an asymmetric system shows.
    factor : (n, k) complex array
        Factor of the covariance: the error of `otf` is ``factor @ z``, z standard normal.
    latent : (k, m) array, optional
        A second factor shared by all curves of a measurement: the error is ``factor @ latent @ z``.
    """

    freq_cpp: Floats
    otf: Complexes
    factor: Complexes
    latent: Floats | None = None

    def __post_init__(self) -> None:
        n = self.freq_cpp.shape
        if self.otf.shape != n or self.factor.ndim != 2 or self.factor.shape[:1] != n:
            raise ValueError(
                f"an MTF needs (n,) frequencies, (n,) OTF and an (n, k) factor, found shapes "
                f"{n}, {self.otf.shape} and {self.factor.shape}"
            )

    @cached_property
    def _along_and_quadrature(self) -> tuple[Floats, Floats]:
        """Covariance factors, (n, m), of the OTF's part in phase with itself and of the rest."""
        modulus = np.abs(self.otf)
        known = modulus > 0
        turn = np.conj(np.where(known, self.otf, 1.0)) / np.where(known, modulus, 1.0)
        along, quadrature = _parts(turn[:, None] * self.factor, self.latent)
        return along, quadrature

    @property
    def covariance_factor(self) -> Floats:
        """Factor of the covariance of the MTF itself, (n, m)."""
        return self._along_and_quadrature[0]

    @property
    def otf_factor(self) -> Complexes:
        """All of the covariance's factor of the OTF itself, (n, m)."""
        if self.latent is None:
            return self.factor
        return np.asarray(self.factor.real @ self.latent + 1j * (self.factor.imag @ self.latent))

    @cached_property
    def value(self) -> Floats:
        """The MTF, (n,): modulus of the OTF, less what noise in quadrature adds to a modulus.

        Noise perpendicular to the OTF lengthens it (Rice), by var / (2 M) to first order. Where
        it is longer than the OTF itself, nothing is left: the MTF is clipped at 0.
        """
        quadrature = self._along_and_quadrature[1]
        power = np.abs(self.otf) ** 2 - np.einsum("ij,ij->i", quadrature, quadrature)
        return np.asarray(np.sqrt(np.maximum(power, 0.0)))

    @cached_property
    def std(self) -> Floats:
        """Standard deviation of the MTF at every frequency, (n,).

        It is that of the OTF's component along itself, also where the MTF is clipped at 0: there
        it says how large an MTF may hide, and not how a modulus scatters.
        """
        along = self.covariance_factor
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", along, along)))

    def gradient(self, freq_cpp: float) -> Floats:
        """The row of `covariance_factor` at any frequency, (m,)."""
        return self._at(freq_cpp)[1]

    def __call__(self, freq_cpp: float) -> Estimate:
        """The MTF at one frequency (cycles per pixel), by cubic interpolation of the OTF.

        At many, take `value` and `std` on `freq_cpp`.

        Raises
        ------
        OptionError
            If it is not one number, or lies outside the curve.
        """
        value, gradient = self._at(one_place(freq_cpp, "freq_cpp"))
        return Estimate(value, math.sqrt(float(gradient @ gradient)))

    def _at(self, freq_cpp: float) -> tuple[float, Floats]:
        otf = complex(sample(self.freq_cpp, self.otf, freq_cpp))
        modulus = abs(otf)
        turn = otf.conjugate() / modulus if modulus > 0 else 1.0
        row = sample(self.freq_cpp, self.factor, freq_cpp)
        along, quadrature = _parts(turn * row, self.latent)
        return math.sqrt(max(modulus**2 - float(quadrature @ quadrature), 0.0)), along

    @cached_property
    def phase_rad(self) -> Floats:
        """Phase of the OTF in radians, relative to the centroid of the LSF, (n,)."""
        return np.asarray(np.angle(self.otf))

    def in_words(self) -> str:
        """Where it runs."""
        first, last = self.freq_cpp[[0, -1]]
        return f"freq_cpp {first:g} to {last:g}, {self.freq_cpp.size} places"

    def to_dict(self) -> dict[str, list[float]]:
        """Frequencies, values, standard deviations and phase as lists."""
        return {
            "freq_cpp": np.round(self.freq_cpp, 6).tolist(),
            "value": self.value.tolist(),
            "std": self.std.tolist(),
            "phase_rad": self.phase_rad.tolist(),
        }


def _parts(turned: Complexes, latent: Floats | None) -> Floats:
    """Covariance factors of a complex error's real and imaginary part, (2, ..., m)."""
    parts = np.stack([turned.real, turned.imag])
    return parts if latent is None else parts @ latent
