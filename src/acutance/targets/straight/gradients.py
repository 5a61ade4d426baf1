"""Plateaus that are not uniform: slow trends, separated from the halo of the sensor.

A slope of a plateau next to an edge looks like a halo of the sensor and lowers the MTF. Trends
along the edge separate the two: no sensor makes them. Every side of the edge has low polynomials
in both directions, whose common amplitude the data determine.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.straight.step_profile import Sides

__all__ = ["plateau_trends"]


def plateau_trends(sides: Sides, t: Floats) -> Floats:
    """Trends of the two sides, (10, n): five modes a side, each about 1 at its largest.

    Parameters
    ----------
    sides : pairs of (n,) arrays
        For either plateau its share in every pixel, and the pixel's distance outwards.
    t : (n,) array
        Distance along the edge, pixels.
    """
    along = t * (1 / max(float(np.max(np.abs(t))), 1e-9))
    bow = 1.5 * along * along - 0.5
    modes = np.empty((5 * len(sides), t.size))
    for side, (share, outwards) in zip(modes.reshape(-1, 5, t.size), sides, strict=True):
        away = np.maximum(outwards, 0.0)
        away *= 1 / max(float(away.max()), 1e-9)
        np.multiply(share, along, out=side[0])
        np.multiply(share, bow, out=side[1])
        np.multiply(share, away, out=side[2])
        np.multiply(side[0], away, out=side[3])
        np.multiply(side[2], away, out=side[4])
    return modes
