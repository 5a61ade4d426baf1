"""Surveyed points, found in the image: the shift of the whole pattern that matches most spots."""

from __future__ import annotations

import numpy as np

from acutance.batch.place_target import NotHereError, PlacedTarget
from acutance.curves.grid import Floats
from acutance.raster import Box, Image
from acutance.targets.points.detect import find_spots
from acutance.targets.region import RegionPixels, read_region

__all__ = ["find_points", "points_box"]

_MARGIN_PX = 16.0
"""Around the outermost points: the background of a spot is estimated around it."""
_NEAR_PX = 1.5
"""A spot belongs to a point that lies so near after the shift."""
_MIN_SNR = 5.0


def points_box(placed: PlacedTarget, image: Image) -> Box:
    """The part of the image that holds all points, wherever within their uncertainty they are."""
    reach = placed.search_px + _MARGIN_PX
    low = np.floor(placed.points.min(axis=0) - reach).astype(int)
    high = np.ceil(placed.points.max(axis=0) + reach).astype(int)
    wanted = Box(int(low[0]), int(low[1]), int(high[0] - low[0]) + 1, int(high[1] - low[1]) + 1)
    found = wanted.intersection(Box.whole(image.shape))
    if found is None:
        raise NotHereError("outside", "the points lie outside the image")
    return found


def find_points(placed: PlacedTarget, image: Image) -> tuple[Box, Floats]:
    """The box to measure, and the places (n, 2) of the points in the whole image.

    Raises
    ------
    RegionError
        If the pixels cannot be read, or there are no data; `NotHereError` if no spots match.
    """
    box = points_box(placed, image)
    region = read_region(image, box, placed.gsd)
    spots = _spots(region)
    shift, matched = _pattern_shift(placed.points, spots, placed.search_px)
    least = max(1, (len(placed.points) + 1) // 2)
    if matched.sum() < least:
        raise NotHereError(
            "not found",
            f"{int(matched.sum())} of {len(placed.points)} surveyed points have a spot within "
            f"{placed.search_px:.1f} px, and half of them are needed: check the coordinates, or "
            f"state a larger {placed.std_name}",
            "find",
        )
    return box, placed.points[matched] + shift


def _spots(region: RegionPixels) -> Floats:
    """Places of bright spots in the whole image, the brightest first."""
    found, _, _ = find_spots(region.pixels)
    usable = sorted((one for one in found if one.snr >= _MIN_SNR), key=lambda one: -one.snr)
    places = [(one.row + region.box.row, one.col + region.box.col) for one in usable]
    return np.array(places, dtype=np.float64).reshape(-1, 2)


def _pattern_shift(points: Floats, spots: Floats, search_px: float) -> tuple[Floats, Floats]:
    """The shift with which most points have a spot near them, and which points these are.

    Every pair of a point and a spot proposes one; of those that match equally many the smallest.
    """
    none = np.zeros(len(points), bool)
    if not len(spots):
        return np.zeros(2), none
    proposed = (spots[np.newaxis] - points[:, np.newaxis]).reshape(-1, 2)
    proposed = proposed[np.hypot(proposed[:, 0], proposed[:, 1]) <= search_px]
    if not len(proposed):
        return np.zeros(2), none
    votes = np.array([_matched(points + shift, spots).sum() for shift in proposed])
    size = np.hypot(proposed[:, 0], proposed[:, 1])
    best = proposed[np.lexsort((size, -votes))[0]]
    matched = _matched(points + best, spots)
    away = spots[np.newaxis] - (points[matched] + best)[:, np.newaxis]
    nearest = np.hypot(away[..., 0], away[..., 1]).argmin(axis=1)
    refined = best + np.median(away[np.arange(len(nearest)), nearest], axis=0)
    return refined, _matched(points + refined, spots)


def _matched(points: Floats, spots: Floats) -> Floats:
    away = spots[np.newaxis] - points[:, np.newaxis]
    return np.asarray(np.hypot(away[..., 0], away[..., 1]).min(axis=1) <= _NEAR_PX)
