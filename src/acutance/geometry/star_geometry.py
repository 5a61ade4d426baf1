"""A Siemens star: where it lies in the image, and how its spokes run."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.angles import direction_difference

__all__ = ["Flags", "SiemensStar"]

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class SiemensStar:
    """A star: spokes about a centre, in a full turn or a part of it.

    Attributes
    ----------
    row, col : float
        Centre in pixels.
    cycles : int
        Periods in a full turn.
    alpha_rad : float
        Phase: the spokes are ``cos(cycles * phi + alpha)``.
    rim_px : float
        Radius at which the spokes end.
    first_deg, sweep_deg : float
        Where the spokes begin, from the column axis towards the row axis, and how far they go.
    """

    row: float
    col: float
    cycles: int
    alpha_rad: float
    rim_px: float
    first_deg: float = 0.0
    sweep_deg: float = 360.0

    def polar(self, rows: Floats, cols: Floats) -> tuple[Floats, Floats]:
        """Radius and direction (radians) of some places."""
        y, x = rows - self.row, cols - self.col
        return np.hypot(x, y), np.arctan2(y, x)

    def holds(self, angle_rad: Floats, margin_rad: Floats | float = 0.0) -> Flags:
        """Whether directions lie within the sweep, `margin_rad` away from its ends."""
        if self.sweep_deg >= 360:
            return np.ones(np.shape(angle_rad), bool)
        half = 0.5 * self.sweep_deg
        off = direction_difference(np.degrees(angle_rad), self.first_deg + half)
        return np.asarray(np.radians(half - off) > margin_rad)

    def freq_cpp(self, radius_px: float) -> float:
        """Frequency of the spokes at a radius."""
        return self.cycles / (2 * math.pi * radius_px)

    def radius_at(self, freq_cpp: float) -> float:
        """Radius at which the spokes have a frequency."""
        return self.cycles / (2 * math.pi * freq_cpp)
