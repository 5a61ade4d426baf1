"""A surveyed edge or pulse, found in the image near the place the survey gives."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from acutance.batch.place_target import NotHereError, PlacedTarget, strip
from acutance.curves.grid import Floats
from acutance.geometry.angles import axis_difference, is_nearer_columns
from acutance.geometry.line import Line
from acutance.raster import Image, Region
from acutance.targets.region import RegionPixels, read_region
from acutance.targets.straight.find_edges import Segment, find_segments

__all__ = ["Away", "away_from_survey", "edge_candidates", "grown", "line_region", "require_near"]

_MAX_TURN_DEG = 12.0
"""Between a surveyed line and what is found: maps turn, and a line of two points is rough."""
_SIDE_PX = 20.0
"""How far the region reaches to either side of a line; what is not its own is trimmed."""
_MIN_OVERLAP = 0.5
"""Of the surveyed length that what is found has to cover."""
_MAX_EMPTY = 0.5
"""Of the surveyed line: where more of it has no data, that is why nothing was found."""
_CANDIDATES = 24
_TRIED = 4


class Away(NamedTuple):
    """How far something lies from where the survey has it, and how it is turned."""

    distance_px: float
    turn_deg: float


def line_region(placed: PlacedTarget, width_px: float = 0.0) -> Region:
    """The pixels in which a surveyed line, or a stripe of a width around it, must lie."""
    start, stop = placed.points
    half_px = _side_px(placed) + 0.5 * width_px + placed.search_px
    return strip(start, stop, half_px, placed.search_px)


def _side_px(placed: PlacedTarget) -> float:
    settings = placed.target.settings
    if settings.get("side_px") is not None:
        return float(settings["side_px"])
    if settings.get("side_m") is not None and placed.gsd is not None:
        return float(settings["side_m"]) / max(placed.gsd.row_m, placed.gsd.col_m)
    return _SIDE_PX


def grown(placed: PlacedTarget) -> Region:
    """The outline of a target, wider on every side by what its place is uncertain."""
    return Region(placed.points, margin_px=placed.search_px)


def edge_candidates(placed: PlacedTarget, image: Image) -> list[tuple[RegionPixels, Segment]]:
    """The edges that may be the target, the likeliest first, each with the pixels around it.

    Near a surveyed line those of its direction, by their strength and their distance from it; of
    an outline the strongest inside, of one orientation if one is stated.

    Raises
    ------
    RegionError
        If the pixels cannot be read, or there are no data; `NotHereError` if there is no edge.
    """
    if placed.target.shape == "LineString":
        return [_recut(placed, image)]
    region = read_region(image, grown(placed), placed.gsd)
    wanted = placed.target.settings.get("orientation")
    found = [
        (region, one)
        for one in find_segments(region.pixels, _CANDIDATES)
        if wanted is None or _orientation(one.line, image) == wanted
    ]
    if not found:
        which = "" if wanted is None else f" {wanted} track"
        raise NotHereError(
            "not found", f"no straight edge{which} stands out in the outline", "find"
        )
    return found[:_TRIED]


def _orientation(line: Line, image: Image) -> str:
    nearer_columns = is_nearer_columns(line.normal_deg)
    return "across" if nearer_columns == (image.along_track == "y") else "along"


def _recut(placed: PlacedTarget, image: Image) -> tuple[RegionPixels, Segment]:
    """The edge nearest to a surveyed line, in pixels cut around it and not around the survey."""
    wide = read_region(image, line_region(placed), placed.gsd)
    coarse = _nearest(placed, wide)
    start, stop = _own_ends(placed, wide, coarse)
    region = read_region(image, strip(start, stop, _side_px(placed)), placed.gsd)
    middle = PlacedTarget(placed.target, np.array([start, stop]), _FOUND_PX, placed.gsd)
    return region, _nearest(middle, region)


_FOUND_PX = 2.0
"""An edge that was found once lies within so many pixels of it."""


def _nearest(placed: PlacedTarget, region: RegionPixels) -> Segment:
    """The strongest segment near a line, its strength being less the farther it lies away."""
    origin = np.array([region.box.row, region.box.col], float)
    start, stop = placed.points - origin
    best: tuple[float, Segment] | None = None
    nearest_px = math.inf
    for one in find_segments(region.pixels, _CANDIDATES):
        offset_px, turn_deg, overlap = _against(one, start, stop)
        if turn_deg > _MAX_TURN_DEG or overlap < _MIN_OVERLAP:
            continue
        nearest_px = min(nearest_px, offset_px)
        if offset_px > placed.search_px:
            continue
        score = one.strength * math.exp(-4.5 * (offset_px / placed.search_px) ** 2)
        if best is None or score > best[0]:
            best = score, one
    if best is None:
        _require_data_along(region, start, stop)
        found = (
            "none of its direction was found"
            if math.isinf(nearest_px)
            else f"the nearest of its direction is {nearest_px:.1f} px away"
        )
        raise NotHereError(
            "not found",
            f"no straight edge lies within {placed.search_px:.1f} px of the surveyed line: "
            f"{found}; check the coordinates, or state a larger {placed.std_name}",
            "find",
        )
    return best[1]


def _require_data_along(region: RegionPixels, start: Floats, stop: Floats) -> None:
    """Refuse a line from `start` to `stop`, (row, col) in the region, on pixels without data."""
    count = max(round(float(np.hypot(*(stop - start)))), 1)
    places = np.rint(start + np.linspace(0.0, 1.0, count + 1)[:, np.newaxis] * (stop - start))
    row, col = places.astype(int).T
    height, width = region.pixels.shape
    inside = (row >= 0) & (row < height) & (col >= 0) & (col < width)
    empty = float(np.mean(np.isnan(region.pixels[row[inside], col[inside]]))) if inside.any() else 0
    if empty > _MAX_EMPTY:
        raise NotHereError(
            "no data",
            f"{100 * empty:.0f} % of the surveyed line lie on pixels without data, and no straight "
            "edge of its direction lies beside them",
        )


def _against(segment: Segment, start: Floats, stop: Floats) -> tuple[float, float, float]:
    """Distance of a segment from a line at the line's middle, angle between them, shared length."""
    along = stop - start
    length = float(np.hypot(*along))
    along = along / length
    middle = 0.5 * (start + stop)
    normal_deg = math.degrees(math.atan2(along[1], -along[0]))
    turn_deg = axis_difference(segment.line.normal_deg, normal_deg)
    offset = abs(float(segment.line.normal_distance(middle[0], middle[1])))
    row, col = _ends(segment)
    reach = np.sort(
        [float((np.array([r, c]) - start) @ along) for r, c in zip(row, col, strict=True)]
    )
    shared = min(reach[1], length) - max(reach[0], 0.0)
    return offset, turn_deg, max(shared, 0.0) / length


