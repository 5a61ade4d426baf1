"""What ground processing does to a parametric sensor: kernels, masks, interpolation.

Parameters are those of `acutance.targets.combine.sensor_terms`: unbounded, with a normal prior, of
several sensors at once.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.optics.interpolation import cubic_convolution_weight
from acutance.targets.combine.plane import PIXELS, TAPS, Plane
from acutance.targets.combine.term import Term, columns, logistic, logistic_slope

__all__ = ["PROCESSING_TERMS"]

Complexes = NDArray[np.complex128]


def _taps(log_size: Floats, log_ratio: Floats) -> tuple[Floats, Floats]:
    """Outer taps of the kernel across and along with the opposite sign, by their logarithms."""
    return np.exp(log_size + log_ratio), np.exp(log_size - log_ratio)


def _tap_parts(p: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """What the outer taps add to the gain across and along."""
    across, along = _taps(*columns(p))
    by_col, by_row = (gains[:, 0] for gains in plane.tap_gains)
    return across * by_col, along * by_row


def _sharpening(p: Floats, plane: Plane) -> Floats:
    across, along = _tap_parts(p, plane)
    return np.asarray((1 + across) * (1 + along))


def _sharpening_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = _tap_parts(p, plane)
    one, other = across * (1 + along), along * (1 + across)
    return np.stack([one + other, one - other], axis=-2)


def _sharpening_numbers(p: Floats) -> dict[str, float]:
    across, along = _taps(p[0], p[1])
    return {"sharpening_across": float(across), "sharpening_along": float(along)}


def _square_parts(plane: Plane) -> Floats:
    """What four side taps and four corner taps of a kernel of 3 x 3 add, of -1 each, (2, n)."""
    by_col, by_row = (gains[:, 0] for gains in plane.tap_gains)
    sides = by_col + by_row
    return np.stack([sides, 2 * sides - by_col * by_row])


def _square_kernel(p: Floats, plane: Plane) -> Floats:
    """Any kernel of 3 x 3 taps with the symmetry of the grid: sharpening, a box's unsharp mask."""
    return np.asarray(1 + p @ _square_parts(plane))


def _square_kernel_slopes(p: Floats, plane: Plane) -> Floats:
    parts = _square_parts(plane)
    return np.broadcast_to(parts, (*p.shape[:-1], *parts.shape))


def _square_kernel_numbers(p: Floats) -> dict[str, float]:
    return {"side_tap": -float(p[0]), "corner_tap": -float(p[1])}


def _mask(logit: Floats, log_sigma: Floats) -> tuple[Floats, Floats]:
    """Gain (at most 2, as in use) and width of an unsharp mask."""
    return 2.0 * logistic(logit), np.exp(log_sigma)


def _unsharp(p: Floats, plane: Plane) -> Floats:
    gain, sigma = _mask(*columns(p))
    return np.asarray(1 + gain * (1 - _wide_gaussian(sigma, plane)[0]))


def _unsharp_slopes(p: Floats, plane: Plane) -> Floats:
    gain, sigma = _mask(*columns(p))
    blurred, by_width = _wide_gaussian(sigma, plane)
    by_gain = 2 * logistic_slope(p[..., :1]) * (1 - blurred)
    return np.stack([by_gain, -gain * by_width], axis=-2)


