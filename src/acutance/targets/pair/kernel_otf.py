"""The OTF of a fitted kernel, with its covariance, times the reference's own OTF."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.shape_error import ShapeError
from acutance.targets.pair import tuned
from acutance.targets.pair.kernel_basis import KernelBasis
from acutance.targets.pair.kernel_covariance import KernelCovariance
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.reference_otf import ReferenceOtf
from acutance.targets.pair.tile import Complexes

__all__ = ["KernelOtf"]

_FREQ_CPP: Floats = np.asarray(np.arange(1, 20) / 20)
_PLANE_NODES = 33
_HIGHEST_CPP = 1.5


@dataclass(frozen=True, eq=False)
class KernelOtf(ShortRepr):
    """An OTF over the plane: the kernel's, times the reference's if that is known.

    Beyond the reference's Nyquist frequency nothing is known, and the OTF is 0 there.

    Parameters
    ----------
    basis : KernelBasis
    beta : (k,) array
        Coefficients of the basis.
    covariance : KernelCovariance
        Theirs.
    band_across_cpp, band_along_cpp : float
        The reference's Nyquist frequencies along the rows and down the columns of pixels, in cycles
        per low pixel.
    reference : ReferenceOtf, optional
    term : str, optional
        The one cause whose covariance counts; all unless given.
    """

    basis: KernelBasis
    beta: Floats
    covariance: KernelCovariance
    band_across_cpp: float
    band_along_cpp: float
    reference: ReferenceOtf | None = None
    term: str | None = None

    @classmethod
    def of_fit(
        cls, fit: KernelFit, band_cpp: tuple[float, float], reference: ReferenceOtf | None
    ) -> KernelOtf:
        """The OTF of a fit within the reference's band (u, v)."""
        return cls(fit.basis, fit.beta, fit.covariance, *band_cpp, reference)

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
        """Factor of its covariance, (n, m)."""
        parts = self._factors(u_cpp, v_cpp)
        return np.hstack([part for name, part in parts.items() if self.term in (None, name)])

    def _factors(self, u_cpp: Floats, v_cpp: Floats) -> dict[str, Complexes]:
        """Factor of the covariance by every cause: the rows of the uncertainty budget."""
        quotient, slopes = self._quotient(u_cpp, v_cpp)
        found = {
            "fit": self._inflation(slopes)[:, None] * (slopes @ self.covariance.posterior),
            "reference_noise": slopes @ self.covariance.reference_noise,
            "light_from_beyond": slopes @ self.covariance.beyond,
            "kernel_shape": self._of_shape(quotient, np.hypot(u_cpp, v_cpp)),
        }
        if self.reference is None:
            return found
        own = self.reference.otf(u_cpp, v_cpp)[:, None]
        times = {name: np.asarray(factor * own) for name, factor in found.items()}
        factor = quotient[:, None] * self.reference.factor(u_cpp, v_cpp)
        return {**times, "reference_mtf": np.asarray(factor)}

    @property
    def terms(self) -> tuple[str, ...]:
        """The causes whose covariances add up to that of the OTF."""
        return tuple(self._factors(np.zeros(1), np.zeros(1)))

    def by(self, term: str) -> KernelOtf:
        """The same OTF with the covariance of one cause alone."""
        return replace(self, term=term)

    @cached_property
    def inflation(self) -> float:
        """Mean ratio of the scatter between regions to the stated covariance (deviations)."""
        return math.sqrt(self._mean_excess)

    def packed(self) -> KernelOtf:
        """The same OTF with its covariance kept in few bytes: see `KernelCovariance.packed`."""
        nodes = np.linspace(-1.0, 1.0, _PLANE_NODES)
        u, v = np.meshgrid(
            nodes[nodes >= 0] * min(self.band_across_cpp, 1.0),
            nodes * min(self.band_along_cpp, 1.0),
        )
        slopes = self._quotient(u.ravel(), v.ravel())[1]
        return replace(self, covariance=self.covariance.packed(slopes))

    def _quotient(self, u_cpp: Floats, v_cpp: Floats) -> tuple[Complexes, Complexes]:
        """OTF of the kernel, and its derivatives by the coefficients, (n, k)."""
        transfer = self.basis.transfer(u_cpp, v_cpp)
        total = self._at_zero @ self.beta
        known = np.abs(u_cpp) <= self.band_across_cpp + 1e-9
        known &= np.abs(v_cpp) <= self.band_along_cpp + 1e-9
        centring = np.where(known, self.basis.centring(u_cpp, v_cpp), 0.0)
        quotient = transfer @ self.beta / total
        slopes = (transfer - quotient[:, None] * self._at_zero) / total
        return quotient * centring, slopes * centring[:, None]

    def _of_shape(self, quotient: Complexes, freq_cpp: Floats) -> Complexes:
        """Factor (n, m) of what the basis cannot follow.

        Its last column is the light beyond the taps, which the tail takes from them.
        """
        beyond = 1 - np.exp(-0.5 * (2 * math.pi * freq_cpp * self.basis.reach_px) ** 2)
        light = self.beta[-1] * float(self.basis.far_tail.sum()) / float(self._at_zero @ self.beta)
        far = tuned.FAR_SHARE * light * beyond * quotient
        return np.column_stack([self._shape_error.factor(freq_cpp, quotient), far])

    @cached_property
    def _shape_error(self) -> ShapeError:
        parametric = replace(self, beta=np.eye(self.beta.size)[0])

        def departure(u: Floats, v: Floats) -> Complexes:
            return np.asarray(self._quotient(u, v)[0] - parametric._quotient(u, v)[0])

        return ShapeError.of(departure, min(self.band_cpp, _HIGHEST_CPP), tuned.SHAPE_SHARE)

    @cached_property
    def _at_zero(self) -> Floats:
        nothing = np.zeros(1)
        return np.asarray(self.basis.transfer(nothing, nothing)[0].real)

    def _inflation(self, slopes: Complexes) -> Floats:
        """Factor on the standard deviations, (n,), at least 1.

        The scatter of the regions is known to a few degrees of freedom at a single frequency, so
        half of it is taken from its mean over the band.
        """
        if self.covariance.regions < tuned.MIN_REGIONS:
            return np.ones(slopes.shape[0])
        own = self.covariance.excess(slopes)
        excess = tuned.OWN_SHARE * own + (1 - tuned.OWN_SHARE) * self._mean_excess
        return np.sqrt(np.clip(excess, 1.0, tuned.MAX_INFLATION**2))

    @cached_property
    def _mean_excess(self) -> float:
        if self.covariance.regions < tuned.MIN_REGIONS:
            return 1.0
        freq = _FREQ_CPP * min(self.band_across_cpp, self.band_along_cpp, 1.0)
        nothing = np.zeros(freq.size)
        u, v = np.concatenate([freq, nothing]), np.concatenate([nothing, freq])
        return float(np.mean(self.covariance.excess(self._quotient(u, v)[1])))
