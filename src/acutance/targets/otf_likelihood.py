"""What the pixels of one measurement say of an optical transfer function (OTF), its prior apart.

A measurement is a posterior: of mean m and covariance C, where its prior had m0 and C0. What its
pixels say of a spectrum g, the likelihood L, is the posterior over the prior::

    -2 ln L(g) = (g - m)^T C^-1 (g - m) - (g - m0)^T C0^-1 (g - m0) + const
               = |R^T g - y|^2 + const,

    R R^T = C^-1 - C0^-1,    R (y - R^T m) = C0^-1 (m - m0),

complex numbers being stacked, real parts first. The spectrum is the OTF f times the light h, whose
place is x: ``g = h f exp(-2 pi i u x)``, and ``f(0) = 1``. Neither h nor x is a property of the
sensor, so both are integrated out. The place is nearly known: about an OTF near by (`placed`). So
is the light where that OTF is (`near`), but not of any other: half the OTF of twice the light is
the same spectrum, and to first order about the whole OTF an OTF of nothing is, too. Fits that may
go far leave it open (`acutance.targets.combine.lit_curves`). An error of the light that is taken
from the data would make every OTF seem less (R. W. Peelle's puzzle; G. D'Agostini, Nucl. Instrum.
Methods A 346, 306, 1994).

Likelihoods of several measurements multiply; posteriors would count the prior that they share as
often as there are of them (Rodgers, Inverse Methods for Atmospheric Sounding, 2000, section 4.1).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.pivoted_root import least_squares, pivoted_root
from acutance.numerics.small_matrices import lower_inverse, lower_square
from acutance.numerics.stacked import stacked, unstacked

__all__ = ["OtfLikelihood"]

Complexes = NDArray[np.complex128]

_EXACT = 1e-3
"""How exact models of a spectrum are: no pixels determine it better. Chi-square of the true OTF
over its freedom is .8 then, over all families of sensors (benchmarks/combine.py)."""
_NOTHING = 1.0
"""Precision of what the pixels do not show: an OTF is between 0 and 1, or little more."""
_SURE = 1e7
"""One over the error of an OTF at zero frequency, where its light is known."""
_STEPS = 3
"""Steps to the light and the place of an image, both nearly known."""
_DEPENDENT = 1e-6


@dataclass(frozen=True, eq=False)
class OtfLikelihood(ShortRepr):
    """Sum of squares of ``root.T @ f + level - values`` of an OTF f.

    Parameters
    ----------
    root : (n, k) complex array
        Real and imaginary parts belong to those of the OTF.
    level : (k,) array
        The same for zero frequency, where an OTF is 1.
    values : (k,) array
    """

    root: Complexes
    level: Floats
    values: Floats

    @classmethod
    def of_posterior(
        cls, mean: Complexes, away: Complexes, factor: Complexes, prior_factor: Complexes
    ) -> OtfLikelihood:
        """The likelihood of a measurement, from its posterior and its prior.

        Parameters
        ----------
        mean : (n + 1,) complex array
            Of the posterior, of the spectrum at frequencies from zero; 1 there.
        away : (n + 1,) complex array
            The same minus the mean of the prior.
        factor, prior_factor : (n + 1, ...) complex array
            Factors of their covariances.
        """
        prior = _inverse(prior_factor)
        root = pivoted_root(_inverse(factor) - prior, _NOTHING)
        values = root.T @ stacked(mean) + least_squares(root, prior @ stacked(away))
        level, *others = unstacked(root)
        return cls(np.asarray(others), np.asarray(level.real), values)

    def with_errors(self, factor: Complexes) -> OtfLikelihood:
        """The likelihood if there were further errors ``factor @ z`` of the OTF, factor (n, j)."""
        seen = self.whitened(factor)
        if seen.size == 0:
            return self
        size, axes = np.linalg.eigh(seen @ seen.T)
        return self._damped((axes / np.sqrt(1 + size)) @ axes.T)

    def of_known_light(self) -> OtfLikelihood:
        """The likelihood with one more value: at zero frequency the OTF is 1, as if seen there.

        For OTFs that were found whatever light their images have.
        """
        root = np.column_stack([self.root, np.zeros(len(self.root))])
        level, values = (np.append(one, _SURE) for one in (self.level, self.values))
        return OtfLikelihood(root, level, values)

    def turned(self, turn: Complexes) -> OtfLikelihood:
        """The likelihood of the OTF times a phasor (n,) at every place."""
        return OtfLikelihood(self.root * turn[:, None], self.level, self.values)

    def near(self, otf: Complexes, waves: Complexes) -> OtfLikelihood:
        """The likelihood near an OTF (n,), whatever the light and the place of the image.

        Parameters
        ----------
        otf : (n,) complex array
        waves : (n, j) complex array
            Derivatives of the logarithm of a spectrum by places.
        """
        placed = self.placed(otf, waves)
        whole = placed.whitened(otf) + placed.level
        return placed._apart(whole[:, None], float(np.linalg.norm(whole)))

    def placed(self, otf: Complexes, waves: Complexes) -> OtfLikelihood:
        """The likelihood near an OTF (n,), whatever the place of the image, in units of its light.

        Parameters as of `near`.
        """
        light, found = 1.0, self
        for _ in range(_STEPS):
            whole = found.whitened(otf) + found.level
            by_place = found.whitened(light * otf[:, None] * waves)
            columns = np.column_stack([whole, by_place])
            step = np.linalg.lstsq(columns, self.values - light * whole, rcond=_DEPENDENT)[0]
            light += float(step[0])
            found = found.turned(np.exp(-waves @ step[1:]))
        lit = OtfLikelihood(light * found.root, light * found.level, found.values)
        return lit._apart(by_place, light * float(np.linalg.norm(whole)))

    def whitened(self, values: Complexes) -> Floats:
        """``root.T @ values`` of values (n,) or (n, p)."""
        return np.asarray(stacked(self.root).T @ stacked(values))

    def residual(self, otf: Complexes) -> Floats:
        """What an OTF (n,) leaves, (k,): of unit variance if it is the sensor's."""
        return np.asarray(self.whitened(otf) + self.level - self.values)

    def widened(self, factor: float) -> OtfLikelihood:
        """The likelihood with all standard deviations multiplied."""
        return OtfLikelihood(self.root / factor, self.level / factor, self.values / factor)

    def _damped(self, matrix: Floats) -> OtfLikelihood:
        root = unstacked(stacked(self.root) @ matrix)
        return OtfLikelihood(root, self.level @ matrix, self.values @ matrix)

    def _apart(self, columns: Floats, scale: float) -> OtfLikelihood:
        """The likelihood of what no column (k, j) of whitened values of a scale changes."""
        axes, size, _ = np.linalg.svd(columns)
        return self._damped(axes[:, np.count_nonzero(size > _DEPENDENT * scale) :])

    def to_dict(self) -> dict[str, Any]:
        """Root, level and values as lists."""
        # Of more values than the root has rows some have no part in it, but in the level.
        rows = [stacked(self.root), self.level[None], self.values[None]]
        short = self._damped(_triangular(np.concatenate(rows)))
        return {
            "root_real": _rounded(short.root.real),
            "root_imag": _rounded(short.root.imag),
            "level": _rounded(short.level),
            "values": _rounded(short.values),
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> OtfLikelihood:
        """The likelihood that `to_dict` wrote.

        Raises
        ------
        ValueError
            If its parts do not belong together, or are not finite.
        """
        real, imag, level, values = (
            np.array(document[name], float)
            for name in ("root_real", "root_imag", "level", "values")
        )
        shapes = real.shape, imag.shape, level.shape, values.shape
        if real.ndim != 2 or shapes[1:] != (real.shape, real.shape[1:], real.shape[1:]):
            raise ValueError(f"a likelihood of shapes {', '.join(map(str, shapes))}")
        if not all(np.isfinite(part).all() for part in (real, imag, level, values)):
            raise ValueError("numbers that are not finite")
        return cls(real + 1j * imag, level, values)


def _inverse(factor: Complexes) -> Floats:
    wide = stacked(factor)
    covariance = wide @ wide.T + _EXACT**2 * np.eye(len(wide))
    return lower_square(lower_inverse(np.asarray(np.linalg.cholesky(covariance), float)))


def _triangular(root: Floats) -> Floats:
    """What gives a root zeros above its diagonal, a shorter text."""
    return np.asarray(np.linalg.qr(root.T)[0])


def _rounded(values: Floats) -> list[Any]:
    """Numbers of a root; below a hundredth they are nothing."""
    listed: list[Any] = np.round(values, 2).tolist()
    return listed
