"""Where the groups of bars of an image are, how many bars each has, and their period.

A group stands out of the background as a whole, also where its bars are too fine to be resolved.
Its direction is that of its gradients; number and period come from comparing its profile with those
of finite groups, blurred plainly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import NoBarsError
from acutance.geometry.bar_group import Bars
from acutance.numerics.compiled import compiled
from acutance.targets.periodic.bars_rows import in_rows
from acutance.targets.periodic.tuned import (
    ABOUT_AS_WELL,
    FULL_HEIGHT,
    MAX_GROUP_REST,
    STANDS_OUT,
    SURE_DIRECTION,
)

__all__ = ["find_bars"]

_CLOSE_PX = (2.0, 3.5, 6.0)
_MIN_BLOB_PX = 40
_MAX_BLOBS = 200
_MARGIN_PX = 10
"""Pixels around a part of the image that its direction and its profile depend on."""
_COUNTS = range(2, 16)
_BLUR_PX = 0.65
_BLURS_PX = (0.5, 0.8)
_CLOSER = 3
_MIN_PERIOD_PX = 1.4
_COMMON_DEG = 12.0
_FAR = 6.0


def find_bars(image: Floats, count: int | None = None) -> tuple[tuple[Bars, ...], float]:
    """Find the groups of bars of an image.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel must not be used.
    count : int, optional
        Number of bars in every group; counted unless given.

    Returns
    -------
    groups : tuple of Bars
        The widest period first.
    contrast : float
        Bars minus background, before the sensor.

    Raises
    ------
    NoBarsError
        If nothing in the image is a group of bars, or they have another number of bars.
    """
    known = np.isfinite(image)
    background = float(np.median(image[known]))
    difference = np.where(known, image - background, 0.0)
    low, high = (float(x) for x in np.quantile(difference[known], [0.002, 0.998]))
    sign = 1.0 if high >= -low else -1.0
    height = max(high, -low)
    if not height > 0:
        raise NoBarsError(
            "the region is uniform, without bars: choose a region that holds the groups"
        )
    bright = sign * difference / height
    if count is not None:
        _require_count(_candidates(bright, None)[0], count)
    best, parts = _candidates(bright, count)
    if best:
        counted = [_recounted(one, _usual_count(best)) for one in best]
        return _of_one_kind(counted), sign * height
    if parts > _MAX_BLOBS:
        raise NoBarsError(
            f"{parts} separate parts stand out of the background, more than any target has "
            "groups: choose a region around the groups, or state where they are (groups)"
        )
    raise NoBarsError(
        "no whole group of parallel bars stands out of the background: choose a region that holds "
        "the groups and some background on all sides of them, or state where they are (groups)"
    )


def _candidates(bright: Floats, count: int | None) -> tuple[list[_Candidate], int]:
    """Groups of an image of background 0 and bars 1, and how many parts stood out last."""
    best: list[_Candidate] = []
    min_alone: float = math.inf
    for close in _CLOSE_PX:
        blobs = _blobs(bright, close)
        if len(blobs) > _MAX_BLOBS:
            continue
        measured = [_measured(blob, count) for blob in blobs]
        groups = [one for one in measured if one is not None and one.bars.count > 1]
        # Bars that are wider than the gaps closed stand alone, as a patch of the bars' level does.
        alone = len(measured) - len(groups)
        single = [one.bars for one in measured if one is not None and one.bars.count == 1]
        for row in in_rows(single):
            joined = _measured(_around(bright, row), count)
            if joined is not None and joined.bars.count > 1:
                # A wide bar whose blurred sides are low may have been taken for fine ones.
                groups = [one for one in groups if not _is_inside(one.bars, joined.bars)] + [joined]
                alone -= row.count
        if groups and alone < min_alone:
            best, min_alone = groups, alone
        if best and not min_alone:
            break
    return best, len(blobs)


def _require_count(groups: list[_Candidate], count: int) -> None:
    """Refuse a stated number of bars that explains the widest group far worse than another."""
    if not groups:
        return
    widest = max(groups, key=lambda one: one.bars.period_px)
    found = _recounted(widest, count).bars.count
    if found != count:
        raise NoBarsError(
            f"the widest bars stand in a group of {found}, and {count} were asked for: state the "
            "number that a group has, or none (count), and they are counted"
        )


@dataclass(frozen=True, eq=False)
class _Blob:
    """A part of the image that stands out, in a window around it.

    Attributes
    ----------
    top, left : int
        The window's first row and column.
    bright : (height, width) array
        The image there, 0 background and 1 bars.
    mask : (height, width) bool array
        Which pixels stand out.
    """

    top: int
    left: int
    bright: Floats
    mask: NDArray[np.bool_]


def _blobs(bright: Floats, close_px: float) -> list[_Blob]:
    """Parts of the image that stand out of the background once gaps are closed.

    One that reaches the border is no target: a group is known by its background on all sides.
    """
    whole = ndimage.gaussian_filter(bright, close_px) > STANDS_OUT
    labels, number = ndimage.label(whole)
    cut_off = set(np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]]).tolist())
    size = np.bincount(labels.ravel())
    found = []
    for one, (down, right) in enumerate(ndimage.find_objects(labels, number), 1):
        if size[one] > _MIN_BLOB_PX and one not in cut_off:
            top, left = max(down.start - _MARGIN_PX, 0), max(right.start - _MARGIN_PX, 0)
            window = slice(top, down.stop + _MARGIN_PX), slice(left, right.stop + _MARGIN_PX)
            found.append(_Blob(top, left, bright[window], labels[window] == one))
    return found


def _is_inside(one: Bars, other: Bars) -> bool:
    """Whether the middle of a group lies within another one."""
    return bool(other.holds(np.array(one.row), np.array(one.col)))


def _around(bright: Floats, bars: Bars) -> _Blob:
    """The part of the image that a group of wide bars takes, its gaps included."""
    corners = bars.region
    top, left = (max(math.floor(low) - _MARGIN_PX, 0) for low in corners.min(axis=0))
    bottom, right = (math.ceil(high) + _MARGIN_PX + 1 for high in corners.max(axis=0))
    window = bright[top:bottom, left:right]
    rows, cols = np.indices(window.shape).reshape(2, -1).astype(float)
    inside = bars.holds(rows + top, cols + left)
    return _Blob(top, left, window, inside.reshape(window.shape))


@dataclass(frozen=True)
class _Candidate:
    bars: Bars
    sureness: float
    rest: float
    blob: _Blob


def _usual_count(groups: list[_Candidate]) -> int:
    """The number of bars that most groups have; wide bars are counted surely."""
    votes = np.bincount([one.bars.count for one in groups], [one.bars.period_px for one in groups])
    return int(np.argmax(votes))


def _recounted(one: _Candidate, count: int) -> _Candidate:
    """The group with the usual number of bars, if that explains it about as well."""
    if one.bars.count == count:
        return one
    other = _measured(one.blob, count)
    return other if other is not None and other.rest < 2 * one.rest + ABOUT_AS_WELL else one


def _measured(blob: _Blob, count: int | None) -> _Candidate | None:
    """The group a blob holds, or the one bar it is; nothing if it is neither."""
    near = ndimage.binary_dilation(blob.mask, iterations=2)
    # Differences of neighbours would bias the direction: fine structure is too weak in them.
    down = ndimage.gaussian_filter(blob.bright, 1.0, order=(1, 0))
    right = ndimage.gaussian_filter(blob.bright, 1.0, order=(0, 1))
    xx, yy = float(np.sum(right[near] ** 2)), float(np.sum(down[near] ** 2))
    xy = float(np.sum(right[near] * down[near]))
    sureness = math.hypot(xx - yy, 2 * xy) / max(xx + yy, 1e-300)
    normal = 0.5 * math.degrees(math.atan2(2 * xy, xx - yy))
    normal = normal + 180 if normal <= -45 else normal
    best: tuple[float, Bars] | None = None
    # A group wider than its bars are long may show its ends more than its bars.
    for angle in (normal, normal - 90 if normal > 45 else normal + 90):
        found = _profile_fit(blob, angle, count)
        if found is not None and (best is None or found[0] < best[0]):
            best = found
        if best is not None and sureness > SURE_DIRECTION:
            break
    if best is None or best[0] > MAX_GROUP_REST:
        return None
    return _Candidate(best[1], sureness, best[0], blob)


def _profile_fit(blob: _Blob, normal_deg: float, count: int | None) -> tuple[float, Bars] | None:
    """Share of the profile's variance that the best group leaves, and that group."""
    rows, cols = np.nonzero(ndimage.binary_dilation(blob.mask, iterations=4))
    centre = Bars(float(rows.mean()), float(cols.mean()), normal_deg, 1.0, 1, 1.0)
    across, along = centre.across_and_along(rows.astype(float), cols.astype(float))
    value = blob.bright[rows, cols]
    middle, length = _span(along, value)
    if not length > 6:
        return None
    central = np.abs(along - middle) < 0.3 * length
    bins = np.round(across[central] / 0.25).astype(np.intp)
    start = int(bins.min())
    total = np.bincount(bins - start, value[central])
    number = np.bincount(bins - start)
    kept = number > 0
    places = np.asarray(0.25 * (np.flatnonzero(kept) + start), float)
    value_there = np.asarray(total[kept] / number[kept], float)
    offset, width = _span(across[central], value[central])
    if not width > 3 or np.ptp(value_there) == 0:
        return None
    profile = _Profile.of(places, value_there)
    alone, level = min(profile.rest(offset, 2 * width, 1, blur) for blur in _BLURS_PX)
    counts: Sequence[int] = _COUNTS if count is None else (count,)
    coarse = [
        min(
            (
                profile.rest(offset + move, period, bars, _BLUR_PX)[0]
                for period, move in _trials(width, bars, 9, 5)
            ),
            default=math.inf,
        )
        for bars in counts
    ]
    best = (math.inf, 0.0, 0.0, 0)
    for index in np.argsort(coarse)[:_CLOSER].tolist():
        for period, move in _trials(width, counts[index], 17, 9):
            for blur in _BLURS_PX:
                rest, _ = profile.rest(offset + move, period, counts[index], blur)
                if rest < best[0]:
                    best = (rest, offset + move, period, counts[index])
    rest, place, period, bars = best
    # Fine bars that are not resolved look like one wide bar, but of half the height.
    if level > FULL_HEIGHT and alone < 2 * rest + ABOUT_AS_WELL:
        rest, place, period, bars = alone, offset, 2 * width, 1
    if not bars:
        return None
    x, y = unit_vector(normal_deg)
    row = blob.top + centre.row + place * y + middle * x
    col = blob.left + centre.col + place * x - middle * y
    return rest, Bars(row, col, normal_deg, period, bars, length)


