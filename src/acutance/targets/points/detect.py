"""Where the point sources of an image are, and which of its bright spots are none.

A spot is a local maximum of the image, smoothed a little, that stands out of the noise. Whether
it is usable is asked one question after the other; what is not is kept with its reason:

- ``edge``: pixels around it are missing. Where others have all of theirs to compare it with, the
  brightest pixel and its eight neighbours are enough;
- ``saturated``: a pixel reached the detector's limit;
- ``hot pixel``: one pixel alone is bright, no light reached its neighbours;
- ``cosmic ray``: narrower than the other spots in one direction, so no optics made it;
- ``blended``: another source is too near, or it is much wider than the others;
- ``extended``: wider than the points among which it lies, a galaxy;
- ``faint``: its peak is too low, or its size too uncertain to tell a point from a galaxy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, maximum_filter
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.numerics.clipping import piled_up_share
from acutance.numerics.noise import robust_scale, rounding_std
from acutance.targets.points import tuned
from acutance.targets.points.block_background import block_background
from acutance.targets.points.moments import (
    BROAD_WINDOW_PX,
    WINDOW_PX,
    SpotShape,
    half_window_px,
    spot_shape,
)
from acutance.targets.points.population import Population, sharpest_population

__all__ = ["RejectedSpot", "SortedSpots", "Spot", "find_spots", "sort_spots"]

CLEAR_PX: Final = 3
"""Pixels that have to be there on all sides of a source."""
_SMOOTHING_PX: Final = 0.7
_MAX_SPOTS: Final = 2000
_MIN_RING: Final = 16
_SAME_PX: Final = 0.5
"""Spots that are nearer to one another are one."""


@dataclass(frozen=True)
class Spot:
    """A bright spot.

    Parameters
    ----------
    top : (int, int)
        Row and column of the local maximum.
    shape : SpotShape
        Where it is, and how wide.
    peak : float
        Its brightest pixel above the background.
    snr : float
        The same over the noise.
    """

    top: tuple[int, int]
    shape: SpotShape
    peak: float
    snr: float

    @property
    def row(self) -> float:
        """Row of its centroid."""
        return self.shape.row

    @property
    def col(self) -> float:
        """Column of its centroid."""
        return self.shape.col


@dataclass(frozen=True)
class RejectedSpot:
    """A bright spot, or a place that was stated, that is not usable.

    Parameters
    ----------
    row, col : float
    reason : str
        One of the reasons this module's page names, "no source", "unlike" (the others), "left
        out" (not asked for), or "no minimum" (no Gaussian of its own, method "gaussian-2003").
    message : str
        What was found there.
    """

    row: float
    col: float
    reason: str
    message: str


class SortedSpots(NamedTuple):
    """Which spots are usable.

    Attributes
    ----------
    usable : tuple of Spot
    rejected : tuple of RejectedSpot
    mixed : bool
        Whether most of what is bright has a size of its own: stars among galaxies.
    """

    usable: tuple[Spot, ...]
    rejected: tuple[RejectedSpot, ...]
    mixed: bool


def find_spots(image: Floats) -> tuple[tuple[Spot, ...], Floats, float]:
    """All bright spots.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where there is no data.

    Returns
    -------
    spots : tuple of Spot
        Brightest first.
    residual : (rows, cols) array
        The image minus its background.
    noise : float
        Standard deviation of the background's noise.
    """
    known = np.isfinite(image)
    residual = np.where(known, image - block_background(image), 0.0)
    noise = max(
        robust_scale(residual[known]), rounding_std(image[known]),
        1e-9 * float(np.abs(image[known]).max()), 1e-300,
    )  # fmt: skip
    smooth = gaussian_filter(residual, _SMOOTHING_PX)
    tops = (smooth == maximum_filter(smooth, 3)) & known
    # Smoothing leaves this share of white noise.
    level = tuned.STANDS_OUT * noise / (2 * np.sqrt(np.pi) * _SMOOTHING_PX)
    rows, cols = np.nonzero(tops & (smooth > level))
    order = np.argsort(-smooth[rows, cols])[:_MAX_SPOTS]
    found = np.stack([rows[order], cols[order]], axis=1)
    found = found[~_lobes(found, smooth[rows[order], cols[order]])]
    spots = [_spot(residual, (row, col), noise) for row, col in found.tolist()]
    return _each_once(spots), residual, noise


def _each_once(spots: Sequence[Spot]) -> tuple[Spot, ...]:
    """Spots without those whose top touches that of one before them, about the same middle.

    A source halfway between two pixels has two tops where rounding or the want of noise makes them
    equal. Tops apart from one another about one middle are those of no point.
    """
    if not spots:
        return ()
    touching = cKDTree([one.top for one in spots]).query_pairs(1.5)
    again = {max(pair) for pair in touching if _away(spots[pair[0]], spots[pair[1]]) < _SAME_PX}
    return tuple(one for number, one in enumerate(spots) if number not in again)


def _away(one: Spot, other: Spot) -> float:
    """From the middle of one spot to that of another, px."""
    return float(np.hypot(one.row - other.row, one.col - other.col))


def _lobes(tops: NDArray[np.intp], light: Floats) -> NDArray[np.bool_]:
    """Which spots are far fainter than one nearby: rings and lobes of its image."""
    if not light.size:
        return np.zeros(0, bool)
    near = cKDTree(tops).query_ball_point(tops, tuned.LOBE_PX)
    brightest = np.array([light[one].max() for one in near])
    return np.asarray(light < tuned.LOBE_SHARE * brightest)


def _spot(residual: Floats, top: tuple[int, int], noise: float) -> Spot:
    """Peak and shape of what is around the brightest pixel nearby."""
    row, col = _brightest_near(residual, top)
    peak = float(residual[row, col])
    return Spot(top, _shape(residual, (row, col), noise, WINDOW_PX), peak, peak / noise)


def _brightest_near(residual: Floats, top: tuple[int, int]) -> tuple[int, int]:
    """The brightest of a pixel and its eight neighbours."""
    row, col = top
    window = residual[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2]
    up, left = np.unravel_index(int(np.argmax(window)), window.shape)
    return max(row - 1, 0) + int(up), max(col - 1, 0) + int(left)


def _shape(residual: Floats, middle: tuple[int, int], noise: float, window_px: float) -> SpotShape:
    """The shape of what is around a spot's brightest pixel, above what is around that."""
    background, rough = _ring_around(residual, *middle, half_window_px(window_px) + 1)
    return spot_shape(residual, middle, max(noise, rough), background, window_px)


