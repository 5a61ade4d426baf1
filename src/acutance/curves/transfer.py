"""The transfer curve: complex OTF along one direction, its modulus the MTF."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, overload

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_numbers
from acutance.curves.estimate import Estimate
from acutance.curves.estimates import Estimates, estimates_of
from acutance.curves.grid import Floats, Places, as_places, listed, require_curve, sample
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError

__all__ = ["Mtf", "mtf_and_std", "phasor"]

Complexes = NDArray[np.complex128]

_SMALLEST = float(np.finfo(float).tiny)
_SAME_CPP = 1e-6
"""Frequencies that differ by no more are one place of a grid."""


@dataclass(frozen=True, eq=False)
class Mtf(ShortRepr):
    """OTF along one direction, normalised to 1 at zero frequency, with its covariance.

    Parameters
    ----------
    freq_cpp : (n,) array
        Regular grid of frequencies in cycles per pixel, from 0 to 1 at least.
    otf : (n,) complex array
        Phase relative to the centroid of the line spread function (LSF), so that an asymmetric
        system shows: the Fourier transform of the LSF with the kernel ``exp(-2 pi i f s)``. A trail
        towards the bright side has a positive phase at low frequencies.
    factor : (n, k) complex array
        Factor of the covariance: the error of `otf` is ``factor @ z``, z standard normal.
    latent : (k, m) array, optional
        A second factor shared by all curves of a measurement: the error is ``factor @ latent @ z``.

    Raises
    ------
    OptionError
        If they are no arrays of such shapes, or frequencies are no regular grid.
    """

    freq_cpp: Floats
    otf: Complexes
    factor: Complexes
    latent: Floats | None = None

    def __post_init__(self) -> None:
        require_curve("freq_cpp", self.freq_cpp, self.otf, self.factor, self.latent, kind="an MTF")

    @cached_property
    def _modulus(self) -> tuple[Floats, Floats]:
        """The MTF, (n,), and the factor of its covariance, (n, m)."""
        return _modulus(self.otf, self._turned, self.latent)

    @cached_property
    def _turned(self) -> Complexes:
        """`factor` relative to the direction of the OTF, (n, k)."""
        return _turned(self.otf, self.factor)

    @property
    def rows(self) -> Floats:
        """What the columns of `factor` add to the MTF itself, (n, k)."""
        return self._turned.real

    @property
    def covariance_factor(self) -> Floats:
        """Factor of the covariance of the MTF itself, (n, m)."""
        return self._modulus[1]

    @property
    def otf_factor(self) -> Complexes:
        """All of the covariance's factor of the OTF itself, (n, m)."""
        if self.latent is None:
            return self.factor
        found = np.empty((self.factor.shape[0], self.latent.shape[1]), complex)
        found.real, found.imag = self.factor.real @ self.latent, self.factor.imag @ self.latent
        return found

    def near(self, freq_cpp: Floats) -> Self:
        """The curve at the places of its grid that frequencies (n,) have.

        Raises
        ------
        OptionError
            If one of them is no place of the grid: there the curve has to be called.
        """
        asked = np.atleast_1d(as_places(freq_cpp, "freq_cpp"))
        own = np.minimum(self.freq_cpp.searchsorted(asked - _SAME_CPP), self.freq_cpp.size - 1)
        is_other = ~(np.abs(self.freq_cpp[own] - asked) <= _SAME_CPP)
        if is_other.any():
            raise OptionError(
                f"{asked[is_other][0]:g} is no place of the curve's grid, freq_cpp "
                f"{self.freq_cpp[0]:g} to {self.freq_cpp[-1]:g}: call the curve at it"
            )
        return replace(
            self, freq_cpp=self.freq_cpp[own], otf=self.otf[own], factor=self.factor[own]
        )

    @property
    def value(self) -> Floats:
        """The MTF, (n,): modulus of the OTF minus the bias of a modulus by noise in quadrature.

        Noise perpendicular to the optical transfer function (OTF) lengthens it (Rice), by var / (2
        M) to first order. Where it is longer than the OTF itself, nothing is left: the MTF is
        clipped at 0.
        """
        return self._modulus[0]

    @cached_property
    def std(self) -> Floats:
        """Standard deviation of the MTF at every frequency, (n,).

        It is that of the OTF's component along itself, also where the MTF is clipped at 0: there
        it is the size of an MTF that noise may hide, and not the scatter of a modulus.
        """
        along = self.covariance_factor
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", along, along)))

    def value_and_row(self, freq_cpp: float) -> tuple[float, Floats]:
        """The MTF at one frequency, and what the columns of `factor` add to it, (k,)."""
        require_numbers(freq_cpp=freq_cpp)
        otf, turned = self._read(freq_cpp)
        return float(_modulus(otf, turned, self.latent)[0]), turned.real

    def row(self, freq_cpp: float) -> Floats:
        """What the columns of `factor` add to the MTF at one frequency, (k,)."""
        return self._read(as_places(freq_cpp, "freq_cpp"))[1].real

    def gradient(self, freq_cpp: float | Floats) -> Floats:
        """The row of `covariance_factor` at any frequency, (m,); at an array of them (..., m)."""
        return _modulus(*self._read(as_places(freq_cpp, "freq_cpp")), self.latent)[1]

    @overload
    def __call__(self, freq_cpp: float) -> Estimate: ...
    @overload
    def __call__(self, freq_cpp: Places) -> Estimates: ...
    def __call__(self, freq_cpp: Any) -> Estimate | Estimates:
        """The MTF at any frequencies, by cubic interpolation of the OTF.

        Parameters
        ----------
        freq_cpp : float or array_like
            Frequencies in cycles per pixel.

        Returns
        -------
        Estimate or Estimates
            Of a number an `Estimate`, of an array as many in its shape.

        Raises
        ------
        OptionError
            If it holds anything but numbers, or one lies outside the curve.
        """
        value, along = _modulus(*self._read(as_places(freq_cpp, "freq_cpp")), self.latent)
        std = np.sqrt(np.einsum("...j,...j->...", along, along))
        return estimates_of(value, std, lowest=0.0)

    def _read(self, freq_cpp: float | Floats) -> tuple[Complexes, Complexes]:
        """The OTF at any frequencies, (...), and its factor relative to it, (..., k)."""
        otf = np.asarray(sample(self.freq_cpp, self.otf, freq_cpp))
        return otf, _turned(otf, sample(self.freq_cpp, self.factor, freq_cpp))

    @cached_property
    def phase_rad(self) -> Floats:
        """Phase of the OTF in radians, relative to the centroid of the LSF, (n,)."""
        return np.asarray(np.angle(self.otf))

    def summary(self) -> str:
        """Where it runs."""
        first, last = self.freq_cpp[[0, -1]]
        return f"freq_cpp {first:g} to {last:g}, {self.freq_cpp.size} places"

    def arrays(self) -> dict[str, Floats]:
        """Frequencies, values, standard deviations and phase by name, (n,) each."""
        return {
            "freq_cpp": self.freq_cpp,
            "value": self.value,
            "std": self.std,
            "phase_rad": self.phase_rad,
        }

    def to_dict(self) -> dict[str, list[float]]:
        """Frequencies, values, standard deviations and phase as lists."""
        return listed(self.arrays())


