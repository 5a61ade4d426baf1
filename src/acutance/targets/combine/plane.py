"""Places of the plane of frequencies, and what terms of sensors ask of them again and again."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.optics import Resampling

__all__ = ["PIXELS", "PROCESS_PLACES", "TAPS", "Plane"]

Complexes = NDArray[np.complex128]

TAPS = 7
"""Outer taps on either side of the kernels."""
PIXELS: Floats = np.arange(-2.0, 3.0)
"""Pixels of which cubic convolution at less than half a pixel from one makes a value."""
PROCESS_PLACES: Floats = np.array([
    (radius * math.cos(math.pi * k / count), radius * math.sin(math.pi * k / count))
    for radius, count in ((0.10, 3), (0.25, 4), (0.40, 6), (0.55, 8), (0.75, 8))
    for k in range(count)
])  # fmt: skip
"""Places on half of the plane whose values make a smooth function, (m, 2), cycles per pixel."""
_PROCESS_CPP = 0.25
"""Length over which it varies."""
_DIGITS = 12
"""Of a frequency: those of slices in different directions differ in the last ones."""


@dataclass(frozen=True, eq=False)
class Plane:
    """Places of the plane of frequencies.

    Parameters
    ----------
    u_cpp, v_cpp : (n,) array
        Frequencies across and along, cycles per pixel.
    """

    u_cpp: Floats
    v_cpp: Floats

    @cached_property
    def rings(self) -> tuple[Floats, NDArray[np.intp]]:
        """Distances from zero frequency, each once, (r,), and which is that of every place, (n,).

        Slices in all directions share theirs.
        """
        distance = np.round(np.hypot(self.u_cpp, self.v_cpp), _DIGITS)
        freq, where = np.unique(distance, return_inverse=True)
        return np.asarray(freq), where

    @cached_property
    def waves(self) -> Floats:
        """Distance of every place from zero frequency, radians per pixel, (n,)."""
        return np.asarray(2 * math.pi * np.hypot(self.u_cpp, self.v_cpp))

    @cached_property
    def along(self) -> Floats:
        """Unit vectors towards the places, (2, n); none at zero frequency."""
        places = np.stack([self.u_cpp, self.v_cpp])
        return np.asarray(places / np.maximum(np.hypot(*places), 1e-12))

    @cached_property
    def twice(self) -> Floats:
        """Unit vectors of twice their angle, (2, n)."""
        across, along = self.along
        return np.stack([across**2 - along**2, 2 * across * along])

    @cached_property
    def tap_gains(self) -> tuple[Floats, Floats]:
        """What a unit of every outer tap adds to the gain across and along, (n, taps) each."""
        return _tap_gains(self.u_cpp), _tap_gains(self.v_cpp)

    @cached_property
    def cubic_parts(self) -> tuple[Floats, Floats]:
        """OTF of cubic convolution of parameter 0 across and along, and what a unit adds, (n, 2).

        Its kernel is linear in the parameter.
        """
        still = np.zeros_like(self.u_cpp)
        at_none, at_less = (
            np.stack([cubic.otf(self.u_cpp, still), cubic.otf(still, self.v_cpp)], axis=1)
            for cubic in (Resampling("cubic", 0.0), Resampling("cubic", -1.0))
        )
        return at_none, at_none - at_less

    @cached_property
    def pixel_waves(self) -> tuple[Complexes, Complexes]:
        """Transfer from the middle one of `PIXELS` to each, across and along, (n, 5) each."""
        across, along = (np.outer(freq, PIXELS) for freq in (self.u_cpp, self.v_cpp))
        return np.exp(2j * math.pi * across), np.exp(2j * math.pi * along)

    @cached_property
    def processes(self) -> tuple[Floats, Floats]:
        """Covariances of an even and of an odd Gaussian process here and at `PROCESS_PLACES`,
        (n, m) each."""
        x, y = PROCESS_PLACES.T
        near, far = (
            np.exp(-0.5 * ((u[:, None] - x) ** 2 + (v[:, None] - y) ** 2) / _PROCESS_CPP**2)
            for u, v in ((self.u_cpp, self.v_cpp), (-self.u_cpp, -self.v_cpp))
        )
        return 0.5 * (near + far), 0.5 * (near - far)


def _tap_gains(freq: Floats) -> Floats:
    return np.asarray(2 - 2 * np.cos(2 * math.pi * np.outer(freq, np.arange(1, TAPS + 1))))
