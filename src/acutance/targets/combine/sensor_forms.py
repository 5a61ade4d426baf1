"""Parametric sensors over the plane of frequencies: Gaussian x detector x smear, halo, ...

The forms are those of `acutance.optics.FAMILIES`: what a telescope, its detector and the processing
on the ground do. Each is a product of terms; each term is centred, so that no form moves the image.
Parameters are unbounded numbers of order 1 with a normal prior, as wide as the range of real
sensors: it keeps a term that the data do not show from running away.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.geometry.angles import wrap_axis
from acutance.optics import Defocus, Diffraction, Resampling

__all__ = ["FORMS", "TERMS", "SensorForm", "Term"]

Complexes = NDArray[np.complex128]
Transfer = Callable[[Floats, Floats, Floats], NDArray[Any]]
"""Optical transfer function (OTF), (n,), by parameters and frequencies in cycles per pixel."""

_STEP = 1e-4


@dataclass(frozen=True)
class Term:
    """One factor of a parametric OTF.

    Parameters
    ----------
    otf : function of (parameters, u, v)
        1 at zero frequency.
    mean, std : tuple of float
        Prior mean and standard deviation of the parameters.
    numbers : function of parameters
        The reported numbers, by name with the unit.
    """

    otf: Transfer
    mean: tuple[float, ...]
    std: tuple[float, ...]
    numbers: Callable[[Floats], dict[str, float]]


def _blur_covariance(p: Floats) -> tuple[float, float, float]:
    """Variances across and along and covariance of the Gaussian, px^2."""
    across, along = math.exp(p[0]), math.exp(p[1])
    correlation = math.tanh(p[2])
    return across**2, along**2, correlation * across * along


def _gaussian(p: Floats, u: Floats, v: Floats) -> Floats:
    xx, yy, xy = _blur_covariance(p)
    return np.asarray(np.exp(-2 * math.pi**2 * (xx * u**2 + 2 * xy * u * v + yy * v**2)))


def _gaussian_numbers(p: Floats) -> dict[str, float]:
    xx, yy, xy = _blur_covariance(p)
    middle, half = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), xy)
    return {
        "sigma_across_px": math.sqrt(xx),
        "sigma_along_px": math.sqrt(yy),
        "correlation": math.tanh(p[2]),
        "sigma_major_px": math.sqrt(middle + half),
        "sigma_minor_px": math.sqrt(max(middle - half, 0.0)),
        "major_axis_deg": math.degrees(0.5 * math.atan2(2 * xy, xx - yy)),
    }


def _upright(p: Floats, u: Floats, v: Floats) -> Floats:
    """A Gaussian whose axes are those of the image."""
    return _gaussian(np.append(p, 0.0), u, v)


def _upright_numbers(p: Floats) -> dict[str, float]:
    return {"sigma_across_px": math.exp(p[0]), "sigma_along_px": math.exp(p[1])}


def _round(p: Floats, u: Floats, v: Floats) -> Floats:
    """A Gaussian that is nearly round: of one width, a small difference, a small correlation."""
    return _gaussian(_nearly_round(p), u, v)


def _round_numbers(p: Floats) -> dict[str, float]:
    return _gaussian_numbers(_nearly_round(p))


def _nearly_round(p: Floats) -> Floats:
    return np.array([p[0] + p[1], p[0] - p[1], p[2]])


def _smear(p: Floats, u: Floats, v: Floats) -> Floats:
    return np.asarray(np.sinc(p[0] * u + p[1] * v))


def _upright_smear(p: Floats, u: Floats, v: Floats) -> Floats:
    """Smears along both axes of the image, by the logarithms of their lengths."""
    # A length of 0 is stationary: an expansion about it knows nothing of smears.
    return np.asarray(np.sinc(math.exp(p[0]) * u) * np.sinc(math.exp(p[1]) * v))


def _upright_smear_numbers(p: Floats) -> dict[str, float]:
    return {"smear_across_px": math.exp(p[0]), "smear_along_px": math.exp(p[1])}


def _smear_numbers(p: Floats) -> dict[str, float]:
    direction = math.degrees(math.atan2(p[1], p[0]))
    return {
        "smear_px": math.hypot(p[0], p[1]),
        "smear_direction_deg": wrap_axis(direction),
    }


def _logistic(x: float) -> float:
    return 1 / (1 + math.exp(-x))


def _halo(p: Floats, u: Floats, v: Floats) -> Floats:
    share, sigma = _logistic(p[0]), math.exp(p[1])
    halo = np.exp(-2 * (math.pi * sigma) ** 2 * (u**2 + v**2))
    return np.asarray(1 - share + share * halo)


def _halo_numbers(p: Floats) -> dict[str, float]:
    return {"halo_share": _logistic(p[0]), "halo_sigma_px": math.exp(p[1])}


def _trail(p: Floats, u: Floats, v: Floats) -> Complexes:
    across, along = 2j * math.pi * p[0] * u, 2j * math.pi * p[1] * v
    return np.asarray(np.exp(across + along) / ((1 + across) * (1 + along)))


def _trail_numbers(p: Floats) -> dict[str, float]:
    return {"trail_across_px": float(p[0]), "trail_along_px": float(p[1])}


def _taps(p: Floats) -> tuple[float, float]:
    """Outer taps of the kernel across and along with the opposite sign: 2/5 at most."""
    return 0.4 * math.tanh(p[0]), 0.4 * math.tanh(p[1])


def _sharpening(p: Floats, u: Floats, v: Floats) -> Floats:
    across, along = _taps(p)
    by_col = 1 + 2 * across * (1 - np.cos(2 * math.pi * u))
    return np.asarray(by_col * (1 + 2 * along * (1 - np.cos(2 * math.pi * v))))


def _sharpening_numbers(p: Floats) -> dict[str, float]:
    across, along = _taps(p)
    return {"sharpening_across": across, "sharpening_along": along}


def _mask(p: Floats) -> tuple[float, float]:
    """Gain (at most 2, as in use) and width of an unsharp mask."""
    return 2.0 * _logistic(p[0]), math.exp(p[1])


def _unsharp(p: Floats, u: Floats, v: Floats) -> Floats:
    gain, sigma = _mask(p)
    return np.asarray(1 + gain * (1 - np.exp(-2 * (math.pi * sigma) ** 2 * (u**2 + v**2))))


def _unsharp_numbers(p: Floats) -> dict[str, float]:
    gain, sigma = _mask(p)
    return {"unsharp_gain": gain, "unsharp_sigma_px": sigma}


def _aperture(p: Floats) -> tuple[float, float]:
    return math.exp(p[0]), 0.7 * _logistic(p[1])


def _diffraction(p: Floats, u: Floats, v: Floats) -> Floats:
    cutoff, obscuration = _aperture(p)
    return np.asarray(Diffraction(cutoff, obscuration=obscuration).otf(u, v))


def _diffraction_numbers(p: Floats) -> dict[str, float]:
    cutoff, obscuration = _aperture(p)
    return {"cutoff_cpp": cutoff, "obscuration": obscuration}


def _defocus(p: Floats, u: Floats, v: Floats) -> Floats:
    cutoff, obscuration = _aperture(p)
    return np.asarray(Defocus(_waves(p), cutoff, obscuration).otf(u, v))


def _waves(p: Floats) -> float:
    return math.tanh(p[2])


def _defocus_numbers(p: Floats) -> dict[str, float]:
    return {**_diffraction_numbers(p), "defocus_waves": abs(_waves(p))}


def _kernel(p: Floats, u: Floats, v: Floats) -> Floats:
    """An even kernel of 15 taps, the same in both axes: its outer taps are -p[0], -p[1], ..."""
    order = 2 * math.pi * np.arange(1, p.size + 1)

    def gain(freq: Floats) -> Floats:
        return np.asarray(1 + 2 * (1 - np.cos(np.outer(freq, order))) @ p)

    return gain(u) * gain(v)


def _kernel_numbers(p: Floats) -> dict[str, float]:
    return {f"tap_{k}": -float(tap) for k, tap in enumerate(p, 1)}


def _cubic(p: Floats) -> float:
    """Parameter of a cubic convolution, -1 to 0."""
    return -_logistic(p[0])


def _interpolation(p: Floats, u: Floats, v: Floats) -> Floats:
    return np.asarray(Resampling("cubic", _cubic(p)).otf(u, v))


def _interpolation_numbers(p: Floats) -> dict[str, float]:
    return {"cubic_a": _cubic(p)}


_SIGMA_MEAN, _SIGMA_STD = (math.log(0.4),), (0.7,)
_NEARLY_ROUND_STD = (0.03, 0.06)
"""No sensor is exactly round: half the logarithm of the ratio of its widths, and its correlation,
the same ellipse in any direction."""
_TAP_MEAN = (0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_TAP_STD = (0.5, 0.25, 0.12, 0.07, 0.05, 0.03, 0.02)

TERMS: dict[str, Term] = {
    "gaussian": Term(_gaussian, (*_SIGMA_MEAN * 2, 0.0), (*_SIGMA_STD * 2, 0.3), _gaussian_numbers),
    "upright gaussian": Term(_upright, _SIGMA_MEAN * 2, _SIGMA_STD * 2, _upright_numbers),
    "round gaussian": Term(
        _round, (*_SIGMA_MEAN, 0.0, 0.0), (*_SIGMA_STD, *_NEARLY_ROUND_STD), _round_numbers
    ),
    "smear": Term(_smear, (0.0, 0.0), (1.2, 1.2), _smear_numbers),
    "upright smear": Term(_upright_smear, (-0.4, -0.4), (0.8, 0.8), _upright_smear_numbers),
    "halo": Term(_halo, (-2.2, math.log(2.0)), (1.0, 0.5), _halo_numbers),
    "trail": Term(_trail, (0.0, 0.0), (0.4, 0.4), _trail_numbers),
    "sharpening": Term(_sharpening, (0.4, 0.4), (0.4, 0.4), _sharpening_numbers),
    "unsharp": Term(_unsharp, (-1.0, 0.0), (1.0, 0.3), _unsharp_numbers),
    "diffraction": Term(_diffraction, (math.log(1.3), -0.5), (0.4, 1.0), _diffraction_numbers),
    "defocus": Term(_defocus, (math.log(1.3), -0.5, 0.25), (0.4, 1.0, 0.15), _defocus_numbers),
    "kernel": Term(_kernel, _TAP_MEAN, _TAP_STD, _kernel_numbers),
    "interpolation": Term(_interpolation, (0.0,), (0.6,), _interpolation_numbers),
}
"""Terms by name. Priors: sigma .2 to .8 px, correlation .3, smear and halo of a pixel or two, taps
of up to a third, masks of a quarter to the whole of what is missing, a quarter of a wave of
defocus, kernels as those of Wiener filters, cubic convolutions of -.35 to -.65."""

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
        """Derivatives of the OTF by the parameters, (n, p), by central differences."""
        factors = self._factors(p)
        values = [factor(own, u_cpp, v_cpp) for factor, own in factors]
        columns = []
        for i, (factor, own) in enumerate(factors):
            others = _product(values[:i] + values[i + 1 :])
            for step in _STEP * np.eye(own.size):
                change = factor(own + step, u_cpp, v_cpp) - factor(own - step, u_cpp, v_cpp)
                columns.append(others * change / (2 * _STEP))
        return np.stack(columns, axis=1)

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

    def aligned(self) -> tuple[SensorForm, ...]:
        """The same along the axes of the image, its Gaussian elliptical or round."""
        first, *others = self.terms
        if first != "gaussian":
            return ()
        upright = ["upright smear" if one == "smear" else one for one in others]
        return tuple(
            replace(self, terms=(f"{kind} gaussian", *upright)) for kind in ("upright", "round")
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
)
"""Forms that are tried, the simplest first."""
