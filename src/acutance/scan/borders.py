"""Borders: edges that follow one another on one line are pieces of one object's side.

Long edges are measured in pieces. The softness of a border is drawn once, not once a piece.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from acutance.curves.direction import unit_vector
from acutance.geometry.angles import direction_difference
from acutance.scan.scene_edges import SceneEdges

__all__ = ["border_of_each"]

_LIKE_DEG: Final = 3.0
_OFFSET_PX: Final = 2.0
"""Pieces of one border lie on one line, so nearly."""
_GAP_PX: Final = 64.0
"""And no farther from one another, end to end."""


def border_of_each(edges: SceneEdges) -> NDArray[np.intp]:
    """The number of the border that every edge is a piece of, from 0, (n,)."""
    places = np.column_stack([edges.row, edges.col])
    reach_px = float(edges.length_px.max(initial=0.0)) + _GAP_PX
    pairs = cKDTree(places).query_pairs(reach_px, output_type="ndarray")
    first, second = pairs[_in_line(edges, *pairs.T)].T
    graph = coo_array((np.ones(first.size), (first, second)), shape=(edges.size,) * 2)
    number: NDArray[np.intp] = connected_components(graph, directed=False)[1]
    return number


def _in_line(
    edges: SceneEdges, first: NDArray[np.intp], second: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Whether two edges follow one another on one line, their normals alike."""
    x, y = unit_vector(edges.normal_deg)
    down, right = edges.row[second] - edges.row[first], edges.col[second] - edges.col[first]
    offset = np.maximum(*(np.abs(x[one] * right + y[one] * down) for one in (first, second)))
    reach = 0.5 * (edges.length_px[first] + edges.length_px[second])
    gap = np.abs(x[first] * down - y[first] * right) - reach
    turn_deg = direction_difference(edges.normal_deg[first], edges.normal_deg[second])
    return np.asarray((turn_deg < _LIKE_DEG) & (offset < _OFFSET_PX) & (gap < _GAP_PX))
