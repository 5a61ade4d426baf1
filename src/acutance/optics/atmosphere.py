"""Blur made by the air, kept apart from that of the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Transfer, require

__all__ = ["Aerosol", "Turbulence"]


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
