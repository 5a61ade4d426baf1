"""Plateaus that are not uniform: slow trends, separated from the halo of the sensor.

A slope of a plateau next to an edge looks like a halo of the sensor and lowers the MTF. Trends
along the edge separate the two: no sensor makes them. Every side of the edge has low polynomials
in both directions, whose common amplitude the data determine. The ground around a pulse may besides
be tilted as a whole, as far as it likes: no halo is, and a tilt in the common amplitude would let
both sides slope away from the pulse as steeply, which is what a halo looks like.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.straight.step_profile import Sides

__all__ = ["ground_tilts", "plateau_trends"]


def plateau_trends(sides: Sides, t: Floats) -> Floats:
    """Trends of the two sides, (10, n): five modes a side, each about 1 at its largest.

    Parameters
    ----------
    sides : pairs of (n,) arrays
        For either plateau its share in every pixel, and the pixel's distance outwards.
    t : (n,) array
        Distance along the edge, pixels.
    """
    modes = np.empty((5 * len(sides), t.size))
    for own, (share, outwards) in zip(modes.reshape(-1, 5, t.size), sides, strict=True):
        _fill(own, share, outwards, t)
    return modes


def ground_tilts(sides: Sides, t: Floats) -> Floats:
    """The ground beside a pulse tilted as a whole, along and across, (2, n): about 1 at the ends.

    Parameters
    ----------
    sides, t
        As for `plateau_trends`.
    """
    (before, to_left), (behind, to_right) = sides
    reach = max(float(np.max(to_left)), float(np.max(to_right)), 1e-9)
    half_length = max(float(np.max(np.abs(t))), 1e-9)
    across = behind * np.maximum(to_right, 0.0) - before * np.maximum(to_left, 0.0)
    return np.stack([(before + behind) * t / half_length, across / reach])


@compiled
def _fill(modes: Floats, share: Floats, outwards: Floats, t: Floats) -> None:
    """Trends of one side, (5, n)."""
    along_scale = 1 / max(np.max(np.abs(t)), 1e-9)
    away_scale = 1 / max(np.max(outwards), 1e-9)
    for i in range(t.size):
        along, away = along_scale * t[i], away_scale * max(outwards[i], 0.0)
        modes[0, i] = share[i] * along
        modes[1, i] = share[i] * (1.5 * along * along - 0.5)
        modes[2, i] = share[i] * away
        modes[3, i] = share[i] * along * away
        modes[4, i] = share[i] * away * away