def _trials(width: float, count: int, periods: int, moves: int) -> list[tuple[float, float]]:
    """Periods and places to be tried for a number of bars in a known width."""
    return [
        (float(period), float(move))
        for period in np.linspace(0.9, 1.1, periods) * width / (count - 0.5)
        if period >= _MIN_PERIOD_PX
        for move in np.linspace(-0.4, 0.4, moves) * min(period, 6.0)
    ]


def _span(places: Floats, value: Floats) -> tuple[float, float]:
    """Middle and width of what stands out along one direction, at half of its height."""
    bins = np.round(places).astype(np.intp)
    start = int(bins.min())
    number = np.bincount(bins - start)
    mean = np.bincount(bins - start, value) / np.maximum(number, 1)
    # Bars and gaps make one plateau.
    peak = ndimage.maximum_filter1d(mean, 3)
    level = 0.5 * float(np.quantile(peak, 0.85))
    above = np.flatnonzero(mean > level)
    if above.size < 2 or level <= 0:
        return 0.0, 0.0
    first = _crossing(mean, int(above[0]), -1, level)
    last = _crossing(mean, int(above[-1]), 1, level)
    return start + 0.5 * (first + last), last - first


def _crossing(mean: Floats, inside: int, step: int, level: float) -> float:
    outside = inside + step
    if not 0 <= outside < mean.size:
        return float(inside)
    drop = float(mean[inside] - mean[outside])
    return inside + step * (float(mean[inside]) - level) / drop if drop > 0 else float(inside)


