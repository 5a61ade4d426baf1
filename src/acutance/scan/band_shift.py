"""The shift between two bands, from the places of the same edges in both.

An edge shows how far it is displaced along its normal; edges of several directions show both
components. Places differ by more than their deviations where an object has different borders in
two bands (a roof and its shadow, a shore): what the edges scatter in excess is found with the
shift, and far ones are bounded by Huber's weights (P. J. Huber, Ann. Math. Stat. 35, 1964, 73).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import NoEdgeError
from acutance.geometry.angles import wrap_direction
from acutance.scan.scene_edges import SceneEdges

__all__ = ["BandShift", "band_shift"]

_MIN_EDGES: Final = 8
_MIN_SPREAD: Final = 0.03
"""Smaller eigenvalue of the mean square of the normals: directions within about 20 degrees show
no more than one component."""
_BOUND: Final = 1.345
"""Huber's: errors that are normal lose a twentieth of their information."""
_MEDIAN_SQUARE: Final = 0.4549
"""Median of the square of a standard normal variable."""
_TURNS: Final = 30
_SETTLED_PX: Final = 1e-6


@dataclass(frozen=True)
class BandShift(ShortRepr):
    """Place of the ground in a band minus its place in the first band.

    Parameters
    ----------
    row_px, col_px : Estimate
    correlation : float
        Of the two.
    edges : int
        How many were used in both bands.
    scatter_px : float
        By how much the edges' places differ in excess of their deviations, along their normals.
    """

    row_px: Estimate
    col_px: Estimate
    correlation: float
    edges: int
    scatter_px: float

    def summary(self) -> str:
        """Both components."""
        return f"row {self.row_px} px, col {self.col_px} px, {self.edges} edges"

    def to_dict(self) -> dict[str, Any]:
        """All fields, for JSON."""
        return {
            "row_px": self.row_px.to_dict(),
            "col_px": self.col_px.to_dict(),
            "correlation": self.correlation,
            "edges": self.edges,
            "scatter_px": self.scatter_px,
        }


def band_shift(first: SceneEdges, other: SceneEdges) -> BandShift:
    """The shift of a band relative to another.

    Parameters
    ----------
    first, other : SceneEdges
        The same edges, in the same order.

    Raises
    ------
    NoEdgeError
        If too few edges or directions show it.
    """
    both = first.used & other.used
    shared = int(both.sum())
    if shared < _MIN_EDGES:
        raise NoEdgeError(
            f"the bands share {shared} {'edge' if shared == 1 else 'edges'} that both use, and a "
            f"shift needs {_MIN_EDGES}"
        )
    normal, along, std = _displacements(first, other, both)
    if float(np.linalg.eigvalsh(normal.T @ normal / len(normal))[0]) < _MIN_SPREAD:
        raise NoEdgeError(
            f"the {shared} edges that both bands use have nearly one direction, which shows one "
            "component of a shift"
        )
    scatter, shift = 0.0, np.zeros(2)
    for _ in range(_TURNS):
        whole = np.hypot(std, scatter)
        updated = _bounded_fit(normal, along, whole, shift)
        moved = float(np.abs(updated - shift).max())
        shift = updated
        scatter, before = _excess(along - normal @ shift, std), scatter
        if max(moved, abs(scatter - before)) < _SETTLED_PX:
            break
    covariance = _covariance(normal, along - normal @ shift, np.hypot(std, scatter))
    row_std, col_std = np.sqrt(np.diagonal(covariance)).tolist()
    # Bands that are equal have no deviation.
    correlation = float(covariance[0, 1]) / (row_std * col_std) if row_std * col_std > 0 else 0.0
    return BandShift(
        Estimate(float(shift[0]), row_std), Estimate(float(shift[1]), col_std), correlation,
        shared, scatter,
    )  # fmt: skip


def _displacements(
    first: SceneEdges, other: SceneEdges, both: NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats]:
    """Normals (n, 2) as (row, col), how far edges are displaced along them, and its deviation.

    Along the mean normal of the two lines, the distance of their points is that of the lines
    midway between the points.
    """
    one_deg, two_deg = first.normal_deg[both], other.normal_deg[both]
    # Of an edge of opposite contrast the normal is turned.
    turn_deg = wrap_direction(2 * (two_deg - one_deg)) / 2
    mean = np.radians(one_deg + turn_deg / 2)
    normal = np.stack([np.sin(mean), np.cos(mean)], axis=1)
    away = np.stack([
        other.row[both] - first.row[both], other.col[both] - first.col[both]
    ], axis=1)  # fmt: skip
    std = np.hypot(first.place_std_px[both], other.place_std_px[both])
    return normal, (normal * away).sum(axis=1), std


def _bounded_fit(normal: Floats, along: Floats, std: Floats, shift: Floats) -> Floats:
    """One turn of the least squares whose weights fall where residuals are large."""
    off = np.abs(along - normal @ shift) / std
    weight = np.minimum(1.0, _BOUND / np.maximum(off, 1e-12)) / std**2
    return np.asarray(np.linalg.solve((normal.T * weight) @ normal, (normal.T * weight) @ along))


def _excess(residual: Floats, std: Floats) -> float:
    """Scatter that, added to the deviations, makes the median residual what it should be."""
    # Two components were fitted to n edges.
    square = residual**2 * residual.size / (residual.size - 2)

    def too_wide(scatter: float) -> bool:
        return float(np.median(square / (std**2 + scatter**2))) < _MEDIAN_SQUARE

    low, high = 0.0, math.sqrt(float(square.max())) + float(std.max())
    high *= 2
    if too_wide(0.0):
        return 0.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if too_wide(middle) else (middle, high)
    return high


def _covariance(normal: Floats, residual: Floats, std: Floats) -> Floats:
    """Covariance of the bounded fit, from what the residuals are."""
    count = residual.size
    off = residual / std
    bounded = np.clip(off, -_BOUND, _BOUND)
    inside = float(np.mean(np.abs(off) < _BOUND))
    scale = float(np.sum(bounded**2)) / (count - 2) / inside**2
    information = (normal.T / std**2) @ normal
    return np.asarray(scale * np.linalg.inv(information))
