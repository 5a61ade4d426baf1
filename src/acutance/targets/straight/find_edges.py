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

from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line
from acutance.numerics.compiled import compiled

__all__ = ["Segment", "find_segments"]

_BIN_DEG = 5.0
_BINS = int(360 / _BIN_DEG)
_MOST_DIRECTIONS = 4
"""In which the line with the most votes is looked for."""
_VOTE = 6
"""Numbers of a vote."""
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
        if votes.shape[1] < _MIN_LENGTH_PX:
            return
        found = _strongest(votes)
        if found is None:
            return
        segment, own = found
        if segment.stop_px - segment.start_px >= _MIN_LENGTH_PX:
            yield segment
        votes = np.compress(~own, votes, axis=1)


def _gradient_votes(image: Floats) -> Floats:
    """Votes of the inner pixels whose whole neighbourhood is known, strong ones only, (6, n).

    Row and column, unit vector (x, y) of the gradient, its magnitude, and the bin of its direction.
    """
    gradient = _sobel(np.ascontiguousarray(image))
    magnitude = gradient[2]
    known = np.isfinite(magnitude)
    if not known.any():
        return np.empty((_VOTE, 0))
    strongest, typical = _usual_magnitudes(magnitude[known])
    return _standing_out(gradient, max(0.2 * strongest, 2 * typical, 1e-300), strongest)


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
    """Votes of the pixels whose gradient exceeds the least, (6, n); none counts too much."""
    _, rows, cols = gradient.shape
    count = 0
    for i in range(rows):
        for j in range(cols):
            count += gradient[2, i, j] > least
    votes, n = np.empty((_VOTE, count)), 0
    for i in range(rows):
        for j in range(cols):
            magnitude = gradient[2, i, j]
            if magnitude > least:
                votes[0, n], votes[1, n] = i + 1, j + 1
                x, y = gradient[0, i, j] / magnitude, gradient[1, i, j] / magnitude
                direction_deg = math.degrees(math.atan2(y, x))
                votes[2, n], votes[3, n] = x, y
                votes[4, n] = min(magnitude, strongest)
                votes[5, n] = int((direction_deg + 180.0) / _BIN_DEG) % _BINS
                n += 1
    return votes


def _strongest(votes: Floats) -> tuple[Segment, NDArray[np.bool_]] | None:
    """The strongest segment and the votes that are its own."""
    total, direction_deg, offset = _favoured_line(votes)
    if not total > 0:
        return None
    row, col, angle, length_px, own = _refined(votes, direction_deg, offset)
    if not length_px > 0:
        return None
    line = Line(row, col, wrap_direction(math.degrees(angle)))
    half_px = 0.5 * length_px
    return Segment(line, -half_px, half_px, float(votes[4, own].sum())), own


@compiled
def _favoured_line(votes: Floats) -> tuple[float, float, float]:
    """The line with the most votes: how many, direction of its normal in degrees, and offset.

    It is looked for in the directions with the most votes, as peaks of the smoothed circular
    histogram.
    """
    histogram = np.zeros(_BINS)
    for k in range(votes.shape[1]):
        histogram[int(votes[5, k])] += votes[4, k]
    smooth = np.empty(_BINS)
    for k in range(_BINS):
        smooth[k] = histogram[k] + histogram[k - 1] + histogram[(k + 1) % _BINS]
    most, favoured_deg, favoured_offset = 0.0, 0.0, 0.0
    tried = np.zeros(_BINS, np.bool_)
    for _ in range(_MOST_DIRECTIONS):
        peak = -1
        for k in range(_BINS):
            is_peak = smooth[k] >= smooth[k - 1] and smooth[k] > smooth[(k + 1) % _BINS]
            if is_peak and not tried[k] and (peak < 0 or smooth[k] >= smooth[peak]):
                peak = k
        if peak < 0:
            break
        tried[peak] = True
        direction_deg = (peak + 0.5) * _BIN_DEG - 180.0
        angle = math.radians(direction_deg)
        total, offset = _favoured_offset(votes, math.cos(angle), math.sin(angle))
        if total > most:
            most, favoured_deg, favoured_offset = total, direction_deg, offset
    return most, favoured_deg, favoured_offset


@compiled
def _favoured_offset(votes: Floats, normal_x: float, normal_y: float) -> tuple[float, float]:
    """The most votes that lines of one direction have, and the offset of the line with them."""
    row, col, x, y, magnitude = votes[0], votes[1], votes[2], votes[3], votes[4]
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


@compiled
def _refined(
    votes: Floats, direction_deg: float, offset: float
) -> tuple[float, float, float, float, NDArray[np.bool_]]:
    """Place a line through the votes near it by weighted least squares, twice.

    Returns
    -------
    row, col : float
        Middle of the longest stretch of votes.
    angle : float
        Of its normal, radians.
    length_px : float
        Of the stretch; 0 where there is none.
    own : (n,) bool array
        The votes that belong to it.
    """
    angle = math.radians(direction_deg)
    row, col, middle = 0.0, 0.0, 0.0
    own, along = np.zeros(votes.shape[1], np.bool_), np.empty(0)
    for reach in (_REACH_PX + 2.0, _REACH_PX):
        x, y = math.cos(angle), math.sin(angle)
        own, along, middle, across, tilt = _line_through(votes, x, y, offset, reach)
        if along.size < _MIN_LENGTH_PX or not math.isfinite(tilt):
            return row, col, angle, 0.0, own
        # The line's points are (offset + across) n + along t, tilted by `tilt`.
        col = x * (offset + across) - y * middle
        row = y * (offset + across) + x * middle
        angle -= math.atan(tilt)
        offset = math.cos(angle) * col + math.sin(angle) * row
    start, stop = _longest_stretch(np.sort(along), _MAX_GAP_PX)
    n = 0
    for k in range(own.size):
        if own[k]:
            own[k] = start <= along[n] <= stop
            n += 1
    centre = 0.5 * (start + stop) - middle
    row += math.cos(angle) * centre
    col -= math.sin(angle) * centre
    return row, col, angle, stop - start, own


@compiled
def _line_through(
    votes: Floats, normal_x: float, normal_y: float, offset: float, reach_px: float
) -> tuple[NDArray[np.bool_], Floats, float, float, float]:
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
    row, col, x, y, magnitude = votes[0], votes[1], votes[2], votes[3], votes[4]
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