def _ring_around(residual: Floats, row: int, col: int, inner_px: int) -> tuple[float, float]:
    """Level and roughness of the ring of pixels around a spot: grass is not the block's median."""
    outer_px = inner_px + 1
    top, side = max(row - outer_px, 0), max(col - outer_px, 0)
    part = residual[top : row + outer_px + 1, side : col + outer_px + 1]
    down, right = np.arange(top, top + part.shape[0]), np.arange(side, side + part.shape[1])
    away = np.maximum(np.abs(down - row)[:, None], np.abs(right - col))
    ring = part[away >= inner_px]
    if ring.size < _MIN_RING:
        return 0.0, 0.0
    level = float(np.median(ring))
    # Two standard deviations of a scale from so few pixels are chance.
    return level, robust_scale(ring - level) / (1 + 2 * 1.17 / math.sqrt(ring.size))


def sort_spots(
    image: Floats,
    residual: Floats,
    spots: Sequence[Spot],
    *,
    saturation: float | None,
    noise: float,
    min_snr: float,
    min_distance_px: float,
    rivals: Sequence[Spot] | None = None,
) -> SortedSpots:
    """The usable spots, and the others with their reasons.

    Parameters
    ----------
    image, residual : (rows, cols) arrays
        As `find_spots` takes and gives them.
    spots : sequence of Spot
    saturation : float or None
        The detector's limit; a lower one where pixels pile up at the largest value.
    noise : float
    min_snr : float
        Minimum peak over the noise.
    min_distance_px : float
        Minimum distance to another source that is not much fainter.
    rivals : sequence of Spot, optional
        All spots of the image, if `spots` are only some of them.
    """
    # 12 bits are often stored in 16: the type's limit is not the detector's.
    limit = min(_limit(image), math.inf if saturation is None else saturation)
    others = spots if rivals is None else rivals
    single = [_own_fault(image, residual, one, limit, noise) for one in spots]
    whole = [one for one, fault in zip(spots, single, strict=True) if fault is None]
    usual = [one for one in whole if one.snr >= min_snr]
    shapes, population = _compared_shapes(residual, usual, noise)
    mixed = population is not None and population.mixed
    narrow, wide = _usual_variances(shapes, population)
    comparable = len(usual) >= tuned.MIN_COMPARED
    kept, rejected = [], []
    for one, reason in zip(spots, single, strict=True):
        lacking = reason is not None and reason[0] == "edge"
        if lacking and comparable and not mixed and _has_core(image, residual, one):
            # Without some pixels moments are too small: the joint fit finds what else is no point.
            reason = reason if _compared(one.shape, -math.inf, wide) else None
        if reason is None and one.snr < min_snr:
            reason = "faint", f"its peak is {one.snr:.1f} times the noise, {min_snr:g} are asked"
        if reason is None and comparable and not lacking:
            reason = _compared(shapes[usual.index(one)], narrow, wide)
        if reason is None and population is not None and mixed:
            reason = population.fault(usual.index(one))
        if reason is None:
            reason = _crowded(one, others, min_distance_px)
        if reason is None:
            kept.append(one)
        else:
            rejected.append(RejectedSpot(one.row, one.col, *reason))
    return SortedSpots(tuple(kept), tuple(rejected), mixed)


