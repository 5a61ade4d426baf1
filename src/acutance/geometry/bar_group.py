"""A group of parallel bars: where it lies in the image, and the spectrum of its profile."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_types
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.angles import axis_difference

__all__ = ["Bars"]


@dataclass(frozen=True)
class Bars:
    """Parallel bars, as wide as the gaps between them.

    Parameters
    ----------
    row, col : float
        Centre of the group in pixels.
    normal_deg : float
        Direction across the bars, from the column axis towards the row axis.
    period_px : float
        Distance of two bars along the normal.
    count : int
        Number of bars.
    length_px : float
        Length of the bars.

    Raises
    ------
    OptionError
        If one of them is no number.
    """

    row: float
    col: float
    normal_deg: float
    period_px: float
    count: int
    length_px: float

    def __post_init__(self) -> None:
        require_types(self)

    @property
    def freq_cpp(self) -> float:
        """Frequency of the bars in cycles per pixel."""
        return 1 / self.period_px

    @property
    def width_px(self) -> float:
        """From the first bar's outer edge to the last one's."""
        return (self.count - 0.5) * self.period_px

    @property
    def places_px(self) -> Floats:
        """Middles of the bars along the normal, from the centre of the group, (count,)."""
        return np.asarray((np.arange(self.count) - 0.5 * (self.count - 1)) * self.period_px)

    @property
    def region(self) -> Floats:
        """Corners of the group, (4, 2) as (row, col)."""
        x, y = unit_vector(self.normal_deg)
        corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        across, along = 0.5 * self.width_px, 0.5 * self.length_px
        return np.array(
            [
                (
                    self.row + a * across * y + b * along * x,
                    self.col + a * across * x - b * along * y,
                )
                for a, b in corners
            ]
        )

    def across_and_along(self, rows: Floats, cols: Floats) -> tuple[Floats, Floats]:
        """Distances from the centre along the normal and along the bars, in pixels."""
        cos, sin = unit_vector(self.normal_deg)
        x, y = cols - self.col, rows - self.row
        return x * cos + y * sin, -x * sin + y * cos

    def holds(self, rows: Floats, cols: Floats) -> NDArray[np.bool_]:
        """Which places lie within the outline of the group."""
        across, along = self.across_and_along(rows, cols)
        within = np.abs(across) < 0.5 * self.width_px
        return np.asarray(within & (np.abs(along) < 0.5 * self.length_px))

    def spectrum(self, freq_cpp: Floats) -> Floats:
        """Fourier transform of the profile (1 on the bars, 0 next to them), which is real."""
        turns = np.cos(2 * math.pi * np.outer(freq_cpp, self.places_px)).sum(axis=1)
        half = 0.5 * self.period_px
        return np.asarray(turns * half * np.sinc(freq_cpp * half))

    def angle_to(self, normal_deg: float) -> float:
        """Angle between the group's normal and another one, 0 to 90 degrees."""
        return axis_difference(self.normal_deg, normal_deg)

    def shifted(self, rows: float, cols: float) -> Bars:
        """The group so many pixels further down and to the right."""
        return replace(self, row=self.row + rows, col=self.col + cols)

    def to_dict(self) -> dict[str, float]:
        """Place, direction, period, number and length, for JSON."""
        return dict(vars(self))