def _turned(otf: Complexes, factor: Complexes) -> Complexes:
    """The factor (..., k) of an OTF (...), divided by the phasor of the OTF.

    Its real parts are errors along the OTF, which lengthen it; the imaginary ones turn it.
    """
    return np.asarray(np.conj(phasor(otf))[..., None] * factor)


def _modulus(otf: Complexes, turned: Complexes, latent: Floats | None) -> tuple[Floats, Floats]:
    """MTF (...) and factor of its covariance (..., m), of an OTF (...) and its turned factor.

    The error of a modulus is that of the OTF's part in phase with itself.
    """
    parts = np.array([turned.real, turned.imag])
    along, quadrature = parts if latent is None else parts @ latent
    modulus = np.abs(otf)
    power = modulus**2 - np.einsum("...j,...j->...", quadrature, quadrature)
    return np.asarray(np.sqrt(np.maximum(power, 0.0))), along


def mtf_and_std(otf: Complexes, factor: Complexes) -> tuple[Floats, Floats]:
    """MTF and its standard deviation at places that are no curve, (n,) each.

    Parameters
    ----------
    otf : (n,) complex array
    factor : (n, k) complex array
        Factor of its covariance.
    """
    value, along = _modulus(otf, _turned(otf, factor), None)
    return value, np.asarray(np.sqrt(np.einsum("ij,ij->i", along, along)))


def phasor(otf: Complexes) -> Complexes:
    """Direction of an OTF in the complex plane, (...); 1 where the OTF is 0."""
    modulus = np.abs(otf)
    # Below the smallest normal number a modulus has lost its digits: to divide by it overflows.
    unit = np.ones(otf.shape, complex)
    return np.divide(otf, modulus, out=unit, where=modulus >= _SMALLEST)
