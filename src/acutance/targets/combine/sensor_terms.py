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
from acutance.optics import Defocus, Diffraction
from acutance.optics.processing import interpolation_weight
from acutance.targets.combine.plane import PIXELS, TAPS, Plane

__all__ = ["TERMS", "Term", "Transfer", "sinc_growth"]

Complexes = NDArray[np.complex128]
Transfer = Callable[[Floats, Plane], NDArray[Any]]
"""Optical transfer function (OTF), (n,), by parameters and places of the plane."""


@dataclass(frozen=True)
class Term:
    """One factor of a parametric OTF.

    Parameters
    ----------
    otf : function of (parameters, plane)
        1 at zero frequency.
    mean, std : tuple of float
        Prior mean and standard deviation of the parameters.
    numbers : function of parameters
        The reported numbers, by name with the unit.
    slopes : function of (parameters, plane), optional
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


def _gaussian(p: Floats, plane: Plane) -> Floats:
    xx, yy, xy = _blur_covariance(p)
    u, v = plane.u_cpp, plane.v_cpp
    return np.asarray(np.exp(-2 * math.pi**2 * (xx * u**2 + 2 * xy * u * v + yy * v**2)))


def _gaussian_slopes(p: Floats, plane: Plane) -> Floats:
    xx, yy, xy = _blur_covariance(p)
    u, v = plane.u_cpp, plane.v_cpp
    crossed = xy * u * v
    by_correlation = math.exp(p[0] + p[1]) / math.cosh(p[2]) ** 2 * u * v
    falls = np.stack([xx * u**2 + crossed, yy * v**2 + crossed, by_correlation], axis=1)
    return np.asarray(-4 * math.pi**2 * _gaussian(p, plane)[:, None] * falls)


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


def _upright(p: Floats, plane: Plane) -> Floats:
    """A Gaussian whose axes are those of the image."""
    return _gaussian(np.append(p, 0.0), plane)


def _upright_slopes(p: Floats, plane: Plane) -> Floats:
    return _gaussian_slopes(np.append(p, 0.0), plane)[:, :2]


def _upright_numbers(p: Floats) -> dict[str, float]:
    return {"sigma_across_px": math.exp(p[0]), "sigma_along_px": math.exp(p[1])}


def _round(p: Floats, plane: Plane) -> Floats:
    """A Gaussian that is nearly round: of one width, a small difference, a small correlation."""
    return _gaussian(_nearly_round(p), plane)


def _round_slopes(p: Floats, plane: Plane) -> Floats:
    across, along, correlation = _gaussian_slopes(_nearly_round(p), plane).T
    return np.stack([across + along, across - along, correlation], axis=1)


def _round_numbers(p: Floats) -> dict[str, float]:
    return _gaussian_numbers(_nearly_round(p))


def _nearly_round(p: Floats) -> Floats:
    return np.array([p[0] + p[1], p[0] - p[1], p[2]])


def _smear(p: Floats, plane: Plane) -> Floats:
    return np.asarray(np.sinc(p[0] * plane.u_cpp + p[1] * plane.v_cpp))


def sinc_growth(waves: Floats, sinc: Floats) -> Floats:
    """Derivative of ``sinc(x)`` by the logarithm of x, beside its values."""
    return np.asarray(np.cos(math.pi * waves) - sinc)


def _upright_smear(p: Floats, plane: Plane) -> Floats:
    """Smears along both axes of the image, by the logarithms of their lengths."""
    # A length of 0 is stationary: an expansion about it knows nothing of smears.
    across, along = math.exp(p[0]) * plane.u_cpp, math.exp(p[1]) * plane.v_cpp
    return np.asarray(np.sinc(across) * np.sinc(along))


def _upright_smear_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = math.exp(p[0]) * plane.u_cpp, math.exp(p[1]) * plane.v_cpp
    one, other = np.sinc(across), np.sinc(along)
    by_across = sinc_growth(across, one) * other
    return np.stack([by_across, one * sinc_growth(along, other)], axis=1)


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


def _logistic_slope(x: float) -> float:
    return _logistic(x) * _logistic(-x)


def _wide(sigma_px: float, plane: Plane) -> tuple[Floats, Floats]:
    """A round Gaussian, and its derivative by the logarithm of its width."""
    square = (math.pi * sigma_px) ** 2 * (plane.u_cpp**2 + plane.v_cpp**2)
    values = np.exp(-2 * square)
    return values, -4 * square * values


def _halo(p: Floats, plane: Plane) -> Floats:
    share = _logistic(p[0])
    return np.asarray(1 - share + share * _wide(math.exp(p[1]), plane)[0])


def _halo_slopes(p: Floats, plane: Plane) -> Floats:
    halo, by_width = _wide(math.exp(p[1]), plane)
    return np.stack([_logistic_slope(p[0]) * (halo - 1), _logistic(p[0]) * by_width], axis=1)


def _halo_numbers(p: Floats) -> dict[str, float]:
    return {"halo_share": _logistic(p[0]), "halo_sigma_px": math.exp(p[1])}


def _trail(p: Floats, plane: Plane) -> Complexes:
    across, along = 2j * math.pi * p[0] * plane.u_cpp, 2j * math.pi * p[1] * plane.v_cpp
    return np.asarray(np.exp(across + along) / ((1 + across) * (1 + along)))


def _trail_numbers(p: Floats) -> dict[str, float]:
    return {"trail_across_px": float(p[0]), "trail_along_px": float(p[1])}


def _taps(p: Floats) -> tuple[float, float]:
    """Outer taps of the kernel across and along with the opposite sign: 2/5 at most."""
    return 0.4 * math.tanh(p[0]), 0.4 * math.tanh(p[1])


def _sharpening(p: Floats, plane: Plane) -> Floats:
    across, along = _taps(p)
    by_col, by_row = (gains[:, 0] for gains in plane.tap_gains)
    return np.asarray((1 + across * by_col) * (1 + along * by_row))


def _sharpening_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = _taps(p)
    by_col, by_row = (gains[:, 0] for gains in plane.tap_gains)
    both = np.stack([by_col * (1 + along * by_row), by_row * (1 + across * by_col)], axis=1)
    return np.asarray(0.4 / np.cosh(p) ** 2 * both)


def _sharpening_numbers(p: Floats) -> dict[str, float]:
    across, along = _taps(p)
    return {"sharpening_across": across, "sharpening_along": along}


def _mask(p: Floats) -> tuple[float, float]:
    """Gain (at most 2, as in use) and width of an unsharp mask."""
    return 2.0 * _logistic(p[0]), math.exp(p[1])


def _unsharp(p: Floats, plane: Plane) -> Floats:
    gain, sigma = _mask(p)
    return np.asarray(1 + gain * (1 - _wide(sigma, plane)[0]))


def _unsharp_slopes(p: Floats, plane: Plane) -> Floats:
    gain, sigma = _mask(p)
    blurred, by_width = _wide(sigma, plane)
    return np.stack([2 * _logistic_slope(p[0]) * (1 - blurred), -gain * by_width], axis=1)


def _unsharp_numbers(p: Floats) -> dict[str, float]:
    gain, sigma = _mask(p)
    return {"unsharp_gain": gain, "unsharp_sigma_px": sigma}


def _aperture(p: Floats) -> tuple[float, float]:
    return math.exp(p[0]), 0.7 * _logistic(p[1])


def _diffraction(p: Floats, plane: Plane) -> Floats:
    """Once for every distance from zero frequency."""
    freq, where = plane.rings
    cutoff, obscuration = _aperture(p)
    otf = Diffraction(cutoff, obscuration=obscuration).otf(freq, np.zeros(freq.size))
    return np.asarray(np.asarray(otf)[where])


def _diffraction_numbers(p: Floats) -> dict[str, float]:
    cutoff, obscuration = _aperture(p)
    return {"cutoff_cpp": cutoff, "obscuration": obscuration}


def _defocus(p: Floats, plane: Plane) -> Floats:
    """Once for every distance from zero frequency."""
    freq, where = plane.rings
    cutoff, obscuration = _aperture(p)
    otf = Defocus(_waves(p), cutoff, obscuration).otf(freq, np.zeros(freq.size))
    return np.asarray(np.asarray(otf)[where])


def _waves(p: Floats) -> float:
    return math.tanh(p[2])


def _defocus_numbers(p: Floats) -> dict[str, float]:
    return {**_diffraction_numbers(p), "defocus_waves": abs(_waves(p))}


def _kernel(p: Floats, plane: Plane) -> Floats:
    """An even kernel of 15 taps, the same in both axes: its outer taps are -p[0], -p[1], ..."""
    across, along = plane.tap_gains
    return np.asarray((1 + across @ p) * (1 + along @ p))


def _kernel_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = plane.tap_gains
    return np.asarray(across * (1 + along @ p)[:, None] + along * (1 + across @ p)[:, None])


def _kernel_numbers(p: Floats) -> dict[str, float]:
    return {f"tap_{k}": -float(tap) for k, tap in enumerate(p, 1)}


def _cubic(p: Floats) -> float:
    """Parameter of a cubic convolution, -1 to 0."""
    return -_logistic(p[0])


def _interpolation(p: Floats, plane: Plane) -> Floats:
    at_none, by_unit = plane.cubic_parts
    return np.asarray(np.prod(at_none + _cubic(p) * by_unit, axis=1))


def _interpolation_slopes(p: Floats, plane: Plane) -> Floats:
    at_none, by_unit = plane.cubic_parts
    across, along = (at_none + _cubic(p) * by_unit).T
    by_parameter = by_unit[:, 0] * along + across * by_unit[:, 1]
    return np.asarray(-_logistic_slope(p[0]) * by_parameter[:, None])


def _interpolation_numbers(p: Floats) -> dict[str, float]:
    return {"cubic_a": _cubic(p)}


def _phases(p: Floats) -> tuple[float, float]:
    """Sub-pixel places of interpolation across and along: equally likely from -1/2 to 1/2."""
    return 0.5 * math.erf(p[0] * math.sqrt(0.5)), 0.5 * math.erf(p[1] * math.sqrt(0.5))


def _phase(p: Floats, plane: Plane) -> Complexes:
    """Cubic convolution at one phase of the pixels, as in a small part of a warped image."""
    across, along = _phases(p)
    by_col, by_row = plane.pixel_waves
    a = _cubic(p[2:])
    return _at_phase(across, a, plane.u_cpp, by_col) * _at_phase(along, a, plane.v_cpp, by_row)


def _at_phase(phase_px: float, a: float, freq: Floats, pixel_waves: Complexes) -> Complexes:
    """Along one axis; the mean place of the light is taken off.

    Cubic convolution moves the image: only that of a = -1/2 keeps straight lines.
    """
    away_px = PIXELS - phase_px
    weight = interpolation_weight("cubic", away_px, a)
    middle_px = phase_px + float(away_px @ weight)
    return np.asarray((pixel_waves @ weight) * np.exp(-2j * math.pi * middle_px * freq))


def _phase_numbers(p: Floats) -> dict[str, float]:
    across, along = _phases(p)
    return {"phase_across_px": across, "phase_along_px": along, "cubic_a": _cubic(p[2:])}


_SIGMA_MEAN, _SIGMA_STD = (math.log(0.4),), (0.7,)
_NEARLY_ROUND_STD = (0.03, 0.06)
"""No sensor is exactly round: half the logarithm of the ratio of its widths, and its correlation,
the same ellipse in any direction."""
_TAP_MEAN = (0.4, *((TAPS - 1) * [0.0]))
_TAP_STD = (0.5, 0.25, 0.12, 0.07, 0.05, 0.03, 0.02)

TERMS: dict[str, Term] = {
    "gaussian": Term(
        _gaussian,
        (*_SIGMA_MEAN * 2, 0.0),
        (*_SIGMA_STD * 2, 0.3),
        _gaussian_numbers,
        _gaussian_slopes,
    ),
    "upright gaussian": Term(
        _upright, _SIGMA_MEAN * 2, _SIGMA_STD * 2, _upright_numbers, _upright_slopes
    ),
    "round gaussian": Term(
        _round,
        (*_SIGMA_MEAN, 0.0, 0.0),
        (*_SIGMA_STD, *_NEARLY_ROUND_STD),
        _round_numbers,
        _round_slopes,
    ),
    "smear": Term(_smear, (0.0, 0.0), (1.2, 1.2), _smear_numbers),
    "upright smear": Term(
        _upright_smear, (-0.4, -0.4), (0.8, 0.8), _upright_smear_numbers, _upright_smear_slopes
    ),
    "halo": Term(_halo, (-2.5, math.log(3.0)), (0.7, 0.4), _halo_numbers, _halo_slopes),
    "trail": Term(_trail, (0.0, 0.0), (0.4, 0.4), _trail_numbers),
    "sharpening": Term(
        _sharpening, (0.4, 0.4), (0.4, 0.4), _sharpening_numbers, _sharpening_slopes
    ),
    "unsharp": Term(_unsharp, (-1.0, 0.0), (1.0, 0.3), _unsharp_numbers, _unsharp_slopes),
    "diffraction": Term(_diffraction, (math.log(1.3), -0.5), (0.4, 1.0), _diffraction_numbers),
    "defocus": Term(_defocus, (math.log(1.3), -0.5, 0.25), (0.4, 1.0, 0.15), _defocus_numbers),
    "kernel": Term(_kernel, _TAP_MEAN, _TAP_STD, _kernel_numbers, _kernel_slopes),
    "interpolation": Term(
        _interpolation, (0.0,), (0.6,), _interpolation_numbers, _interpolation_slopes
    ),
    "phase": Term(_phase, (0.0, 0.0, 0.0), (1.0, 1.0, 0.6), _phase_numbers),
}
"""Terms by name. Priors: sigma .2 to .8 px, correlation .3, smear of a pixel or two, halos as of
`acutance.optics.FAMILIES` and somewhat more (2 to 25 % of the light, 1.5 to 6 px), taps of up to a
third, masks of a quarter to the whole of what is missing, a quarter of a wave of defocus, kernels
as those of Wiener filters, cubic convolutions of -.35 to -.65."""
