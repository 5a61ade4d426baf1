"""Parametric sensors: products of terms (`sensor_terms`) with a rectangular detector.

The forms are those of `acutance.optics.FAMILIES`: what a telescope, its detector and the processing
on the ground do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_terms import TERMS, sinc_growth
from acutance.targets.combine.term import Term, Transfer

__all__ = ["FORMS", "SCENE_FORMS", "SensorForm", "product"]

Complexes = NDArray[np.complex128]

_STEP = 1e-5
_OBLIQUE = {
    "upright gaussian": "gaussian", "round gaussian": "gaussian", "upright smear": "smear",
}  # fmt: skip
_GAUSSIAN_WIDTHS = ("sigma_across_px", "sigma_along_px", "sigma_minor_px")
_FILL_STD = 0.12
"""Of the logarithm of a detector's width over the stated one: fill factors are near one."""
_DIFFUSION_MEAN, _DIFFUSION_STD = math.log(0.1), 1.0
"""Of the logarithm of the depth from which charge spreads, px: every detector has some."""


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
        """Prior mean of all parameters, (p,): of terms, of diffusion, of the detector's fill."""
        own = [one for name in self.terms for one in TERMS[name].mean]
        return np.array([*own, _DIFFUSION_MEAN, 0.0])

    @property
    def std(self) -> Floats:
        """Prior standard deviation of all parameters, (p,)."""
        own = [one for name in self.terms for one in TERMS[name].std]
        return np.array([*own, _DIFFUSION_STD, _FILL_STD])

    def otf(self, p: Floats, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF (n,), exactly 1 at zero frequency."""
        return self.otf_on(p, Plane(u_cpp, v_cpp))

    def otf_on(self, p: Floats, plane: Plane) -> Complexes:
        """OTF (n,) at places of the plane."""
        return product(self.factors_on(p, plane))

    def factors_on(self, p: Floats, plane: Plane) -> list[NDArray[Any]]:
        """OTFs of all terms, of diffusion, and of the detector as the last, (n,) each."""
        own = [term.otf(own, plane) for term, own in self._split(p)]
        return [*own, _diffusion(p[-2], plane), _detector(p[-1:], plane, self.detector_px)]

    def slopes_on(
        self, p: Floats, plane: Plane, factors: list[NDArray[Any]] | None = None
    ) -> Complexes:
        """Derivatives of the OTF by the parameters, (n, p); the factors may be known already."""
        values = self.factors_on(p, plane) if factors is None else factors
        slopes = [
            _differences(term.otf, here, own, plane) if term.slopes is None
            else term.slopes(own, plane)
            for (term, own), here in zip(self._split(p), values, strict=False)
        ]  # fmt: skip
        slopes.append(_diffusion_slopes(p[-2], plane))
        slopes.append(_detector_slopes(p[-1:], plane, self.detector_px))
        others = [product(values[:i] + values[i + 1 :]) for i in range(len(values))]
        return np.concatenate(
            [other[:, None] * by_own for other, by_own in zip(others, slopes, strict=True)], axis=1
        )

    def numbers(self, p: Floats) -> dict[str, float]:
        """The reported numbers, by name."""
        found: dict[str, float] = {}
        for term, own in self._split(p):
            found |= term.numbers(own)
        return {**found, "diffusion_px": math.exp(p[-2]), "detector_fill": math.exp(p[-1])}

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

    def _split(self, p: Floats) -> list[tuple[Term, Floats]]:
        found, start = [], 0
        for name in self.terms:
            stop = start + len(TERMS[name].mean)
            found.append((TERMS[name], p[start:stop]))
            start = stop
        return found


def _diffusion(log_depth: float, plane: Plane) -> Floats:
    """OTF of charge that spreads before it is collected, (n,): `acutance.optics.ChargeDiffusion`.

    A Gaussian where it takes little, of tails that fall more slowly.
    """
    return np.asarray(_sech(math.exp(log_depth) * plane.waves))


def _diffusion_slopes(log_depth: float, plane: Plane) -> Floats:
    """Its derivative, (n, 1)."""
    travelled = math.exp(log_depth) * plane.waves
    return np.asarray((-travelled * np.tanh(travelled) * _sech(travelled))[:, None])


def _sech(x: Floats) -> Floats:
    """One over the hyperbolic cosine, where that is too large as well."""
    falls = np.exp(-np.abs(x))
    return np.asarray(2 * falls / (1 + falls**2))


def _detector(p: Floats, plane: Plane, detector_px: tuple[float, float]) -> Floats:
    """OTF of a rectangular detector, (n,), by the logarithm of its width over the stated one."""
    across, along = _detector_waves(p, plane, detector_px)
    return np.asarray(np.sinc(across) * np.sinc(along))


def _detector_slopes(p: Floats, plane: Plane, detector_px: tuple[float, float]) -> Floats:
    """Its derivative, (n, 1)."""
    across, along = _detector_waves(p, plane, detector_px)
    one, other = np.sinc(across), np.sinc(along)
    by_both = sinc_growth(across, one) * other + one * sinc_growth(along, other)
    return np.asarray(by_both[:, None])


def _detector_waves(
    p: Floats, plane: Plane, detector_px: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Cycles over the detector, across and along."""
    across, along = math.exp(p[0]) * np.array(detector_px)
    return across * plane.u_cpp, along * plane.v_cpp


def _differences(otf: Transfer, here: NDArray[Any], p: Floats, plane: Plane) -> NDArray[Any]:
    """Derivatives by the parameters, (n, p), by differences from the OTF as it is `here`.

    To one side: a step leads away from a smear or a trail of 0, which is stationary. By slopes in
    closed form a fit that comes there stays.
    """
    moves = _STEP * np.eye(p.size)
    return np.stack([(otf(p + move, plane) - here) / _STEP for move in moves], axis=1)


def product(values: list[NDArray[Any]]) -> Complexes:
    """Of factors of an OTF, (n,)."""
    return np.asarray(reduce(np.multiply, values), complex)


SCENE_FORMS: tuple[tuple[str, ...], ...] = (
    ("gaussian",),
    ("gaussian", "smear"),
    ("gaussian", "halo"),
    ("gaussian", "trail"),
    ("gaussian", "diffraction"),
    ("gaussian", "defocus"),
    ("gaussian", "sharpening"),
    ("gaussian", "unsharp"),
    ("gaussian", "square kernel"),
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
    ("gaussian", "diffraction", "square kernel"),
    ("gaussian", "diffraction", "kernel"),
    ("gaussian", "smear", "kernel"),
    ("gaussian", "defocus", "kernel"),
    ("gaussian", "diffraction", "smear", "kernel"),
    ("gaussian", "diffraction", "interpolation"),
    ("gaussian", "defocus", "interpolation"),
    ("gaussian", "resampling"),
    ("gaussian", "smear", "resampling"),
    ("gaussian", "halo", "resampling"),
    ("gaussian", "diffraction", "resampling"),
    ("gaussian", "defocus", "resampling"),
    ("gaussian", "phase"),
    ("gaussian", "diffraction", "phase"),
    ("gaussian", "halo", "phase"),
    ("gaussian", "defocus", "phase"),
    ("gaussian", "kernel", "phase"),
    ("gaussian", "diffraction", "kernel", "phase"),
)
"""Forms that are tried under the edges of a scene, turn by turn, the simplest first."""

FORMS: tuple[tuple[str, ...], ...] = (
    *SCENE_FORMS,
    ("gaussian", "aberrated"),
    ("gaussian", "smear", "aberrated"),
    ("gaussian", "short kernel"),
    ("gaussian", "diffraction", "short kernel"),
    ("gaussian", "smear", "short kernel"),
    ("gaussian", "defocus", "sharpening"),
    ("gaussian", "defocus", "short kernel"),
    ("gaussian", "diffraction", "smear", "sharpening"),
    ("gaussian", "diffraction", "smear", "short kernel"),
    ("gaussian", "sharpening", "interpolation"),
    ("gaussian", "short kernel", "interpolation"),
    ("gaussian", "diffraction", "sharpening", "interpolation"),
    ("gaussian", "diffraction", "short kernel", "interpolation"),
    ("gaussian", "defocus", "sharpening", "interpolation"),
    ("gaussian", "sharpening", "phase"),
    ("gaussian", "short kernel", "phase"),
    ("gaussian", "diffraction", "sharpening", "phase"),
    ("gaussian", "diffraction", "short kernel", "phase"),
    ("gaussian", "defocus", "sharpening", "phase"),
    ("gaussian", "defocus", "short kernel", "phase"),
)
"""Forms that are tried of targets. Those of light kernels, and of two kinds of processing, make
the fit of a scene half as long again and its intervals hold no more often (39 small scenes)."""
