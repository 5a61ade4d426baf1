"""First guesses of the sensor of a scene: some of its edges, as they were measured.

Which edges are those of ideal objects is not known yet. Where there are many, the sharp ones of
every direction tell; where there are few, a direction may have none, and the sensor is guessed the
same all around, from edges of about one sharpness: that of the ideal ones is among several.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.angles import axis_difference
from acutance.scan.window_edges import UsedEdge

__all__ = ["BIN_DEG", "sensor_guesses"]

BIN_DEG: Final = 7.5
"""Width of a bin of directions: within half of it a sensor changes by no more than .0005."""
_NEAR_EDGES: Final = 8
_SHARP: Final = ((0.1, 0.3), (0.3, 0.6), (0.5, 0.9))
"""Quantiles, the sharpest first, between which edges are a guess of their direction: where most
objects are ideal the middle ones, where most are soft the sharp ones."""
_ALL_AROUND: Final = (0.02, 0.06, 0.1, 0.15, 0.2, 0.27, 0.35, 0.45, 0.55, 0.7)
"""Quantiles of all edges about which some are a guess of all directions."""
_SHARE: Final = 0.04
_LEAST: Final = 3
"""Some: such a share of the edges, and at least so many."""


def sensor_guesses(used: Sequence[UsedEdge], normal_deg: Floats) -> list[Floats]:
    """Guesses of the OTF along directions, real parts first, (b, 2 k) each.

    Parameters
    ----------
    used : sequence of UsedEdge
    normal_deg : (b,) array
        Directions, -90 to 90.
    """
    modulus = np.array([np.abs(one.otf) for one in used])
    axis_deg = np.array([one.axis_deg for one in used])
    sharpest = np.argsort(-modulus[:, : modulus.shape[1] // 2].sum(axis=1))
    by_direction = [_near(sharpest, axis_deg, one) for one in normal_deg.tolist()]
    return [
        *(_sensor(modulus, [_between(own, *two) for own in by_direction]) for two in _SHARP),
        *(_sensor(modulus, [_about(sharpest, one)] * normal_deg.size) for one in _ALL_AROUND),
    ]


def _sensor(modulus: Floats, some: Sequence[NDArray[np.intp]]) -> Floats:
    """Mean modulus of some edges for every direction; an even LSF has no imaginary part."""
    mean = np.array([modulus[own].mean(axis=0) for own in some])
    return np.hstack([mean, np.zeros_like(mean)])


def _near(sharpest: NDArray[np.intp], axis_deg: Floats, normal_deg: float) -> NDArray[np.intp]:
    """The edges of about one direction, the sharpest first."""
    away = axis_difference(axis_deg, normal_deg)
    count = max(_NEAR_EDGES, int(np.sum(away < BIN_DEG)))
    return sharpest[np.isin(sharpest, np.argsort(away)[:count])]


def _between(edges: NDArray[np.intp], first: float, last: float) -> NDArray[np.intp]:
    """Those between two quantiles, one at least."""
    begin, end = int(first * edges.size), int(last * edges.size)
    return edges[begin : max(end, begin + 1)]


def _about(edges: NDArray[np.intp], quantile: float) -> NDArray[np.intp]:
    """Those about one quantile."""
    count = min(max(_LEAST, int(_SHARE * edges.size)), edges.size)
    begin = int(quantile * edges.size) - count // 2
    begin = min(max(begin, 0), edges.size - count)
    return edges[begin : begin + count]
