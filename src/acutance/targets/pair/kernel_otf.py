"""The OTF of a fitted kernel, with its covariance, times the reference's own OTF."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.tile import Complexes

__all__ = ["KernelOtf", "ReferenceOtf"]

_LEAST_REGIONS = 6
_OWN_SHARE = 0.5
_FREQ_CPP: Floats = np.asarray(np.arange(1, 20) / 20)
_MOST_INFLATION = 20.0


class ReferenceOtf(Protocol):
    """The reference's own OTF, at frequencies in cycles per pixel of the LOW image."""

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), 1 at zero frequency."""
        ...

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k), 0 at zero frequency."""
        ...


@dataclass(frozen=True, eq=False)
class KernelOtf:
    """An OTF over the plane: the kernel's, times the reference's if that is known.

    Beyond the reference's Nyquist frequency nothing is known, and the OTF is 0 there.

    Parameters
    ----------
    fit : KernelFit
    band_across_cpp, band_along_cpp : float
        The reference's Nyquist frequencies, in cycles per low pixel.
    reference : ReferenceOtf, optional
    """

    fit: KernelFit
    band_across_cpp: float
    band_along_cpp: float
    reference: ReferenceOtf | None = None

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is known in any direction."""
        return math.hypot(self.band_across_cpp, self.band_along_cpp)

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), about the centre of the parametric kernel."""
        quotient = self._quotient(u_cpp, v_cpp)[0]
        if self.reference is None:
            return quotient
        return np.asarray(quotient * self.reference.otf(u_cpp, v_cpp))

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        quotient, moves = self._quotient(u_cpp, v_cpp)
        fit = self.fit
        posterior = self._inflation(quotient, moves)[:, None] * (moves @ fit.posterior.factor)
        factor = np.column_stack([posterior, moves @ fit.noise_factor])
        if self.reference is None:
            return factor
        own = quotient[:, None] * self.reference.factor(u_cpp, v_cpp)
        return np.column_stack([factor * self.reference.otf(u_cpp, v_cpp)[:, None], own])

    @cached_property
    def inflation(self) -> float:
        """Mean ratio of the scatter between regions to the stated covariance (deviations)."""
        return math.sqrt(self._mean_excess)

    def _quotient(self, u_cpp: Floats, v_cpp: Floats) -> tuple[Complexes, Complexes]:
        """OTF of the kernel, and its derivatives by the coefficients, (n, k)."""
        basis, beta = self.fit.basis, self.fit.beta
        transfer = basis.transfer(u_cpp, v_cpp)
        total = self._at_zero @ beta
        turn = np.exp(2j * math.pi * (u_cpp * basis.across.shift_px + v_cpp * basis.down.shift_px))
        known = np.abs(u_cpp) <= self.band_across_cpp + 1e-9
        known &= np.abs(v_cpp) <= self.band_along_cpp + 1e-9
        turn = np.where(known, turn, 0.0)
        quotient = transfer @ beta / total
        moves = (transfer - quotient[:, None] * self._at_zero) / total
        return quotient * turn, moves * turn[:, None]

    @cached_property
    def _at_zero(self) -> Floats:
        nothing = np.zeros(1)
        return np.asarray(self.fit.basis.transfer(nothing, nothing)[0].real)

    def _inflation(self, quotient: Complexes, moves: Complexes) -> Floats:
        """Factor on the standard deviations, (n,), at least 1.

        The scatter of the regions is known to a few degrees of freedom at a single frequency, so
        half of it is taken from its mean over the band.
        """
        if self.fit.scores.shape[1] < _LEAST_REGIONS:
            return np.ones(quotient.size)
        local = self._excess(quotient, moves)
        mean = self._mean_excess
        excess = _OWN_SHARE * local + (1 - _OWN_SHARE) * mean
        return np.sqrt(np.clip(excess, 1.0, _MOST_INFLATION**2))

    @cached_property
    def _mean_excess(self) -> float:
        if self.fit.scores.shape[1] < _LEAST_REGIONS:
            return 1.0
        freq = _FREQ_CPP * min(self.band_across_cpp, self.band_along_cpp, 1.0)
        nothing = np.zeros(freq.size)
        u, v = np.concatenate([freq, nothing]), np.concatenate([nothing, freq])
        return float(np.mean(self._excess(*self._quotient(u, v))))

    def _excess(self, quotient: Complexes, moves: Complexes) -> Floats:
        """Variance by the scatter of regions over that of white residuals, (n,)."""
        scores = self.fit.scores
        regions = scores.shape[1]
        scatter = scores - scores.mean(axis=1, keepdims=True)
        modulus = np.abs(quotient)
        direction = np.where(modulus > 0, np.conj(quotient), 1.0) / np.where(
            modulus > 0, modulus, 1.0
        )
        found = np.abs(direction[:, None] * (moves @ scatter)) ** 2
        white = np.abs(moves @ self.fit.white_factor) ** 2
        expected = white.sum(axis=1)
        seen = found.sum(axis=1) * regions / (regions - 1)
        return np.where(expected > 0, seen / np.where(expected > 0, expected, 1.0), 1.0)
