"""Straight edges in an image, found from its gradient.

The gradient of every pixel votes for a direction; for each direction with many votes the pixels
vote for a line's offset; the pixels next to the winning line then locate it by least squares,
to a tenth of a pixel where the noise allows. It is the first guess of all fits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line
from acutance.numerics.compiled import compiled

__all__ = ["Segment", "find_segments"]

_BIN_DEG = 5.0
_BINS = int(360 / _BIN_DEG)
_BEFORE, _AFTER = np.arange(_BINS) - 1, (np.arange(_BINS) + 1) % _BINS
_WINDOW_COS = math.cos(math.radians(20.0))
_REACH_PX = 2.5
_MIN_LENGTH_PX = 6.0
_MAX_GAP_PX = 4.0


@dataclass(frozen=True)
class Segment:
    """A straight stretch of strong gradient.

    Attributes
    ----------
    line : Line
        Normal from dark to bright; its point is the middle of the stretch.
    start_px, stop_px : float
        Where the stretch begins and ends along the line, from the line's point.
    strength : float
        Contrast times length, in image units times pixels.
    """

    line: Line
    start_px: float
    stop_px: float
    strength: float


@dataclass(frozen=True, eq=False)
class _Votes:
    """Gradient of the pixels that stand out: place, unit vector and magnitude, (n,) each."""

    row: Floats
    col: Floats
    x: Floats
    y: Floats
    magnitude: Floats

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """All of them, in that order."""
        return self.row, self.col, self.x, self.y, self.magnitude

    def only(self, chosen: NDArray[np.bool_]) -> _Votes:
        return _Votes(*(values[chosen] for values in self.arrays))


def find_segments(image: Floats, most: int = 32) -> Iterator[Segment]:
    """Straight edges of an image, the strongest first.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel must not be used.
    most : int, optional
        How many at the most.
    """
    votes = _gradient_votes(image)
    for _ in range(most):
        if votes.magnitude.size < _MIN_LENGTH_PX:
            return
        found = _strongest(votes)
        if found is None:
            return
        segment, own = found
        if segment.stop_px - segment.start_px >= _MIN_LENGTH_PX:
            yield segment
        votes = votes.only(~own)


def _gradient_votes(image: Floats) -> _Votes:
    """Gradient of the inner pixels whose whole neighbourhood is known, strong ones only."""
    gradient = _sobel(np.ascontiguousarray(image))
    magnitude = gradient[2]
    known = np.isfinite(magnitude)
    if not known.any():
        return _Votes(*(np.empty(0) for _ in range(5)))
    strongest, typical = _usual_magnitudes(magnitude[known])
    return _Votes(*_standing_out(gradient, max(0.2 * strongest, 2 * typical, 1e-300), strongest))


@compiled
def _sobel(image: Floats) -> Floats:
    """Gradient by Sobel's operator along columns and rows, and its modulus, (3, rows, cols).

    Of the inner pixels; not finite where one of their neighbours is not.
    """
    rows, cols = image.shape
    found = np.empty((3, max(rows - 2, 0), max(cols - 2, 0)))
    for i in range(rows - 2):
        for j in range(cols - 2):
            left = image[i, j] + 2 * image[i + 1, j] + image[i + 2, j]
            right = image[i, j + 2] + 2 * image[i + 1, j + 2] + image[i + 2, j + 2]
            above = image[i, j] + 2 * image[i, j + 1] + image[i, j + 2]
            below = image[i + 2, j] + 2 * image[i + 2, j + 1] + image[i + 2, j + 2]
            x, y = (right - left) / 8, (below - above) / 8
            found[0, i, j], found[1, i, j], found[2, i, j] = x, y, math.sqrt(x * x + y * y)
    return found


def _usual_magnitudes(magnitude: Floats) -> tuple[float, float]:
    """The strongest gradient without those of a few bad pixels, eight each, and the middle one."""
    few = min(magnitude.size // 40, 34)
    spoiled = max(few, min(magnitude.size // 500, 500))
    places = magnitude.size - 1 - spoiled, magnitude.size // 2
    ordered = np.partition(magnitude, places)
    return float(ordered[places[0]]), float(ordered[places[1]])


@compiled
def _standing_out(gradient: Floats, least: float, strongest: float) -> Floats:
    """Votes of the pixels whose gradient exceeds the least, (5, n); none counts too much."""
    _, rows, cols = gradient.shape
    count = 0
    for i in range(rows):
        for j in range(cols):
            count += gradient[2, i, j] > least
    votes, n = np.empty((5, count)), 0
    for i in range(rows):
        for j in range(cols):
            magnitude = gradient[2, i, j]
            if magnitude > least:
                votes[0, n], votes[1, n] = i + 1, j + 1
                votes[2, n], votes[3, n] = (
                    gradient[0, i, j] / magnitude,
                    gradient[1, i, j] / magnitude,
                )
                votes[4, n] = min(magnitude, strongest)
                n += 1
    return votes


def _strongest(votes: _Votes) -> tuple[Segment, NDArray[np.bool_]] | None:
    """The strongest segment and the votes that are its own."""
    best: tuple[float, float, float] | None = None
    for direction in _favoured_directions(votes):
        total, offset = _favoured_offset(*votes.arrays, *unit_vector(direction))
        if best is None or total > best[0]:
            best = total, direction, offset
    if best is None:
        return None
    return _refined(votes, best[1], best[2])


def _favoured_directions(votes: _Votes, most: int = 4) -> list[float]:
    """Directions with the most votes, as peaks of the smoothed circular histogram."""
    direction_deg = np.degrees(np.arctan2(votes.y, votes.x))
    number = ((direction_deg + 180.0) / _BIN_DEG).astype(np.intp) % _BINS
    histogram = np.bincount(number, votes.magnitude, _BINS)
    smooth = histogram + histogram[_BEFORE] + histogram[_AFTER]
    peaks = (smooth >= smooth[_BEFORE]) & (smooth > smooth[_AFTER]) & (smooth > 0)
    order = np.flatnonzero(peaks)
    order = order[np.argsort(smooth[order])[::-1][:most]]
    return [float((k + 0.5) * _BIN_DEG - 180.0) for k in order]


@compiled
def _favoured_offset(
    row: Floats, col: Floats, x: Floats, y: Floats, magnitude: Floats, normal_x: float,
    normal_y: float,
) -> tuple[float, float]:  # fmt: skip
    """The most votes that lines of one direction have, and the offset of the line with them."""
    near = x * normal_x + y * normal_y > _WINDOW_COS
    offset = normal_x * col + normal_y * row
    first, last = np.inf, -np.inf
    for k in range(row.size):
        if near[k]:
            first, last = min(first, offset[k]), max(last, offset[k])
    if last < first:
        return 0.0, 0.0
    profile = np.zeros(int(last - first) + 3)
    for k in range(row.size):
        if near[k]:
            # Three bins together: the votes of a line lie within the blur's width.
            place = int(offset[k] - first)
            for k_bin in range(place, place + 3):
                profile[k_bin] += magnitude[k]
    best = np.argmax(profile[1:-1])
    return profile[best + 1], first + best + 0.5


def _refined(
    votes: _Votes, direction: float, offset: float
) -> tuple[Segment, NDArray[np.bool_]] | None:
    """Place the line through the votes near it by weighted least squares, twice."""
    angle = math.radians(direction)
    for reach in (_REACH_PX + 2.0, _REACH_PX):
        x, y = math.cos(angle), math.sin(angle)
        own, along, middle, across, tilt = _line_through(*votes.arrays, x, y, offset, reach)
        if along.size < _MIN_LENGTH_PX or not math.isfinite(tilt):
            return None
        # The line's points are (offset + across) n + along t, tilted by `tilt`.
        col = x * (offset + across) - y * middle
        row = y * (offset + across) + x * middle
        angle -= math.atan(tilt)
        offset = math.cos(angle) * col + math.sin(angle) * row
    start, stop = _longest_stretch(np.sort(along), _MAX_GAP_PX)
    if not stop > start:
        return None
    centre = 0.5 * (start + stop) - middle
    x, y = math.cos(angle), math.sin(angle)
    line = Line(row + x * centre, col - y * centre, wrap_direction(math.degrees(angle)))
    inside = (along >= start) & (along <= stop)
    own[own] = inside
    half = 0.5 * (stop - start)
    return Segment(line, -half, half, float(votes.magnitude[own].sum())), own


@compiled
def _line_through(
    row: Floats, col: Floats, x: Floats, y: Floats, magnitude: Floats, normal_x: float,
    normal_y: float, offset: float, reach_px: float,
) -> tuple[NDArray[np.bool_], Floats, float, float, float]:  # fmt: skip
    """The straight line through the votes near another one, by least squares.

    Returns
    -------
    own : (n,) bool array
        The votes near the line and of its direction.
    along : (m,) array
        Their distance along it.
    middle, across : float
        Their centre, along the line and away from it.
    tilt : float
        Slope of the line through them against the first; not finite if they are one point.
    """
    away = normal_x * col + normal_y * row - offset
    own = (np.abs(away) < reach_px) & (x * normal_x + y * normal_y > _WINDOW_COS)
    away, weight = away[own], magnitude[own] ** 2
    along = normal_x * row[own] - normal_y * col[own]
    total, middle, across = 0.0, 0.0, 0.0
    for k in range(along.size):
        total += weight[k]
        middle += weight[k] * along[k]
        across += weight[k] * away[k]
    middle, across = middle / total, across / total
    variance, covariance = 0.0, 0.0
    for k in range(along.size):
        pull = weight[k] * (along[k] - middle)
        variance += pull * along[k]
        covariance += pull * away[k]
    tilt = covariance / variance if variance > 0 else np.nan
    return own, along, middle, across, tilt


@compiled
def _longest_stretch(ordered: Floats, gap_px: float) -> tuple[float, float]:
    """The longest stretch of rising positions without a gap."""
    start, best = 0, (ordered[0], ordered[0])
    for k in range(ordered.size):
        if k > 0 and ordered[k] - ordered[k - 1] > gap_px:
            start = k
        if ordered[k] - ordered[start] > best[1] - best[0]:
            best = ordered[start], ordered[k]
    return best