@dataclass(frozen=True, eq=False)
class _Profile:
    """A profile along a normal, to which thousands of groups are compared.

    Parameters
    ----------
    places : (n,) array
    own : (n,) array
        Its values, without their mean.
    power : float
        Sum of the squares of these.
    """

    places: Floats
    own: Floats
    power: float

    @classmethod
    def of(cls, places: Floats, value: Floats) -> _Profile:
        own = value - np.mean(value)
        return cls(places, own, float(own @ own))

    def rest(self, offset: float, period: float, count: int, blur: float) -> tuple[float, float]:
        """Share of its variance that a blurred group leaves, and the group's height in it."""
        scale = math.sqrt(0.5) / math.hypot(blur, 0.29)
        shared, size = _products(self.places, self.own, offset, period, count, scale)
        if not (self.power > 0 and size > 0 and shared > 0):
            return 1.0, 0.0
        return 1 - shared**2 / (size * self.power), shared / size


@compiled
def _products(
    places: Floats, own: Floats, offset: float, period: float, count: int, scale: float
) -> tuple[float, float]:
    """Products of a group of bars with a profile of mean 0 and, without its mean, with itself.

    The bars have the height 1, their edges are erf(scale * x).
    """
    total, squares, shared = 0.0, 0.0, 0.0
    for i in range(places.size):
        edge, level = places[i] - offset + 0.5 * (count - 0.5) * period, 0.0
        for _ in range(count):
            begin, end = edge * scale, (edge - 0.5 * period) * scale
            # Elsewhere the bar is black or white to the last digit.
            if begin > -_FAR and end < _FAR:
                level += 0.5 * (math.erf(begin) - math.erf(end))
            edge -= period
        total += level
        squares += level * level
        shared += level * own[i]
    return shared, squares - total**2 / places.size


def _of_one_kind(found: list[_Candidate]) -> tuple[Bars, ...]:
    """Groups with one common direction where they have nearly the same, the widest period first."""
    groups = []
    for one in found:
        mates = [
            other for other in found
            if abs(other.bars.normal_deg - one.bars.normal_deg) < _COMMON_DEG
        ]  # fmt: skip
        weights = np.array([max(mate.sureness, 0.05) * mate.bars.period_px**2 for mate in mates])
        angles = np.array([mate.bars.normal_deg for mate in mates])
        common = float(weights @ angles / weights.sum())
        bars = one.bars
        groups.append(Bars(bars.row, bars.col, common, bars.period_px, bars.count, bars.length_px))
    return tuple(sorted(groups, key=lambda bars: -bars.period_px))
