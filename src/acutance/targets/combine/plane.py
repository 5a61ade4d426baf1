"""Places of the plane of frequencies, and what terms of sensors ask of them again and again."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["TAPS", "Plane"]

TAPS = 7
"""Outer taps on either side of the kernels."""
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
    def tap_gains(self) -> tuple[Floats, Floats]:
        """What a unit of every outer tap adds to the gain across and along, (n, taps) each."""
        return _tap_gains(self.u_cpp), _tap_gains(self.v_cpp)


def _tap_gains(freq: Floats) -> Floats:
    return np.asarray(2 - 2 * np.cos(2 * math.pi * np.outer(freq, np.arange(1, TAPS + 1))))
