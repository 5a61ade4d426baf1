"""Factors of parametric sensors over the plane of frequencies: Gaussian, smear, halo, ...

Each is centred, so that none moves the image. Parameters are unbounded numbers of order 1 with a
normal prior, as wide as the range of real sensors: it keeps a term that the data do not show from
running away.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_axis
from acutance.optics import Defocus, Diffraction, Resampling, Shift
from acutance.optics.processing import interpolation_weight

__all__ = ["TERMS", "Term", "Transfer"]

Complexes = NDArray[np.complex128]
Transfer = Callable[[Floats, Floats, Floats], NDArray[Any]]
"""Optical transfer function (OTF), (n,), by parameters and frequencies in cycles per pixel."""

_DIGITS = 12
"""Of a frequency: those of slices in different directions differ in the last ones."""


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
    slopes : function of (parameters, u, v), optional
        Derivatives of the OTF by the parameters, (n, p), in closed form.
    """

    otf: Transfer
    mean: tuple[float, ...]
    std: tuple[float, ...]
    numbers: Callable[[Floats], dict[str, float]]
    slopes: Transfer | None = None


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
    """Once for every distance from zero frequency: slices in all directions share theirs."""
    freq, where = np.unique(np.round(np.hypot(u, v), _DIGITS), return_inverse=True)
    cutoff, obscuration = _aperture(p)
    otf = Defocus(_waves(p), cutoff, obscuration).otf(np.asarray(freq), np.zeros(freq.size))
    return np.asarray(otf[where])


def _waves(p: Floats) -> float:
    return math.tanh(p[2])


def _defocus_numbers(p: Floats) -> dict[str, float]:
    return {**_diffraction_numbers(p), "defocus_waves": abs(_waves(p))}


def _kernel(p: Floats, u: Floats, v: Floats) -> Floats:
    """An even kernel of 15 taps, the same in both axes: its outer taps are -p[0], -p[1], ..."""
    return np.asarray((1 + _tap_gains(p.size, u) @ p) * (1 + _tap_gains(p.size, v) @ p))


def _kernel_slopes(p: Floats, u: Floats, v: Floats) -> Floats:
    across, along = _tap_gains(p.size, u), _tap_gains(p.size, v)
    return np.asarray(across * (1 + along @ p)[:, None] + along * (1 + across @ p)[:, None])


def _tap_gains(count: int, freq: Floats) -> Floats:
    """What a unit of every outer tap adds to the gain along an axis, (n, count)."""
    return np.asarray(2 - 2 * np.cos(2 * math.pi * np.outer(freq, np.arange(1, count + 1))))


def _kernel_numbers(p: Floats) -> dict[str, float]:
    return {f"tap_{k}": -float(tap) for k, tap in enumerate(p, 1)}


def _cubic(p: Floats) -> float:
    """Parameter of a cubic convolution, -1 to 0."""
    return -_logistic(p[0])


def _interpolation(p: Floats, u: Floats, v: Floats) -> Floats:
    return np.asarray(Resampling("cubic", _cubic(p)).otf(u, v))


def _interpolation_numbers(p: Floats) -> dict[str, float]:
    return {"cubic_a": _cubic(p)}


def _phases(p: Floats) -> tuple[float, float]:
    """Sub-pixel places of interpolation across and along: equally likely from -1/2 to 1/2."""
    return 0.5 * math.erf(p[0] * math.sqrt(0.5)), 0.5 * math.erf(p[1] * math.sqrt(0.5))


def _phase(p: Floats, u: Floats, v: Floats) -> Complexes:
    """Cubic convolution at one phase of the pixels, as in a small part of a warped image."""
    across, along = _phases(p)
    otf = Shift(along, across, "cubic", _cubic(p[2:])).otf(u, v)
    moved_px = u * _moved_px(across, _cubic(p[2:])) + v * _moved_px(along, _cubic(p[2:]))
    return np.asarray(otf * np.exp(-2j * math.pi * moved_px))


def _moved_px(phase_px: float, a: float) -> float:
    """How far cubic convolution moves the image: only that of a = -1/2 keeps straight lines."""
    away_px = np.arange(-2, 3) - phase_px
    return float(away_px @ interpolation_weight("cubic", away_px, a))


def _phase_numbers(p: Floats) -> dict[str, float]:
    across, along = _phases(p)
    return {"phase_across_px": across, "phase_along_px": along, "cubic_a": _cubic(p[2:])}


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
    "kernel": Term(_kernel, _TAP_MEAN, _TAP_STD, _kernel_numbers, _kernel_slopes),
    "interpolation": Term(_interpolation, (0.0,), (0.6,), _interpolation_numbers),
    "phase": Term(_phase, (0.0, 0.0, 0.0), (1.0, 1.0, 0.6), _phase_numbers),
}
"""Terms by name. Priors: sigma .2 to .8 px, correlation .3, smear and halo of a pixel or two, taps
of up to a third, masks of a quarter to the whole of what is missing, a quarter of a wave of
defocus, kernels as those of Wiener filters, cubic convolutions of -.35 to -.65."""
