"""A tail of light that falls like 1 / s^2 without end, as behind an aperture that diffracts.

Its LSF is the Lorentz curve of half width a, the PSF with that LSF falls like 1 / r^3, and the
transfer function is ``exp(-2 pi a |f|)`` in every direction.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["tail_esf", "tail_lsf", "tail_otf", "tail_psf"]


def tail_esf(s: Floats, half_width: float) -> Floats:
    """Edge spread function at normal distances `s`, of the same unit as the half width."""
    return np.asarray(np.arctan(s / half_width) / np.pi + 0.5)


def tail_lsf(s: Floats, half_width: float) -> Floats:
    """Line spread function at normal distances `s`."""
    return np.asarray(half_width / np.pi / (s * s + half_width**2))


def tail_psf(radius: Floats, half_width: float) -> Floats:
    """Point spread function at distances from its centre."""
    return np.asarray(half_width / (2 * np.pi) * (radius**2 + half_width**2) ** -1.5)


def tail_otf(freq: Floats, half_width: float) -> Floats:
    """Transfer function at the modulus of a frequency, in cycles per unit of the half width."""
    return np.asarray(np.exp(-2 * np.pi * half_width * freq))
