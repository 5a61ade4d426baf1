"""Where a target lies in an image by its survey, and why it cannot be measured there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.raster import Box, Geolocation, Gsd, Image, Region
from acutance.raster.sensor_model import SensorModel
from acutance.raster.surveyed_targets import SurveyedTarget

__all__ = ["NotHereError", "PlacedTarget", "place_target", "strip"]

_SIGMAS = 3.0
_MIN_SEARCH_PX = 2.0
_MIN_LINE_PX, _MIN_SIDE_PX = 8.0, 8.0
"""Shorter edges and smaller regions have too few samples for any method."""
_MIN_SHARE = 0.6
"""Of a target that has to be inside the image."""
_MAX_SEARCH_SHARE = 0.5
"""Of the image's smaller side: a target that may be anywhere is not located."""
_SAMPLES = 101

Georeference = Geolocation | SensorModel | None


class NotHereError(RegionError):
    """A target that cannot be measured in an image: in a word, and in a sentence."""

    def __init__(self, why: str, reason: str, stage: str = "region") -> None:
        super().__init__(reason)
        self.why, self.stage = why, stage


@dataclass(frozen=True, eq=False)
class PlacedTarget:
    """A target in the pixels of an image.

    Parameters
    ----------
    target : SurveyedTarget
    points : (n, 2) array
        (row, col) of its line, outline or points; the whole image's corners of a scene without.
    search_px : float
        How far from there it is looked for: three standard deviations.
    gsd : Gsd or None
        At the target.
    """

    target: SurveyedTarget
    points: Floats
    search_px: float
    gsd: Gsd | None

    @property
    def std_name(self) -> str:
        """The property that states how far it is looked for, for messages."""
        return "position_std_px" if self.target.in_pixels else "position_std_m"


def place_target(
    target: SurveyedTarget, image: Image, georeference: Georeference, gsd: Gsd | None = None
) -> PlacedTarget:
    """Where a target lies in an image.

    Parameters
    ----------
    target : SurveyedTarget
    image : Image
    georeference : Geolocation, SensorModel or None
    gsd : Gsd, optional
        As it is stated for the image; that of its georeference at the target without it.

    Raises
    ------
    RegionError
        As `NotHereError`, if the image cannot be related to the target's coordinates, does not
        hold enough of it, or shows it too small.
    """
    if not target.points:
        return PlacedTarget(target, _outline(Box.whole(image.shape)), 0.0, gsd or image.gsd())
    points = _in_pixels(target, image, georeference)
    if gsd is None:
        gsd = _gsd_at(points.mean(axis=0), image, georeference)
    if target.shape == "Point":
        points = _square(target, points[0], gsd)
    placed = PlacedTarget(target, points, _search_px(target, gsd), gsd)
    _require_inside(placed, image)
    _require_size(placed)
    return placed


def _outline(box: Box) -> Floats:
    top, left = box.row - 0.5, box.col - 0.5
    bottom, right = top + box.height, left + box.width
    return np.array([[top, left], [top, right], [bottom, right], [bottom, left]])


def _in_pixels(target: SurveyedTarget, image: Image, georeference: Georeference) -> Floats:
    points = np.array(target.points, dtype=np.float64)
    if target.in_pixels:
        return points[:, ::-1]
    if georeference is None:
        raise NotHereError(
            "no georeference",
            "the image has neither a geotransform with a CRS, RPC nor ground control points to "
            f"find {target.crs} by: write the CRS into it, or give the target in pixels "
            '("crs": "pixel")',
        )
    if isinstance(georeference, SensorModel) and georeference.needs_height:
        _require_near(points, target.crs, image, georeference)
        raise NotHereError(
            "no height",
            f"the image is located by RPC, which need the height of the ground, and {target.name} "
            "states none: give the target height_m, or the images ([[stated]] height_m, --height), "
            "in metres above the ellipsoid (the height above sea level and the geoid's)",
        )
    try:
        row, col = georeference.from_crs(points[:, 0], points[:, 1], target.crs)
    except RegionError as error:
        raise NotHereError("no georeference", str(error)) from error
    if isinstance(georeference, Geolocation):
        col = georeference.nearest_turn(col, image.shape[1])
    found = np.column_stack([row, col])
    if not np.isfinite(found).all():
        raise NotHereError("outside", "the target lies where the image's map has no place for it")
    return found


def _require_near(points: Floats, crs: str, image: Image, model: SensorModel) -> None:
    """Refuse a target that lies outside the image whatever the height of the ground."""
    try:
        seen = [one.from_crs(points[:, 0], points[:, 1], crs) for one in model.at_extremes]
    except RegionError:
        return
    places = np.concatenate([np.column_stack(one) for one in seen])
    beyond = places.max(axis=0) < 0.0, places.min(axis=0) > np.array(image.shape)
    if not np.isfinite(places).all() or np.any(beyond):
        raise NotHereError(
            "outside", "the target lies outside the image, however high the ground is there"
        )