def _wide_gaussian(sigma_px: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """A round Gaussian, and its derivative by the logarithm of its width."""
    square = (math.pi * sigma_px) ** 2 * (plane.u_cpp**2 + plane.v_cpp**2)
    values = np.exp(-2 * square)
    return values, -4 * square * values


def _unsharp_numbers(p: Floats) -> dict[str, float]:
    gain, sigma = _mask(p[0], p[1])
    return {"unsharp_gain": float(gain), "unsharp_sigma_px": float(sigma)}


def _kernel(p: Floats, plane: Plane) -> Floats:
    """An even kernel of 15 taps, the same in both axes: its outer taps are -p[0], -p[1], ..."""
    across, along = plane.tap_gains
    return np.asarray((1 + p @ across.T) * (1 + p @ along.T))


def _kernel_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = plane.tap_gains
    one, other = (1 + p @ across.T)[..., None, :], (1 + p @ along.T)[..., None, :]
    return np.asarray(across.T * other + along.T * one)


def _kernel_numbers(p: Floats) -> dict[str, float]:
    return {f"tap_{k}": -float(tap) for k, tap in enumerate(p, 1)}


def _short_taps(p: Floats) -> Floats:
    """All taps of a kernel of seven, by standard normal parameters: its tap k is -p[k]."""
    longer = np.zeros((*p.shape[:-1], TAPS - _SHORT_MEAN.size))
    return np.concatenate([_SHORT_MEAN + p @ _SHORT_ROOT.T, longer], axis=-1)


def _short_kernel(p: Floats, plane: Plane) -> Floats:
    return _kernel(_short_taps(p), plane)


def _short_kernel_slopes(p: Floats, plane: Plane) -> Floats:
    by_tap = _kernel_slopes(_short_taps(p), plane)
    return np.asarray(_SHORT_ROOT.T @ by_tap[..., : _SHORT_MEAN.size, :])


def _short_kernel_numbers(p: Floats) -> dict[str, float]:
    return _kernel_numbers(_short_taps(p)[: _SHORT_MEAN.size])


def _cubic(logit: Floats) -> Floats:
    """Parameter of a cubic convolution, -1 to 0."""
    return -logistic(logit)


def _cubic_parts(p: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """OTF of cubic convolution across and along."""
    (across, along), (by_across, by_along) = (part.T for part in plane.cubic_parts)
    return across + _cubic(p) * by_across, along + _cubic(p) * by_along


def _interpolation(p: Floats, plane: Plane) -> Floats:
    across, along = _cubic_parts(p, plane)
    return across * along


def _interpolation_slopes(p: Floats, plane: Plane) -> Floats:
    across, along = _cubic_parts(p, plane)
    by_across, by_along = plane.cubic_parts[1].T
    by_parameter = by_across * along + across * by_along
    return np.asarray(-logistic_slope(p) * by_parameter)[..., None, :]


def _interpolation_numbers(p: Floats) -> dict[str, float]:
    return {"cubic_a": float(_cubic(p[0]))}


def _sub_pixel(p: Floats) -> Floats:
    """Sub-pixel places of interpolation: equally likely from -1/2 to 1/2."""
    return np.asarray(ndtr(p) - 0.5)


def _phase(p: Floats, plane: Plane) -> Complexes:
    """Cubic convolution at one phase of the pixels, as in a small part of a warped image."""
    across, along, logit = columns(p)
    by_col, by_row = plane.pixel_waves
    a = _cubic(logit)
    return np.asarray(
        _at_phase(_sub_pixel(across), a, plane.u_cpp, by_col)
        * _at_phase(_sub_pixel(along), a, plane.v_cpp, by_row)
    )


def _at_phase(phase_px: Floats, a: Floats, freq: Floats, pixel_waves: Complexes) -> Complexes:
    """Along one axis; the mean place of the light is taken off.

    Cubic convolution moves the image: only that of a = -1/2 keeps straight lines.
    """
    away_px = PIXELS - phase_px
    weight = cubic_convolution_weight(away_px, a)
    middle_px = phase_px + np.sum(away_px * weight, axis=-1, keepdims=True)
    return np.asarray((weight @ pixel_waves.T) * np.exp(-2j * math.pi * middle_px * freq))


def _phase_numbers(p: Floats) -> dict[str, float]:
    across, along = map(float, _sub_pixel(p[:2]))
    return {"phase_across_px": across, "phase_along_px": along, "cubic_a": float(_cubic(p[2]))}


_TAP_MEAN = (0.4, *((TAPS - 1) * [0.0]))
_TAP_STD = (0.5, 0.25, 0.12, 0.07, 0.05, 0.03, 0.02)
_SHORT_MEAN: Floats = np.array([0.2, 0.0, 0.0])
_SHORT_ROOT: Floats = np.array([[0.32, 0.0, 0.0], [-0.12, 0.09, 0.0], [0.025, -0.035, 0.04]])
"""Mean and factor of the covariance of the taps of seven in ten of the Wiener kernels of
`acutance.optics.FAMILIES`: their taps alternate, and fall by half to a third from one to the next.
The others are held by `_TAP_STD`; two normal densities fitted to 2587 kernels."""

PROCESSING_TERMS: dict[str, Term] = {
    "sharpening": Term(
        _sharpening, (math.log(0.2), 0.0), (0.8, 0.1), _sharpening_numbers, _sharpening_slopes
    ),
    "unsharp": Term(_unsharp, (-1.0, 0.0), (1.0, 0.3), _unsharp_numbers, _unsharp_slopes),
    "square kernel": Term(
        _square_kernel, (0.15, 0.05), (0.2, 0.1), _square_kernel_numbers, _square_kernel_slopes
    ),
    "kernel": Term(_kernel, _TAP_MEAN, _TAP_STD, _kernel_numbers, _kernel_slopes),
    "short kernel": Term(
        _short_kernel, (0.0,) * 3, (1.0,) * 3, _short_kernel_numbers, _short_kernel_slopes
    ),
    "interpolation": Term(
        _interpolation, (0.0,), (0.6,), _interpolation_numbers, _interpolation_slopes
    ),
    "phase": Term(_phase, (0.0, 0.0, 0.0), (1.0, 1.0, 0.6), _phase_numbers),
}
"""Terms by name. Priors: outer taps of .05 to .8, nearly the same across and along, masks of a
quarter to the whole of what is missing, 3 x 3 kernels as in use for sharpening, kernels as those of
Wiener filters, cubic convolutions of -.35 to -.65."""
