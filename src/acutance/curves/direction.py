"""Directions in the image: their unit vectors, and the ground sampling distance along them.

A direction is an angle from the column axis (x, 0 degrees: across) towards the row axis (y, 90
degrees: along).
"""

from __future__ import annotations

import math
from typing import overload

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["gsd_along", "unit_vector"]


@overload
def unit_vector(direction_deg: float) -> tuple[float, float]: ...


@overload
def unit_vector(direction_deg: Floats) -> tuple[Floats, Floats]: ...


def unit_vector(direction_deg: float | Floats) -> tuple[float, float] | tuple[Floats, Floats]:
    """Components (x, y), that is (column, row), of the unit vector of a direction.

    Parameters
    ----------
    direction_deg : float or array
        From the column axis towards the row axis.

    Returns
    -------
    x, y : float or arrays of the shape given
    """
    if isinstance(direction_deg, np.ndarray):
        angle_rad = np.radians(direction_deg)
        return np.cos(angle_rad), np.sin(angle_rad)
    angle = math.radians(direction_deg)
    return math.cos(angle), math.sin(angle)


def gsd_along(pixel_m: tuple[float, float], normal_deg: float) -> float:
    """Metres on the ground per pixel of distance along a normal.

    A line of the image is normal to ``n = (cos t, sin t)``. On the ground its own normal is
    another one where the GSD differs between rows and columns; two parallel lines one pixel apart
    along `n` are ``1 / sqrt((n_x / col_m)^2 + (n_y / row_m)^2)`` metres apart.

    Parameters
    ----------
    pixel_m : (float, float)
        Metres from row to row and from column to column.
    normal_deg : float
        Direction of the normal in the image.

    Returns
    -------
    float
        The second of `pixel_m` at 0 degrees, the first at 90.
    """
    row_m, col_m = pixel_m
    if row_m == col_m:
        return col_m
    x, y = unit_vector(normal_deg)
    return 1.0 / math.hypot(x / col_m, y / row_m)
