"""Blur made by the air, kept apart from that of the sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Transfer, require

__all__ = ["Aerosol", "Moffat", "Turbulence"]

_NO_FREQUENCY = 1e-8
"""Times 2 pi the width: below it nothing is lost."""


@dataclass(frozen=True)
class Aerosol:
    """Light scattered forward by aerosols, in the small-angle approximation.

    ``exp(-t (f / f_a)^2)`` below the cut-off f_a and ``exp(-t)`` above it (Kopeika, A System
    Engineering Approach to Imaging, 1998): sharp light that was not scattered, and a broad glow.

    Parameters
    ----------
    optical_depth : float
        Optical depth t of the forward scattering along the path, at least 0.
    cutoff_cpp : float
        Cut-off f_a (particle radius over wavelength, as an angular frequency) in cycles per
        pixel. The glow is about 1 / f_a wide; below some 0.005 it is wider than any target.
    """

    optical_depth: float
    cutoff_cpp: float

    def __post_init__(self) -> None:
        require(self, optical_depth=self.optical_depth)
        require(self, above=True, cutoff_cpp=self.cutoff_cpp)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        relative = np.minimum(np.hypot(u, v) / self.cutoff_cpp, 1.0)
        return np.exp(-self.optical_depth * relative**2)


@dataclass(frozen=True)
class Turbulence:
    """Long-exposure turbulence: ``exp(-3.44 (f / f_0)^(5/3))`` (Fried, JOSA 56, 1372, 1966).

    Parameters
    ----------
    fried_cpp : float
        f_0 = r0 / wavelength as an angular frequency, in cycles per pixel: multiply by the
        angle of a pixel seen from where the turbulence lies.
    """

    fried_cpp: float

    def __post_init__(self) -> None:
        require(self, above=True, fried_cpp=self.fried_cpp)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return np.exp(-3.44 * (np.hypot(u, v) / self.fried_cpp) ** (5 / 3))


@dataclass(frozen=True)
class Moffat:
    """A spot that falls like a power: ``(1 + (r / width)^2)^-exponent``, as images of stars.

    A. F. J. Moffat, Astron. Astrophys. 3, 455 (1969). Its transform in the plane is that of the
    Student distribution, ``2 (x / 2)^(b - 1) K_(b - 1)(x) / Gamma(b - 1)`` with ``x = 2 pi width
    f`` and K the modified Bessel function: a Gaussian for large exponents, `exp(-x)` at 1.5.

    Parameters
    ----------
    width_px : float
        Distance in pixels within which it is flat; full width at half maximum over
        ``2 sqrt(2^(1 / exponent) - 1)``.
    exponent : float, optional
        1.5 to 20; of turbulence 4.765, of stars through a telescope 2.5 to 4.
    """

    width_px: float
    exponent: float = 2.5

    def __post_init__(self) -> None:
        require(self, width_px=self.width_px)
        require(self, 1.5, 20.0, exponent=self.exponent)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        from scipy.special import gammaln, kve

        order = self.exponent - 1
        x = 2 * math.pi * self.width_px * np.hypot(u, v)
        seen = np.maximum(x, _NO_FREQUENCY)
        # K grows like x^-order and falls like exp(-x).
        power = math.log(2.0) - gammaln(order) + order * np.log(seen / 2) - seen
        return np.where(x < _NO_FREQUENCY, 1.0, np.exp(power) * kve(order, seen))
