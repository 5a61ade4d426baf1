"""Slices of a measured optical transfer function (OTF), with the covariance to combine them.

A measurement that draws on a prior is part data, part expectation. Several of one sensor share the
expectation: so what the pixels alone say is kept beside the slices.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Mtf, Otf2d
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.numerics.pivoted_root import pivoted_root
from acutance.numerics.stacked import stacked, unstacked
from acutance.targets.otf_likelihood import OtfLikelihood

__all__ = ["SLICE_DIRECTIONS_DEG", "SLICE_FREQ_CPP", "OtfSlices", "places_along"]

Complexes = NDArray[np.complex128]

SLICE_DIRECTIONS_DEG = (0.0, 45.0, 90.0, 135.0)
"""Directions in which a 2-D OTF is written, if the target has none of its own."""

SLICE_FREQ_CPP: Floats = np.asarray(np.arange(1, 17) * 0.05)
"""Frequencies of slices, cycles per pixel."""
_MIN_STD = 1.5e-4
"""Columns of a covariance factor below this are left out: no method is that exact."""
_ROUNDING = 0.05
"""Of a document: what rounding adds to the factor of a place, relative to the median deviation. It
adds to the variance. Fewer columns instead, with the rest as independent errors, take from it:
combinations then state half their deviations."""


@dataclass(frozen=True, eq=False)
class OtfSlices(ShortRepr):
    """Slices of a 2-D OTF with their common covariance.

    Parameters
    ----------
    normal_deg : (m,) array
        Directions, from the column axis (0) towards the row axis (90).
    freq_cpp : (n,) array
        Frequencies along each, cycles per pixel.
    otf : (m * n,) complex array
        Direction by direction.
    factor : (m * n, k) complex array
        Factor of the covariance: the error is ``factor @ z``, z standard normal and real.
    likelihood : OtfLikelihood, optional
        What the pixels say, the prior apart; ``None`` where it is not known, or there is no prior.
    """

    normal_deg: Floats
    freq_cpp: Floats
    otf: Complexes
    factor: Complexes
    likelihood: OtfLikelihood | None = None

    @classmethod
    def of_curve(cls, mtf: Mtf, normal_deg: float) -> OtfSlices:
        """The slice along the normal of an edge or a pulse."""
        # The grid of a curve has steps of 0.01 c/px and holds these frequencies.
        own = mtf.near(SLICE_FREQ_CPP)
        return cls(np.array([normal_deg]), SLICE_FREQ_CPP, own.otf, _narrowed(own.otf_factor))

    @classmethod
    def of_otf2d(
        cls,
        otf: Otf2d,
        directions_deg: Sequence[float] = SLICE_DIRECTIONS_DEG,
        band_cpp: tuple[float, float] = (0.0, 1.0),
    ) -> OtfSlices:
        """Slices of a 2-D OTF at the frequencies it was measured at."""
        low, high = band_cpp
        freq = SLICE_FREQ_CPP[(low - 1e-9 <= SLICE_FREQ_CPP) & (high + 1e-9 >= SLICE_FREQ_CPP)]
        directions = np.asarray(directions_deg, float)
        u, v = places_along(directions, freq)
        return cls(directions, freq, otf.model.otf(u, v), _narrowed(otf.model.factor(u, v)))

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Frequencies across and along, (m * n,) each."""
        return places_along(self.normal_deg, self.freq_cpp)

    def to_dict(self) -> dict[str, Any]:
        """Directions, frequencies, OTF and factor as lists."""
        factor = _triangular(self.factor)
        decimals = _decimals(factor)
        document = {
            "normal_deg": self.normal_deg.tolist(),
            "freq_cpp": np.round(self.freq_cpp, 6).tolist(),
            "otf_real": np.round(self.otf.real, 6).tolist(),
            "otf_imag": np.round(self.otf.imag, 6).tolist(),
            "factor_real": np.round(factor.real, decimals).tolist(),
            "factor_imag": np.round(factor.imag, decimals).tolist(),
        }
        if self.likelihood is not None:
            document["likelihood"] = self.likelihood.to_dict()
        return document

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> OtfSlices:
        """The slices that `to_dict` wrote.

        Raises
        ------
        OptionError
            If the document holds something else.
        """
        try:
            return cls._read(document)
        except (KeyError, TypeError, ValueError) as error:
            raise OptionError(
                f"cannot read the slices of the OTF ({error}): give a document that acutance wrote"
            ) from error

    @classmethod
    def _read(cls, document: Mapping[str, Any]) -> OtfSlices:
        normal, freq = (np.array(document[name], float) for name in ("normal_deg", "freq_cpp"))
        otf = _complex(document, "otf")
        factor = _complex(document, "factor")
        if factor.ndim != 2:
            factor = factor.reshape(otf.size, -1)
        if otf.shape != (normal.size * freq.size,) or factor.shape[0] != otf.size:
            raise ValueError(
                f"{normal.size} directions and {freq.size} frequencies with {otf.size} values and "
                f"a factor of {factor.shape[0]} rows"
            )
        if not all(np.isfinite(part).all() for part in (normal, freq, otf, factor)):
            raise ValueError("numbers that are not finite")
        if "likelihood" not in document:
            return cls(normal, freq, otf, factor)
        likelihood = OtfLikelihood.from_dict(document["likelihood"])
        if likelihood.root.shape[0] != otf.size:
            raise ValueError(f"a likelihood of {likelihood.root.shape[0]} of {otf.size} values")
        return cls(normal, freq, otf, factor, likelihood)


def _complex(document: Mapping[str, Any], name: str) -> Complexes:
    real, imag = (np.array(document[f"{name}_{part}"], float) for part in ("real", "imag"))
    return np.asarray(real + 1j * imag)


def places_along(normal_deg: Floats, freq_cpp: Floats) -> tuple[Floats, Floats]:
    """Frequencies across and along (m * n,) of n frequencies along each of m directions."""
    x, y = unit_vector(normal_deg)
    return np.outer(x, freq_cpp).ravel(), np.outer(y, freq_cpp).ravel()


def _triangular(factor: Complexes) -> Complexes:
    """Another factor of the same covariance, a shorter text: with zeros above its diagonal.

    Its diagonal is positive, so that there is but one.
    """
    lower = np.asarray(np.linalg.qr(stacked(factor).T, mode="r")).T
    return unstacked(lower * np.copysign(1.0, lower.diagonal()))


def _decimals(factor: Complexes) -> int:
    """Decimals with which the columns of a factor together err by little, 4 at least."""
    std = np.sqrt(np.einsum("ij,ij->i", factor.real, factor.real)).tolist()
    allowed = _ROUNDING * median(std) if std else 0.0
    step = allowed * math.sqrt(12 / max(factor.shape[1], 1))
    return min(max(-math.floor(math.log10(step)), 4), 6) if step > 0 else 6


def _narrowed(factor: Complexes) -> Complexes:
    """The same covariance with as few columns as it needs."""
    if factor.size == 0:
        return factor
    wide = stacked(factor)
    return unstacked(pivoted_root(wide @ wide.T, _MIN_STD**2))
