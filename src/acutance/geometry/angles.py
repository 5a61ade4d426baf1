"""Angles in degrees: directions (a full turn apart are equal) and axes (half a turn apart).

A direction points somewhere: the normal of an edge, from dark to bright. An axis has no sense:
the normal of a group of bars.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats

__all__ = [
    "angle_to_grid",
    "axis_difference",
    "direction_difference",
    "is_nearer_columns",
    "wrap_axis",
    "wrap_direction",
]

Angles = TypeVar("Angles", float, Floats)


def wrap_direction(angle_deg: Angles) -> Angles:
    """The same direction in (-180, 180] degrees."""
    low_end = (angle_deg + 180.0) % 360.0 - 180.0
    wrapped: Angles = low_end + 360.0 * (low_end == -180.0)
    return wrapped


def wrap_axis(angle_deg: Angles) -> Angles:
    """The same axis in [-90, 90) degrees."""
    return (angle_deg + 90.0) % 180.0 - 90.0


def direction_difference(one_deg: Angles, other_deg: Angles | float) -> Angles:
    """Angle between two directions, 0 to 180 degrees."""
    return abs(wrap_direction(one_deg - other_deg))


def axis_difference(one_deg: Angles, other_deg: float) -> Angles:
    """Angle between two axes, 0 to 90 degrees."""
    return abs(wrap_axis(one_deg - other_deg))


def angle_to_grid(direction_deg: float) -> float:
    """Acute angle between a direction and the nearer image axis, 0 to 45 degrees."""
    x, y = np.abs(unit_vector(direction_deg)).tolist()
    return math.degrees(math.atan2(min(x, y), max(x, y)))


def is_nearer_columns(direction_deg: float) -> bool:
    """Whether a direction is nearer the column axis (x) than the row axis, or just between."""
    x, y = unit_vector(direction_deg)
    return abs(x) >= abs(y)
