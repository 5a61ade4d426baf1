"""Which measurements used the same pixels: their noise is one, so they may not count twice.

Targets are found by their own places, since regions may be as large as the image: lines of edges
and pulses, mirrors, bar groups, stars. Scenes and pairs use whatever lies in their region.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Final

from acutance.curves.direction import unit_vector
from acutance.geometry.angles import axis_difference, direction_difference
from acutance.geometry.line import Line
from acutance.targets.combine.inputs import MeasuredInput

__all__ = ["is_same_file", "pairs_of_same_pixels"]

_SAME_PLACE_PX: Final = 3.0
_SAME_LINE_DEG: Final = 5.0
_WHOLE_REGION: Final = ("scene", "biresolution")
_STRAIGHT: Final = ("edge", "pulse")


def pairs_of_same_pixels(inputs: Sequence[MeasuredInput]) -> list[str]:
    """Names of the pairs that used the same pixels of one file.

    Parameters
    ----------
    inputs : sequence of MeasuredInput
    """
    return [
        f"{other.name} and {one.name}"
        for i, one in enumerate(inputs)
        for other in inputs[:i]
        if is_same_file(one, other) and _share_pixels(one, other)
    ]


def is_same_file(one: MeasuredInput, other: MeasuredInput) -> bool:
    """Whether two measurements are of one file, however it was named."""
    paths = one.image.path, other.image.path
    # Two runs write the name of one file as they were given it.
    return None not in paths and len(set(map(os.path.realpath, filter(None, paths)))) == 1


def _share_pixels(one: MeasuredInput, other: MeasuredInput) -> bool:
    """Whether two measurements of one image used the same target, or the same ground."""
    if not _overlap(one.image.roi, other.image.roi):
        return False
    if {one.kind, other.kind} & {*_WHOLE_REGION}:
        return True
    if one.kind in _STRAIGHT and other.kind in _STRAIGHT:
        return _is_same_line(one, other)
    if one.kind != other.kind:
        return False
    places = _places(one), _places(other)
    # Documents of some versions and methods have no places: their regions overlap.
    return not all(places) or any(
        math.dist(here, there) < _SAME_PLACE_PX for here, there in product(*places)
    )


def _overlap(one: tuple[int, int, int, int], other: tuple[int, int, int, int]) -> bool:
    """Whether two regions (row, col, height, width) share pixels."""
    return all(
        max(one[i], other[i]) < min(one[i] + one[i + 2], other[i] + other[i + 2]) for i in (0, 1)
    )


def _is_same_line(one: MeasuredInput, other: MeasuredInput) -> bool:
    """Whether an edge or a side of a pulse is that of the other measurement.

    Edges of one region are told apart by their middles, as those of a checkerboard lie in one
    line. In two regions the middles of one edge are as far apart as the regions.
    """
    # The normal of an edge points to its bright side, that of a pulse into the pulse.
    turn = direction_difference if one.kind == other.kind else axis_difference
    apart = _distance if one.image.roi == other.image.roi and one.kind == other.kind else _aside
    return any(
        turn(here.normal_deg, there.normal_deg) < _SAME_LINE_DEG
        and apart(here, there) < _SAME_PLACE_PX
        for here, there in product(_lines(one), _lines(other))
    )


def _distance(one: Line, other: Line) -> float:
    return math.dist((one.row, one.col), (other.row, other.col))


def _aside(one: Line, other: Line) -> float:
    """How far two lines are apart half way between their points."""
    middle = 0.5 * (one.row + other.row), 0.5 * (one.col + other.col)
    return abs(float(one.normal_distance(*middle))) + abs(float(other.normal_distance(*middle)))


def _lines(one: MeasuredInput) -> list[Line]:
    """The edge; of a pulse both sides."""
    document = one.record.document["line"]
    row, col, normal_deg = (float(document[key]) for key in ("row", "col", "normal_deg"))
    line = Line(row, col, normal_deg, curvature_per_px=float(document.get("curvature_per_px", 0)))
    width = one.record.document.get("width_px")
    if one.kind != "pulse" or width is None:
        return [line]
    x, y = unit_vector(normal_deg)
    width_px = float(width["value"])
    return [line, Line(row + width_px * y, col + width_px * x, normal_deg)]


def _places(one: MeasuredInput) -> list[tuple[float, float]]:
    """Rows and columns of the mirrors, bar groups or star of a measurement."""
    document = one.record.document
    found = document.get("sources") or document.get("groups") or document.get("star") or ()
    targets = [found] if isinstance(found, Mapping) else found
    return [(_number(target["row"]), _number(target["col"])) for target in targets]


def _number(value: Any) -> float:
    """A number of a document, or the value of an estimate."""
    return float(value["value"] if isinstance(value, Mapping) else value)
