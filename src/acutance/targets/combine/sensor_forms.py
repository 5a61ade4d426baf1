"""Parametric sensors: products of terms (`sensor_terms`) with a rectangular detector.

The forms are those of `acutance.optics.FAMILIES`: what a telescope, its detector and the processing
on the ground do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.targets.combine.sensor_terms import TERMS, Term, Transfer

__all__ = ["FORMS", "SensorForm"]

Complexes = NDArray[np.complex128]

_STEP = 1e-5
_OBLIQUE = {
    "upright gaussian": "gaussian", "round gaussian": "gaussian", "upright smear": "smear",
}  # fmt: skip
_GAUSSIAN_WIDTHS = ("sigma_across_px", "sigma_along_px", "sigma_minor_px")
_FILL_STD = 0.12
"""Of the logarithm of a detector's width over the stated one: fill factors are near one."""


@dataclass(frozen=True)
class SensorForm:
    """A product of terms with a rectangular detector.

    Parameters
    ----------
    terms : tuple of str
        Names in `TERMS`.
    detector_px : (float, float)
        Width of the detector across and along, in pixels.

    Examples
    --------
    >>> print(SensorForm(("gaussian", "smear"), (1.0, 1.0)).name)
    gaussian x detector x smear
    """

    terms: tuple[str, ...]
    detector_px: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        unknown = [name for name in self.terms if name not in TERMS]
        if unknown or not self.terms:
            raise ModelError(
                f"a sensor form was made of {', '.join(self.terms) or 'nothing'}: its terms are "
                f"{', '.join(TERMS)}"
            )

    @property
    def name(self) -> str:
        """What it is made of."""
        return " x ".join([self.terms[0], "detector", *self.terms[1:]])

    @property
    def mean(self) -> Floats:
        """Prior mean of all parameters, (p,): of the terms, then of the detector's fill."""
        return np.array([*(one for name in self.terms for one in TERMS[name].mean), 0.0])

    @property
    def std(self) -> Floats:
        """Prior standard deviation of all parameters, (p,)."""
        return np.array([*(one for name in self.terms for one in TERMS[name].std), _FILL_STD])

    def otf(self, p: Floats, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF (n,), exactly 1 at zero frequency."""
        return _product([factor(own, u_cpp, v_cpp) for factor, own in self._factors(p)])

    def detector_otf(self, p: Floats, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """OTF of the detector alone, (n,)."""
        across, along = math.exp(p[-1]) * np.array(self.detector_px)
        return np.asarray(np.sinc(across * u_cpp) * np.sinc(along * v_cpp))

    def slopes(self, p: Floats, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Derivatives of the OTF by the parameters, (n, p)."""
        split = [(term.otf, term.slopes, own) for term, own in self._split(p)]
        factors = [*split, (self.detector_otf, None, p[-1:])]
        values = [otf(own, u_cpp, v_cpp) for otf, _, own in factors]
        columns = []
        for i, (otf, slopes, own) in enumerate(factors):
            others = _product(values[:i] + values[i + 1 :])
            if slopes is None:
                by_own = _differences(otf, values[i], own, u_cpp, v_cpp)
            else:
                by_own = slopes(own, u_cpp, v_cpp)
            columns.append(others[:, None] * by_own)
        return np.concatenate(columns, axis=1)

    def numbers(self, p: Floats) -> dict[str, float]:
        """The reported numbers, by name."""
        found: dict[str, float] = {}
        for term, own in self._split(p):
            found |= term.numbers(own)
        return {**found, "detector_fill": math.exp(p[-1])}

    def min_sigma_px(self, p: Floats) -> float:
        """Smallest standard deviation of the Gaussian: it limits the band."""
        widths = (one for name, one in self.numbers(p).items() if name in _GAUSSIAN_WIDTHS)
        return min(widths, default=0.0)

    @property
    def oblique_terms(self) -> tuple[str, ...]:
        """Terms of the form in any direction that this one is a case of."""
        return tuple(_OBLIQUE.get(name, name) for name in self.terms)

    def aligned(self, p: Floats) -> tuple[tuple[SensorForm, Floats | None], ...]:
        """The same along the axes of the image, its Gaussian elliptical or round.

        Each with the parameters that are nearest to some of this form; a smear has none, since
        both of its lengths may have either sign.
        """
        first, *others = self.terms
        if first != "gaussian":
            return ()
        upright = ["upright smear" if one == "smear" else one for one in others]
        across, along, correlation = p[:3]
        widths = {
            "upright": [across, along],
            "round": [0.5 * (across + along), 0.5 * (across - along), correlation],
        }
        return tuple(
            (
                replace(self, terms=(f"{kind} gaussian", *upright)),
                None if "smear" in others else np.array([*own, *p[3:]]),
            )
            for kind, own in widths.items()
        )

    def _factors(self, p: Floats) -> list[tuple[Transfer, Floats]]:
        """The factors of the product, each with its parameters, in their order."""
        terms = [(term.otf, own) for term, own in self._split(p)]
        return [*terms, (self.detector_otf, p[-1:])]

    def _split(self, p: Floats) -> list[tuple[Term, Floats]]:
        found, start = [], 0
        for name in self.terms:
            stop = start + len(TERMS[name].mean)
            found.append((TERMS[name], p[start:stop]))
            start = stop
        return found


def _differences(
    otf: Transfer, here: NDArray[Any], p: Floats, u: Floats, v: Floats
) -> NDArray[Any]:
    """Derivatives by the parameters, (n, p), by differences from the OTF as it is `here`."""
    moves = _STEP * np.eye(p.size)
    return np.stack([(otf(p + move, u, v) - here) / _STEP for move in moves], axis=1)


def _product(values: list[NDArray[Any]]) -> Complexes:
    return np.asarray(np.prod(values, axis=0), complex)


FORMS: tuple[tuple[str, ...], ...] = (
    ("gaussian",),
    ("gaussian", "smear"),
    ("gaussian", "halo"),
    ("gaussian", "trail"),
    ("gaussian", "diffraction"),
    ("gaussian", "defocus"),
    ("gaussian", "sharpening"),
    ("gaussian", "unsharp"),
    ("gaussian", "kernel"),
    ("gaussian", "interpolation"),
    ("gaussian", "smear", "halo"),
    ("gaussian", "smear", "trail"),
    ("gaussian", "halo", "trail"),
    ("gaussian", "smear", "sharpening"),
    ("gaussian", "diffraction", "smear"),
    ("gaussian", "diffraction", "halo"),
    ("gaussian", "diffraction", "sharpening"),
    ("gaussian", "diffraction", "unsharp"),
    ("gaussian", "diffraction", "kernel"),
    ("gaussian", "smear", "kernel"),
    ("gaussian", "defocus", "kernel"),
    ("gaussian", "diffraction", "smear", "kernel"),
    ("gaussian", "diffraction", "interpolation"),
    ("gaussian", "defocus", "interpolation"),
    ("gaussian", "phase"),
    ("gaussian", "diffraction", "phase"),
    ("gaussian", "halo", "phase"),
    ("gaussian", "defocus", "phase"),
    ("gaussian", "kernel", "phase"),
    ("gaussian", "diffraction", "kernel", "phase"),
)
"""Forms that are tried, the simplest first."""
