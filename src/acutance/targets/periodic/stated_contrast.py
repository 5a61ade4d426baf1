"""Levels of a periodic target's materials where they are wide: what its contrast is known by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.normal_equations import Normal

__all__ = ["Levels", "with_level"]


@dataclass(frozen=True)
class Levels:
    """Levels of dark and bright before the sensor, image units.

    `std` is the standard deviation of their difference.
    """

    dark: float
    bright: float
    std: float


def with_level(normal: Normal, row: Floats, level: float, std: float, variance: float) -> Normal:
    """Add a measured level to the pixels: one more observation with its own standard deviation.

    Parameters
    ----------
    normal : Normal
    row : (m,) array
        What every coefficient adds to the level.
    level, std : float
    variance : float
        Variance of a pixel, in which the observation is counted.
    """
    strength = variance / max(std, 1e-4 * abs(level)) ** 2
    return Normal(
        normal.gram + strength * np.outer(row, row),
        normal.projection + strength * level * row,
        normal.data + strength * level**2,
        normal.count,
    )