def _compared_shapes(
    residual: Floats, usual: Sequence[Spot], noise: float
) -> tuple[list[SpotShape], Population | None]:
    """The shapes that are compared, under a broader window where points are broad, and the points.

    Only where points are few among others is the broader window needed.
    """
    shapes = [one.shape for one in usual]
    population = sharpest_population(shapes)
    if population is None or population.narrow_px2 < tuned.BROAD_PX2:
        return shapes, population
    tops = [_brightest_near(residual, one.top) for one in usual]
    broad = [_shape(residual, top, noise, BROAD_WINDOW_PX) for top in tops]
    found = sharpest_population(broad)
    return (broad, found) if found is not None and found.mixed else (shapes, population)


def _usual_variances(
    shapes: Sequence[SpotShape], population: Population | None
) -> tuple[float, float]:
    """Variances of a point along both axes: of the majority, or of the sharpest population."""
    if population is not None and population.mixed:
        return population.narrow_px2, population.wide_px2
    if not shapes:
        return math.nan, math.nan
    narrow, wide = np.median([(one.narrow_px2, one.wide_px2) for one in shapes], axis=0).tolist()
    return narrow, wide


def _limit(image: Floats) -> float:
    """The largest value, where pixels pile up at it: a detector's limit."""
    known = image[np.isfinite(image)]
    return float(known.max()) if piled_up_share(known) > 0 else math.inf


def _own_fault(
    image: Floats, residual: Floats, one: Spot, limit: float, noise: float
) -> tuple[str, str] | None:
    """What is wrong with a spot by itself."""
    row, col = _brightest_pixel(residual, one)
    clear = _pixels_around(image, row, col, CLEAR_PX)
    side = 2 * CLEAR_PX + 1
    whole = clear.shape == (side, side) and bool(np.isfinite(clear).all())
    core = _has_core(image, residual, one)
    # A hot pixel may be at the limit as well; a source at the limit lights its neighbours.
    peak = float(residual[row, col])
    around = np.abs(_pixels_around(residual, row, col, 1))
    # Eight moduli of noise have this mean, and two of their standard deviations are taken off.
    neighbours = float(around.sum()) - abs(peak) - (8 * 0.80 - 2 * np.sqrt(8.0) * 0.60) * noise
    if core and neighbours < tuned.MIN_NEIGHBOUR_SHARE * peak:
        share = 100 * max(neighbours, 0.0) / peak if peak > 0 else 0.0
        return "hot pixel", f"its neighbours together hold {share:.0f} % of the brightest pixel"
    if np.any(clear[1:-1, 1:-1] >= limit):
        return "saturated", f"a pixel reached {limit:g}, the detector's limit"
    if not whole:
        return "edge", f"pixels within {CLEAR_PX} px of it are missing"
    return None


def _brightest_pixel(residual: Floats, one: Spot) -> tuple[int, int]:
    """The brightest pixel within two of a spot's centroid."""
    row, col = round(one.row), round(one.col)
    part = _pixels_around(residual, row, col, 2)
    up, left = np.unravel_index(int(np.argmax(part)), part.shape)
    return max(row - 2, 0) + int(up), max(col - 2, 0) + int(left)


def _has_core(image: Floats, residual: Floats, one: Spot) -> bool:
    """Whether a spot's brightest pixel and its eight neighbours are there."""
    core = _pixels_around(image, *_brightest_pixel(residual, one), 1)
    return core.size == 9 and bool(np.isfinite(core).all())


def _pixels_around(image: Floats, row: int, col: int, reach_px: int) -> Floats:
    """Those up to so many rows and columns away."""
    part = image[max(row - reach_px, 0) : row + reach_px + 1]
    return part[:, max(col - reach_px, 0) : col + reach_px + 1]


def _compared(shape: SpotShape, narrow: float, wide: float) -> tuple[str, str] | None:
    """What is wrong with a spot, compared to the others."""
    thin = max(shape.narrow_px2, 0.0)
    if shape.narrow_at_most_px2 < min(tuned.NARROW_RATIO * narrow, narrow - tuned.MIN_LACK_PX2):
        if shape.wide_px2 < narrow:
            return (
                "hot pixel",
                f"it is as narrow as one pixel: variances of {thin:.2f} and "
                f"{shape.wide_px2:.2f} px² along its axes, those of the others are at least "
                f"{narrow:.2f}",
            )
        return (
            "cosmic ray",
            f"its minor axis has a variance of {thin:.2f} px², the others {narrow:.2f}",
        )
    if shape.wide_at_least_px2 > tuned.WIDE_RATIO * wide:
        return (
            "blended",
            f"its major axis has a variance of {shape.wide_px2:.2f} px², the others {wide:.2f}",
        )
    return None


def _crowded(one: Spot, others: Sequence[Spot], distance_px: float) -> tuple[str, str] | None:
    for other in others:
        away = _away(one, other)
        if _SAME_PX < away < distance_px and other.peak > tuned.LOBE_SHARE * one.peak:
            return "blended", f"another source is {away:.1f} px away, {distance_px:g} px are asked"
    return None