def _gsd_at(place: Floats, image: Image, georeference: Georeference) -> Gsd | None:
    if image.own_gsd is not None:
        return image.own_gsd
    if georeference is None:
        return None
    try:
        return georeference.gsd(float(place[0]), float(place[1]))
    except RegionError:
        return None


def _square(target: SurveyedTarget, middle: Floats, gsd: Gsd | None) -> Floats:
    """The square around a point, its sides along rows and columns."""
    if target.size_px is not None:
        half = np.array([target.size_px, target.size_px]) / 2
    elif gsd is None or target.size_m is None:
        raise NotHereError(
            "no GSD", "the GSD of the image is not known, so the size of the target in it is not"
        )
    else:
        half = np.array([target.size_m / gsd.row_m, target.size_m / gsd.col_m]) / 2
    corners = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]])
    return middle + corners * half


def _search_px(target: SurveyedTarget, gsd: Gsd | None) -> float:
    if target.in_pixels:
        return max(_SIGMAS * target.position_std_px, _MIN_SEARCH_PX)
    if gsd is None:
        raise NotHereError(
            "no GSD",
            "the GSD of the image is not known, so how many pixels the target may lie off its "
            "place (position_std_m) is not: state it (gsd_m)",
        )
    return max(_SIGMAS * target.position_std_m / min(gsd.row_m, gsd.col_m), _MIN_SEARCH_PX)


def _require_inside(placed: PlacedTarget, image: Image) -> None:
    share = _share_inside(placed, image)
    rows, cols = image.shape
    low, high = placed.points.min(axis=0), placed.points.max(axis=0)
    extent = (
        f"rows {low[0]:.0f} to {high[0]:.0f}, columns {low[1]:.0f} to {high[1]:.0f} of an image "
        f"of {rows} x {cols} pixels"
    )
    if share == 0.0:
        raise NotHereError("outside", f"the target lies outside the image: {extent}")
    if share < _MIN_SHARE:
        raise NotHereError(
            "clipped", f"the border leaves {100 * share:.0f} % of the target: {extent}"
        )
    if placed.search_px > _MAX_SEARCH_SHARE * min(rows, cols):
        raise NotHereError(
            "not located",
            f"the target may lie anywhere within {placed.search_px:.0f} px of its place (three "
            "standard deviations), as far as the image goes: state a smaller "
            f"{placed.std_name}",
        )


def _share_inside(placed: PlacedTarget, image: Image) -> float:
    """The share of a target's length, points or area that the image holds."""
    size = np.array(image.shape)
    points = placed.points
    if placed.target.shape == "LineString":
        along = np.linspace(0.0, 1.0, _SAMPLES)[:, np.newaxis]
        points = points[0] + along * (points[1] - points[0])
    elif placed.target.shape != "MultiPoint":
        low, high = points.min(axis=0), points.max(axis=0)
        rows, cols = (np.linspace(low[k], high[k], 31) for k in (0, 1))
        grid = np.stack(np.meshgrid(rows, cols, indexing="ij"), axis=-1).reshape(-1, 2)
        points = grid
    inside = ((points >= -0.5) & (points < size - 0.5)).all(axis=1)
    return float(np.mean(inside))


def _require_size(placed: PlacedTarget) -> None:
    shape, points = placed.target.shape, placed.points
    if shape == "LineString":
        length = float(np.hypot(*(points[1] - points[0])))
        if length < _MIN_LINE_PX:
            _too_small(f"the target is {length:.1f} px long", _MIN_LINE_PX)
    elif shape in ("Polygon", "Point"):
        side = float((points.max(axis=0) - points.min(axis=0)).min())
        if side < _MIN_SIDE_PX:
            _too_small(f"the target is {side:.1f} px wide", _MIN_SIDE_PX)


def _too_small(found: str, least: float) -> NoReturn:
    raise NotHereError(
        "too small",
        f"{found}, and at least {least:g} px are needed: the image is too coarse for it",
    )


def strip(start: Floats, stop: Floats, half_width_px: float, margin_px: float = 0.0) -> Region:
    """The rectangle around a line.

    Parameters
    ----------
    start, stop : (2,) arrays
        Ends of the line, (row, col).
    half_width_px : float
        How far it reaches to either side.
    margin_px : float, optional
        How far it reaches beyond the ends.
    """
    along = (stop - start) / np.hypot(*(stop - start))
    side = np.array([-along[1], along[0]]) * half_width_px
    first, last = start - margin_px * along, stop + margin_px * along
    return Region(np.array([first + side, last + side, last - side, first - side]))
