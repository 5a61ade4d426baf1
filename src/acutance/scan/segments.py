"""Straight or gently curved segments of edge points.

Points of neighbouring pixels belong together where their normals differ by little. A chain that
bends more than a gentle arc is divided where it is farthest from its chord, again and again; what
remains are segments, each with the line of least squares through its points.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.line import Line
from acutance.numerics.compiled import compiled
from acutance.scan.edge_points import EdgePoints
from acutance.targets.straight.find_edges import Segment

__all__ = ["find_segments"]

_MAX_TURN_DEG = 22.0
"""Normals of neighbouring points of one segment differ by no more."""
_MAX_AWAY_PX = 0.6
"""Points of a segment lie no farther from its arc."""
_MIN_RADIUS_PX = 250.0
"""Arcs that bend more are divided."""
_MIN_POINTS = 8


def find_segments(
    points: EdgePoints, shape: tuple[int, int], min_length_px: float
) -> Iterator[Segment]:
    """Segments of edge points, in no order.

    Parameters
    ----------
    points : EdgePoints
    shape : (rows, cols)
        Of the window.
    min_length_px : float
        Shorter ones are left out.
    """
    place = np.full(shape, -1, np.intp)
    place.reshape(-1)[points.pixel] = np.arange(points.pixel.size)
    turned = np.radians(points.normal_deg)
    chain = _chains(place, np.cos(turned), np.sin(turned), math.cos(math.radians(_MAX_TURN_DEG)))
    order = np.argsort(chain, kind="stable")
    starts = np.flatnonzero(np.diff(chain[order], prepend=-1))
    for own in np.split(order, starts[1:]):
        if own.size >= _MIN_POINTS:
            yield from _straight_parts(points, own, min_length_px)


@compiled
def _chains(place: NDArray[np.intp], x: Floats, y: Floats, least: float) -> NDArray[np.intp]:
    """Number of the chain of every point: neighbours with like normals belong to one."""
    rows, cols = place.shape
    parent = np.arange(x.size)
    for i in range(1, rows - 1):
        for j in range(1, cols - 1):
            one = place[i, j]
            if one < 0:
                continue
            for down, right in ((0, 1), (1, -1), (1, 0), (1, 1)):
                other = place[i + down, j + right]
                if other >= 0 and x[one] * x[other] + y[one] * y[other] > least:
                    first, second = _root(parent, one), _root(parent, other)
                    parent[max(first, second)] = min(first, second)
    for one in range(x.size):
        parent[one] = _root(parent, one)
    return parent


@compiled
def _root(parent: NDArray[np.intp], one: int) -> int:
    while parent[one] != one:
        parent[one] = parent[parent[one]]
        one = parent[one]
    return one


def _straight_parts(
    points: EdgePoints, own: NDArray[np.intp], min_length_px: float
) -> Iterator[Segment]:
    """A chain, divided until every part lies on a gentle arc."""
    todo = [own]
    while todo:
        some = todo.pop()
        if some.size < _MIN_POINTS:
            continue
        along, away, segment = _line_through(points, some)
        if segment is None or segment.stop_px - segment.start_px < min_length_px:
            continue
        middle = 0.5 * (along.min() + along.max())
        arc = np.polynomial.polynomial.polyfit(along - middle, away, 2)
        left = away - np.polynomial.polynomial.polyval(along - middle, arc)
        if np.abs(left).max() <= _MAX_AWAY_PX and 2 * abs(arc[2]) <= 1 / _MIN_RADIUS_PX:
            yield segment
            continue
        order = np.argsort(along)
        chord = np.interp(along, along[order[[0, -1]]], away[order[[0, -1]]])
        inner = order[2:-2]
        cut = along[inner[np.argmax(np.abs(away - chord)[inner])]]
        todo += [some[along < cut - 1], some[along > cut + 1]]


def _line_through(
    points: EdgePoints, own: NDArray[np.intp]
) -> tuple[Floats, Floats, Segment | None]:
    """Distances along the line of least squares and from it, and the segment on it."""
    row, col, weight = points.row[own], points.col[own], points.magnitude[own]
    total = float(weight.sum())
    middle_row, middle_col = float(weight @ row) / total, float(weight @ col) / total
    down, right = row - middle_row, col - middle_col
    # The axis of least inertia is the normal.
    spread = np.array([
        [weight @ (right * right), weight @ (right * down)],
        [weight @ (right * down), weight @ (down * down)],
    ])  # fmt: skip
    normal = np.linalg.eigh(spread)[1][:, 0]
    angles = np.radians(points.normal_deg[own])
    mean = np.array([weight @ np.cos(angles), weight @ np.sin(angles)])
    x, y = normal if normal @ mean >= 0 else -normal
    along, away = x * down - y * right, x * right + y * down
    start, stop = float(along.min()), float(along.max())
    centre = 0.5 * (start + stop)
    half = 0.5 * (stop - start)
    line = Line(
        middle_row + x * centre, middle_col - y * centre, math.degrees(math.atan2(y, x)),
        length_px=2 * half,
    )  # fmt: skip
    strength = total * 2 * half / own.size
    return along, away, Segment(line, -half, half, strength)
