"""Factors of parametric sensors over the plane of frequencies: Gaussian, smear, halo, ...

Each is centred, so that none moves the image. Parameters are unbounded numbers of order 1 with a
normal prior, as wide as the range of real sensors: it keeps a term that the data do not show from
running away. Those of several sensors are taken at once, (..., p), with an OTF for each, (..., n).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_axis
from acutance.optics.aperture import defocused_transfer
from acutance.targets.combine.aberration_term import ABERRATED, ASTIGMATIC, diffraction
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.processing_terms import PROCESSING_TERMS
from acutance.targets.combine.resampling_term import RESAMPLING
from acutance.targets.combine.term import Term, aperture, columns, logistic, logistic_slope

__all__ = ["TERMS", "upright_smear", "upright_smear_slopes"]

Complexes = NDArray[np.complex128]


def _blur_covariance(
    log_across: Floats, log_along: Floats, turned: Floats
) -> tuple[Floats, Floats, Floats]:
    """Variances across and along and covariance of the Gaussian, px^2."""
    across, along = np.exp(log_across), np.exp(log_along)
    return across**2, along**2, np.tanh(turned) * across * along


def _gaussian(p: Floats, plane: Plane) -> Floats:
    xx, yy, xy = _blur_covariance(*columns(p))
    u, v = plane.u_cpp, plane.v_cpp
    return np.asarray(np.exp(-2 * math.pi**2 * (xx * u**2 + 2 * xy * (u * v) + yy * v**2)))


def _gaussian_slopes(p: Floats, plane: Plane) -> Floats:
    log_across, log_along, turned = columns(p)
    xx, yy, xy = _blur_covariance(log_across, log_along, turned)
    u, v = plane.u_cpp, plane.v_cpp
    crossed = xy * (u * v)
    by_correlation = np.exp(log_across + log_along) / np.cosh(turned) ** 2 * (u * v)
    falls = np.stack([xx * u**2 + crossed, yy * v**2 + crossed, by_correlation], axis=-2)
    return np.asarray(-4 * math.pi**2 * _gaussian(p, plane)[..., None, :] * falls)


def _gaussian_numbers(p: Floats) -> dict[str, float]:
    xx, yy, xy = map(float, _blur_covariance(*p))
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
    return _gaussian(_not_turned(p), plane)


def _upright_slopes(p: Floats, plane: Plane) -> Floats:
    return _gaussian_slopes(_not_turned(p), plane)[..., :2, :]


def _not_turned(p: Floats) -> Floats:
    return np.concatenate([p, np.zeros_like(p[..., :1])], axis=-1)


def _upright_numbers(p: Floats) -> dict[str, float]:
    return {"sigma_across_px": math.exp(p[0]), "sigma_along_px": math.exp(p[1])}


def _round(p: Floats, plane: Plane) -> Floats:
    """A Gaussian that is nearly round: of one width, a small difference, a small correlation."""
    return _gaussian(_nearly_round(p), plane)


def _round_slopes(p: Floats, plane: Plane) -> Floats:
    slopes = _gaussian_slopes(_nearly_round(p), plane)
    across, along, correlation = (slopes[..., i, :] for i in range(3))
    return np.stack([across + along, across - along, correlation], axis=-2)


def _round_numbers(p: Floats) -> dict[str, float]:
    return _gaussian_numbers(_nearly_round(p))


def _nearly_round(p: Floats) -> Floats:
    width, difference, correlation = columns(p)
    return np.concatenate([width + difference, width - difference, correlation], axis=-1)


def _smear(p: Floats, plane: Plane) -> Floats:
    across, along = columns(p)
    return np.asarray(np.sinc(across * plane.u_cpp + along * plane.v_cpp))


def _sinc_growth(waves: Floats, sinc: Floats) -> Floats:
    """Derivative of ``sinc(x)`` by the logarithm of x, beside its values."""
    return np.asarray(np.cos(math.pi * waves) - sinc)


def upright_smear(p: Floats, plane: Plane) -> Floats:
    """Smears along both axes of the image, by the logarithms of their lengths."""
    # A length of 0 is stationary: an expansion about it knows nothing of smears.
    across, along = _smeared_waves(p, plane)
    return np.asarray(np.sinc(across) * np.sinc(along))


def upright_smear_slopes(p: Floats, plane: Plane) -> Floats:
    """Derivatives of `upright_smear`, (..., 2, n)."""
    across, along = _smeared_waves(p, plane)
    one, other = np.sinc(across), np.sinc(along)
    by_across = _sinc_growth(across, one) * other
    return np.stack([by_across, one * _sinc_growth(along, other)], axis=-2)


def _smeared_waves(p: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """Cycles over a smear, across and along."""
    across, along = columns(np.exp(p))
    return across * plane.u_cpp, along * plane.v_cpp


def _upright_smear_numbers(p: Floats) -> dict[str, float]:
    return {"smear_across_px": math.exp(p[0]), "smear_along_px": math.exp(p[1])}


def _smear_numbers(p: Floats) -> dict[str, float]:
    direction = math.degrees(math.atan2(p[1], p[0]))
    return {
        "smear_px": math.hypot(p[0], p[1]),
        "smear_direction_deg": wrap_axis(direction),
    }


def _halo(p: Floats, plane: Plane) -> Floats:
    share = logistic(p[..., :1])
    return np.asarray(1 - share + share * _scattered(p, plane)[0])


def _halo_slopes(p: Floats, plane: Plane) -> Floats:
    values, by_width, by_taper = _scattered(p, plane)
    share = logistic(p[..., :1])
    by_share = logistic_slope(p[..., :1]) * (values - 1)
    return np.stack([by_share, share * by_width, share * by_taper], axis=-2)


def _scattered(p: Floats, plane: Plane) -> tuple[Floats, Floats, Floats]:
    """OTF of scattered light, and its derivatives by the parameters of width and taper.

    ``(1 + t x) ** (-1 / t)`` with x half the square of the standard deviation times the frequency
    in radians: a Gaussian at a taper t of 0, an exponential in the plane at 2/3.
    """
    _, log_sigma, logit = columns(p)
    taper = logistic(logit)
    half_square = 0.5 * (np.exp(log_sigma) * plane.waves) ** 2
    grown = 1 + taper * half_square
    log_values = -np.log1p(taper * half_square) / taper
    values = np.exp(log_values)
    by_width = -2 * half_square / grown * values
    by_taper = -(log_values + half_square / grown) / taper * values * logistic_slope(logit)
    return values, by_width, by_taper


def _halo_numbers(p: Floats) -> dict[str, float]:
    return {
        "halo_share": float(logistic(p[0])),
        "halo_sigma_px": math.exp(p[1]),
        "halo_taper": float(logistic(p[2])),
    }


def _trail(p: Floats, plane: Plane) -> Complexes:
    length_across, length_along = columns(2 * math.pi * p)
    across, along = 1j * length_across * plane.u_cpp, 1j * length_along * plane.v_cpp
    return np.asarray(np.exp(across + along) / ((1 + across) * (1 + along)))


def _trail_numbers(p: Floats) -> dict[str, float]:
    return {"trail_across_px": float(p[0]), "trail_along_px": float(p[1])}


def _diffraction_numbers(p: Floats) -> dict[str, float]:
    cutoff, obscuration = aperture(p[0], p[1])
    return {"cutoff_cpp": float(cutoff), "obscuration": float(obscuration)}


def _defocus(p: Floats, plane: Plane) -> Floats:
    """Once for every distance from zero frequency."""
    freq, where = plane.rings
    log_cutoff, logit, waves = columns(p)
    cutoff, obscuration = aperture(log_cutoff, logit)
    return defocused_transfer(freq / cutoff, np.tanh(waves), obscuration)[..., where]


def _defocus_numbers(p: Floats) -> dict[str, float]:
    return {**_diffraction_numbers(p), "defocus_waves": abs(math.tanh(p[2]))}


_SIGMA_MEAN, _SIGMA_STD = (math.log(0.4),), (0.7,)
_NEARLY_ROUND_STD = (0.03, 0.06)
"""No sensor is exactly round: half the logarithm of the ratio of its widths, and its correlation,
the same ellipse in any direction."""
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
    "smear": Term(_smear, (0.0, 0.0), (1.2, 1.2), _smear_numbers, signed=(0, 1)),
    "upright smear": Term(
        upright_smear, (-0.4, -0.4), (0.8, 0.8), _upright_smear_numbers, upright_smear_slopes
    ),
    "halo": Term(_halo, (-2.5, math.log(3.0), -0.5), (0.7, 0.4, 1.5), _halo_numbers, _halo_slopes),
    "close halo": Term(
        _halo, (0.5, math.log(0.6), 0.5), (1.5, 0.6, 1.5), _halo_numbers, _halo_slopes
    ),
    "trail": Term(_trail, (0.0, 0.0), (0.4, 0.4), _trail_numbers),
    "diffraction": Term(diffraction, (math.log(1.3), -0.5), (0.4, 1.0), _diffraction_numbers),
    "defocus": Term(_defocus, (math.log(1.3), -0.5, 0.25), (0.4, 1.0, 0.15), _defocus_numbers),
    "aberrated": ABERRATED,
    "astigmatism": ASTIGMATIC,
    "resampling": RESAMPLING,
    **PROCESSING_TERMS,
}
"""Terms by name. Priors: sigma .2 to .8 px, correlation .3, smear of a pixel or two, halos as of
`acutance.optics.FAMILIES` and somewhat more (2 to 25 % of the light, 1.5 to 6 px, falling like a
Gaussian or like an exponential), next to the core of any share and of .3 to 1.1 px, a quarter of a
wave of defocus."""
