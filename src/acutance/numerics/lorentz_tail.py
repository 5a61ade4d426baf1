"""A tail of light that falls like 1 / s^2 without end, as behind an aperture that diffracts.

Its LSF is the Lorentz curve of half width a, the PSF with that LSF falls like 1 / r^3, and the
transfer function is ``exp(-2 pi a |f|)`` in every direction.
"""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.polynomial import interpolated, polynomial_value

__all__ = ["tail_esf", "tail_lsf", "tail_otf", "tail_psf", "tail_step"]


_ARCTANGENT = interpolated(lambda q: np.arctan(np.sqrt(q)) / np.sqrt(q), 0.0, 1.0, 16)
"""Of arctan(x) / x, in powers of x^2."""


def tail_esf(s: Floats, half_width: float) -> Floats:
    """Edge spread function at normal distances `s`, of the same unit as the half width."""
    return _along(s, half_width)[0]


def tail_lsf(s: Floats, half_width: float) -> Floats:
    """Line spread function at normal distances `s`."""
    return _along(s, half_width)[1]


def _along(s: Floats, half_width: float) -> tuple[Floats, Floats]:
    """Both spread functions at distances of any shape."""
    flat = np.ascontiguousarray(s, float).reshape(-1)
    esf, lsf = _tail_steps(flat, float(half_width)).reshape(2, *s.shape)
    return esf, lsf


@inlined
def tail_step(s: float, half_width: float) -> tuple[float, float]:
    """Edge and line spread function at one distance, for compiled loops."""
    u = s / half_width
    away = abs(u)
    near = 1 / away if away > 1 else away
    turn = near * polynomial_value(_ARCTANGENT, near * near)
    turn = 0.5 * math.pi - turn if away > 1 else turn
    return 0.5 + (turn if u > 0 else -turn) / math.pi, 1 / (math.pi * half_width * (1 + u * u))


@compiled
def _tail_steps(s: Floats, half_width: float) -> Floats:
    """`tail_step` at many distances, (2, n)."""
    found = np.empty((2, s.size))
    for k in range(s.size):
        found[0, k], found[1, k] = tail_step(s[k], half_width)
    return found


def tail_psf(radius: Floats, half_width: float) -> Floats:
    """Point spread function at distances from its centre."""
    return np.asarray(half_width / (2 * np.pi) * (radius**2 + half_width**2) ** -1.5)


def tail_otf(freq: Floats, half_width: float) -> Floats:
    """Transfer function at the modulus of a frequency, in cycles per unit of the half width."""
    return np.asarray(np.exp(-2 * np.pi * half_width * freq))
