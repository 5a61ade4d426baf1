"""What the pixels of one measurement say of an optical transfer function (OTF), its prior apart.

A measurement is a posterior: of mean m and covariance C, where its prior had m0 and C0. What its
pixels say of the OTF f, the likelihood L, is the posterior over the prior::

    -2 ln L(f) = (f - m)^T C^-1 (f - m) - (f - m0)^T C0^-1 (f - m0) + const
               = |R^T (f - m) - b|^2 + const,

    R R^T = C^-1 - C0^-1,    R b = C0^-1 (m - m0),

complex numbers being stacked, real parts first. Likelihoods of several measurements multiply;
posteriors would count the prior that they share as often as there are of them (Rodgers, Inverse
Methods for Atmospheric Sounding, 2000, section 4.1).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.stacked import stacked, unstacked

__all__ = ["OtfLikelihood"]

Complexes = NDArray[np.complex128]

_BEYOND_PRIOR_STD = 2e-3
"""How far sensors depart from what a prior allows for: at .0005 and .001 the OTF of diffracting
and defocused sensors lies 10 to 60 standard deviations off in directions that neither prior nor
pixels show; at .002 its chi-square is what it should be (benchmarks/combine.py)."""
_NOTHING = 1.0
"""Precision of what the pixels do not show: an OTF is between 0 and 1, or little more."""


@dataclass(frozen=True, eq=False)
class OtfLikelihood(ShortRepr):
    """Sum of squares of ``root.T @ (f - m) - offset`` of an OTF f about a measured one, m.

    Parameters
    ----------
    root : (n, k) complex array
        Real and imaginary parts belong to those of the OTF.
    offset : (k,) array
    """

    root: Complexes
    offset: Floats

    @classmethod
    def of_posterior(
        cls, away: Complexes, factor: Complexes, prior_factor: Complexes
    ) -> OtfLikelihood:
        """The likelihood of a measurement, from its posterior and its prior.

        Parameters
        ----------
        away : (n,) complex array
            Mean of the posterior minus that of the prior.
        factor, prior_factor : (n, ...) complex array
            Factors of their covariances, at one size of the prior.
        """
        prior = _inverse(prior_factor)
        size, axes = np.linalg.eigh(_inverse(factor) - prior)
        seen = size > _NOTHING
        root = axes[:, seen] * np.sqrt(size[seen])
        return cls(unstacked(root), (root / size[seen]).T @ (prior @ stacked(away)))

    def with_errors(self, factor: Complexes) -> OtfLikelihood:
        """The likelihood if there were further errors ``factor @ z``, factor (n, j)."""
        seen = self.whitened(factor)
        if seen.size == 0:
            return self
        size, axes = np.linalg.eigh(seen @ seen.T)
        damped = (axes / np.sqrt(1 + size)) @ axes.T
        return OtfLikelihood(unstacked(stacked(self.root) @ damped), damped @ self.offset)

    def about(self, away: Complexes) -> OtfLikelihood:
        """The same likelihood, of the OTF about one that differs by `away`, (n,)."""
        return OtfLikelihood(self.root, self.offset - self.whitened(away))

    def turned(self, turn: Complexes) -> OtfLikelihood:
        """The likelihood of the OTF times a phasor (n,) at every place."""
        return OtfLikelihood(self.root * turn[:, None], self.offset)

    def whitened(self, values: Complexes) -> Floats:
        """``root.T @ values`` of values (n,) or (n, p)."""
        return np.asarray(stacked(self.root).T @ stacked(values))

    def to_dict(self) -> dict[str, Any]:
        """Root and offset as lists."""
        lower, turn = _triangular(stacked(self.root))
        root = unstacked(lower)
        return {
            "root_real": _rounded(root.real),
            "root_imag": _rounded(root.imag),
            "offset": _rounded(turn @ self.offset),
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> OtfLikelihood:
        """The likelihood that `to_dict` wrote.

        Raises
        ------
        ValueError
            If root and offset do not belong together, or are not finite.
        """
        real, imag, offset = (
            np.array(document[name], float) for name in ("root_real", "root_imag", "offset")
        )
        if real.ndim != 2 or real.shape != imag.shape or offset.shape != real.shape[1:]:
            raise ValueError(f"a likelihood of shapes {real.shape}, {imag.shape}, {offset.shape}")
        if not all(np.isfinite(part).all() for part in (real, imag, offset)):
            raise ValueError("numbers that are not finite")
        return cls(real + 1j * imag, offset)


def _inverse(factor: Complexes) -> Floats:
    wide = stacked(factor)
    return np.asarray(np.linalg.inv(wide @ wide.T + _BEYOND_PRIOR_STD**2 * np.eye(len(wide))))


def _triangular(root: Floats) -> tuple[Floats, Floats]:
    """A root with zeros above its diagonal, a shorter text, and what turns the offset with it."""
    turn, upper = np.linalg.qr(root.T)
    return np.asarray(upper.T), np.asarray(turn.T)


def _rounded(values: Floats) -> list[Any]:
    """Numbers of a root; below a hundredth they are nothing."""
    listed: list[Any] = np.round(values, 2).tolist()
    return listed