def _ends(segment: Segment) -> tuple[Floats, Floats]:
    """Rows and columns of a segment's two ends."""
    angle = math.radians(segment.line.normal_deg)
    reach = np.array([segment.start_px, segment.stop_px])
    # A step along the line is (row, col) = (cos, -sin) of the normal's direction.
    return (
        segment.line.row + math.cos(angle) * reach,
        segment.line.col - math.sin(angle) * reach,
    )


def _own_ends(
    placed: PlacedTarget, region: RegionPixels, segment: Segment
) -> tuple[Floats, Floats]:
    """The ends of the survey, moved onto the line that was found."""
    angle = math.radians(segment.line.normal_deg)
    normal = np.array([math.sin(angle), math.cos(angle)])
    at = np.array([segment.line.row + region.box.row, segment.line.col + region.box.col])
    start, stop = (end - ((end - at) @ normal) * normal for end in placed.points)
    return start, stop


def away_from_survey(placed: PlacedTarget, line: Line, width_px: float = 0.0) -> Away:
    """How far a measured line lies from the surveyed one, and how it is turned against it.

    Parameters
    ----------
    placed : PlacedTarget
        Of a line.
    line : Line
        An edge, or the first side of a pulse, in the whole image.
    width_px : float, optional
        Of the pulse: its middle is what was surveyed.

    Returns
    -------
    Away
        Distance in pixels at the middle of the surveyed line, angle in degrees.
    """
    angle = math.radians(line.normal_deg)
    middle = replace(
        line,
        row=line.row + 0.5 * width_px * math.sin(angle),
        col=line.col + 0.5 * width_px * math.cos(angle),
    )
    half = 0.5 * (line.length_px or 0.0)
    offset_px, turn_deg, _ = _against(Segment(middle, -half, half, 0.0), *placed.points)
    return Away(offset_px, turn_deg)


def require_near(placed: PlacedTarget, line: Line, width_px: float) -> None:
    """Refuse a pulse that was measured if it is not where the survey has its line.

    Raises
    ------
    RegionError
        As `NotHereError`, if it lies farther away than the place is uncertain, or is turned.
    """
    offset_px, turn_deg = away_from_survey(placed, line, width_px)
    if offset_px > placed.search_px + 1.0 or turn_deg > _MAX_TURN_DEG:
        raise NotHereError(
            "not found",
            f"the strongest pulse near the surveyed line is {offset_px:.1f} px away and turned by "
            f"{turn_deg:.0f} degrees: it is another one",
            "find",
        )
