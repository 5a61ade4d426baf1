"""Optical transfer functions (OTF) of many measurements, their errors whitened.

Of a measurement whose prior is known its likelihood is used, else its posterior; of the errors of
posteriors a part is taken to be common to all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincc

from acutance.curves.grid import Floats
from acutance.numerics.stacked import stacked
from acutance.targets.combine.plane import Plane
from acutance.targets.otf_likelihood import OtfLikelihood

__all__ = ["ChiSquare", "OtfSamples", "WhitenedCurves"]

Complexes = NDArray[np.complex128]

_MIN_STD = 5e-4
"""Error of an estimator without noise; it makes every covariance invertible."""

_COMMON = 0.25
"""Share of the variance of a measurement without a known prior that is common to all of one sensor:
the priors' error. Their errors scatter by 0.86 to 0.9 of the stated standard deviations where a
sensor is as its prior expects: the rest is an allowance for other shapes, and a sensor has one.
Where errors are independent, standard deviations are too wide by up to a third.
"""

_MISSED = 0.4
"""Share of its deviations by which a mean over forms misses a curve that was such a mean already,
over fewer forms and under a prior of its own: chi-square of scans beside edges that hardly count is
.05 to .75, of six sensors."""
_LOW_CPP = 0.12
_SHIFT_PX = 0.3
"""Standard deviation of the centroid of a curve: a phase linear in frequency has no meaning."""


@dataclass(frozen=True, eq=False)
class OtfSamples:
    """The OTF of one measurement at places of the plane of frequencies, with its covariance.

    Parameters
    ----------
    name : str
        Name of the measurement in tables and messages.
    u_cpp, v_cpp : (n,) array
        Frequencies across and along, cycles per pixel.
    otf : (n,) complex array
    factor : (n, k) complex array
        Factor of the covariance: the error is ``factor @ z``, z standard normal and real.
    likelihood : OtfLikelihood, optional
        What the pixels alone say, where that is known.
    is_about_curve : bool, optional
        Whether the likelihood is largest next to the curve, a mean over forms of sensors that were
        fitted before: what these do not follow of the pixels is in none of its values.
    """

    name: str
    u_cpp: Floats
    v_cpp: Floats
    otf: Complexes
    factor: Complexes
    likelihood: OtfLikelihood | None = None
    is_about_curve: bool = False

    def centred(self) -> OtfSamples:
        """The same about the centroid: the slope of the phase at low frequencies."""
        near = np.hypot(self.u_cpp, self.v_cpp) < _LOW_CPP
        places = 2 * math.pi * np.stack([self.u_cpp, self.v_cpp], axis=1)
        moved = np.linalg.lstsq(places[near], -np.angle(self.otf[near]), rcond=1e-6)[0]
        turn = np.exp(1j * (places @ moved))
        otf, factor = self.otf * turn, self.factor * turn[:, None]
        likelihood = None
        if self.likelihood is not None:
            likelihood = self.likelihood.turned(turn).placed(otf, np.asarray(-1j * places))
            # A failed measurement is not what its own pixels say; one value went into the light.
            own = float(np.sum(likelihood.residual(otf) ** 2)) / max(1, likelihood.values.size - 1)
            likelihood = likelihood.widened(math.sqrt(max(1.0, own)))
        return replace(self, otf=otf, factor=factor, likelihood=likelihood)

    @property
    def size(self) -> int:
        """Number of whitened values."""
        return 2 * self.otf.size if self.likelihood is None else self.likelihood.values.size

    @cached_property
    def values(self) -> Floats:
        """What the pixels say of the whitened spectrum, or the whitened OTF, (size,)."""
        if self.likelihood is not None:
            return self.likelihood.values
        return np.asarray(self.whitening @ stacked(self.otf))

    @cached_property
    def level(self) -> Floats:
        """The part of zero frequency in a whitened spectrum, (size,); none in an OTF."""
        return np.zeros(self.size) if self.likelihood is None else self.likelihood.level

    @cached_property
    def whitened_factor(self) -> Floats:
        """Factor of the covariance of the whitened errors, (size, size or k).

        Of a likelihood they have unit variance; of one about the curve they are those of the curve,
        in the few directions that forms follow. Of a posterior it is the symmetric factor of the
        errors, whitened: every column belongs to a frequency, and the smallest errors are below 1.
        """
        if self.likelihood is not None:
            if self.is_about_curve:
                return np.asarray(self.whitening @ stacked(self.factor))
            return np.eye(self.size)
        wide = stacked(self.factor)
        value, vector = np.linalg.eigh(wide @ wide.T)
        return np.asarray(self.whitening @ (vector * np.sqrt(np.maximum(value, 0.0))) @ vector.T)

    @property
    def own_residual(self) -> Floats:
        """What the curve leaves of the values, (size,); of a posterior nothing."""
        if self.likelihood is None:
            return np.zeros(self.size)
        return self.likelihood.residual(self.otf)

    @cached_property
    def whitening(self) -> Floats:
        """Matrix (size, 2n) that gives the stacked real and imaginary errors unit variance."""
        if self.likelihood is not None:
            return np.asarray(stacked(self.likelihood.root).T)
        wide = stacked(np.concatenate([self.factor, self._shifts], axis=1))
        value, vector = np.linalg.eigh(wide @ wide.T + _MIN_STD**2 * np.eye(wide.shape[0]))
        return np.asarray((vector / np.sqrt(value)) @ vector.T)

    @property
    def _shifts(self) -> Complexes:
        """Errors of the place of the image, which has no meaning."""
        move = 2j * math.pi * _SHIFT_PX * self.otf[:, None]
        return np.asarray(move * np.stack([self.u_cpp, self.v_cpp], axis=1))


@dataclass(frozen=True)
class ChiSquare:
    """Sum of squares of residuals in units of their standard deviations, and what is expected.

    Parameters
    ----------
    value : float
    expected : float
        Its mean if model and standard deviations are true: the effective degrees of freedom.
    variance : float
        Its variance then.
    """

    value: float
    expected: float
    variance: float

    @property
    def p_value(self) -> float:
        """Chance of a larger one; a scaled chi-square has the mean and the variance."""
        if not (self.expected > 0 and self.variance > 0):
            return math.nan
        scale = self.variance / (2 * self.expected)
        return float(gammaincc(0.5 * self.expected / scale, 0.5 * self.value / scale))

    @property
    def birge_ratio(self) -> float:
        """Root of chi-square over its mean, at least 1: the factor by which deviations are widened.

        R. T. Birge, Phys. Rev. 40, 207 (1932).
        """
        if not self.expected > 0:
            return 1.0
        return max(1.0, math.sqrt(self.value / self.expected))


@dataclass(frozen=True, eq=False)
class WhitenedCurves:
    """All curves in one: places, values, and a matrix for each that whitens its errors.

    Parameters
    ----------
    curves : sequence of OtfSamples
    """

    curves: Sequence[OtfSamples]

    @cached_property
    def u_cpp(self) -> Floats:
        """Frequencies across, (n,)."""
        return np.concatenate([one.u_cpp for one in self.curves])

    @cached_property
    def v_cpp(self) -> Floats:
        """Frequencies along, (n,)."""
        return np.concatenate([one.v_cpp for one in self.curves])

    @cached_property
    def plane(self) -> Plane:
        """Places of all curves."""
        return Plane(self.u_cpp, self.v_cpp)

    @cached_property
    def values(self) -> Floats:
        """The spectra, or OTFs, stacked and whitened."""
        return np.concatenate([one.values for one in self.curves])

    @cached_property
    def level(self) -> Floats:
        """The part of zero frequency in them."""
        return np.concatenate([one.level for one in self.curves])

    @cached_property
    def _segments(self) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Of the curves that have values: the first of these, how many, whether they are a spectrum
        of unknown light."""
        seen = [one for one in self.curves if one.size]
        sizes = np.array([one.size for one in seen], np.intp)
        is_lit = np.array([one.likelihood is not None for one in seen], bool)
        return np.cumsum(sizes) - sizes, sizes, is_lit

    @property
    def spectra(self) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Of the curves that have values: where those of each begin, and the last ones end, and
        whether it is a spectrum of unknown light."""
        first, _, is_lit = self._segments
        return np.append(first, self.values.size), is_lit

    def sums(self, values: Floats) -> Floats:
        """Sums of whitened values (..., size) over every curve that has some, (..., curves)."""
        return np.asarray(np.add.reduceat(values, self._segments[0], axis=-1))

    def of_spectra(self, numbers: Floats, else_: float) -> Floats:
        """The number of its spectrum (..., curves) for every value, (..., size).

        Of curves that are no spectra another one.
        """
        _, sizes, is_lit = self._segments
        return np.repeat(np.where(is_lit, numbers, else_), sizes, axis=-1)

    @cached_property
    def _ends(self) -> list[int]:
        return [0, *np.cumsum([one.otf.size for one in self.curves]).tolist()]

    @cached_property
    def parts(self) -> list[slice]:
        """The rows of each curve in whitened values."""
        ends = np.cumsum([0, *(one.size for one in self.curves)]).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of the whitened errors, (size, size)."""
        total = self.shared.copy()
        for part, one in zip(self.parts, self.curves, strict=True):
            total[part, part] += one.whitened_factor @ one.whitened_factor.T
        return total

    @cached_property
    def missed(self) -> Floats:
        """Covariance of what forms miss of curves that are a mean over forms, (size, size).

        With what the curves themselves leave of their values: of few edges some.
        """
        total = np.zeros((self.values.size, self.values.size))
        for part, one in zip(self.parts, self.curves, strict=True):
            if one.is_about_curve:
                total[part, part] = _MISSED**2 * one.whitened_factor @ one.whitened_factor.T
                total[part, part] += np.outer(one.own_residual, one.own_residual)
        return total

    @cached_property
    def shared(self) -> Floats:
        """Covariance of the whitened errors of different curves, (size, size).

        Common are the errors of the real parts of posteriors at one frequency, in all directions.
        """
        freq = np.round(np.hypot(self.u_cpp, self.v_cpp), 3)
        known, number = np.unique(freq, return_inverse=True)
        together = np.zeros((self.values.size, known.size))
        own = np.zeros((self.values.size, self.values.size))
        for part, one, (a, b) in zip(self.parts, self.curves, pairwise(self._ends), strict=True):
            if one.likelihood is not None:
                continue
            places = number[a:b]
            same_freq = np.zeros((b - a, known.size))
            same_freq[np.arange(b - a), places] = 1 / np.sqrt(np.bincount(places)[places])
            together[part] = one.whitened_factor[:, : b - a] @ same_freq
            own[part, part] = together[part] @ together[part].T
        return np.asarray(_COMMON * (together @ together.T - own))

    def shared_of(self, ways: Floats) -> Floats:
        """Covariance of products of the whitened errors with some ways (size, k), (k, k), as far
        as errors of different curves are shared: likelihoods share none."""
        if all(one.likelihood is not None for one in self.curves):
            return np.zeros((ways.shape[1],) * 2)
        return np.asarray(ways.T @ self.shared @ ways)

    def of(self, values: Complexes) -> Floats:
        """Values (..., n) at all places, whitened curve by curve, (..., size)."""
        rows = np.ascontiguousarray(values, complex).reshape(-1, self.u_cpp.size).view(float)
        found = np.empty((len(rows), self.values.size))
        places = pairwise(self._ends)
        for (a, b), part, matrix in zip(places, self.parts, self._matrices, strict=True):
            np.matmul(rows[:, 2 * a : 2 * b], matrix, out=found[:, part])
        return found.reshape(*values.shape[:-1], -1)

    @cached_property
    def _matrices(self) -> list[Floats]:
        """What whitens each curve, (2 n, m): real and imaginary parts of a place side by side."""
        found = []
        for one in self.curves:
            parts = np.stack(np.split(one.whitening.T, 2), axis=1)
            found.append(parts.reshape(one.whitening.shape[::-1]))
        return found
