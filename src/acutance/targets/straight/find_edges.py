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
from acutance.geometry.angles import direction_difference, wrap_direction
from acutance.geometry.line import Line
from acutance.numerics.noise import median

__all__ = ["Segment", "find_segments"]

_BIN_DEG = 5.0
_BINS = int(360 / _BIN_DEG)
_BEFORE, _AFTER = np.arange(_BINS) - 1, (np.arange(_BINS) + 1) % _BINS
_WINDOW_DEG = 20.0
_REACH_PX = 2.5
_MIN_LENGTH_PX = 6.0


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
    """Gradient of the pixels that stand out: place, direction (degrees) and magnitude."""

    row: Floats
    col: Floats
    direction_deg: Floats
    magnitude: Floats

    def only(self, chosen: NDArray[np.bool_]) -> _Votes:
        return _Votes(
            self.row[chosen], self.col[chosen], self.direction_deg[chosen], self.magnitude[chosen]
        )


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
    """Sobel gradient of the inner pixels whose whole neighbourhood is known, strong ones only."""
    down = image[:-2] + 2 * image[1:-1] + image[2:]
    right = image[:, :-2] + 2 * image[:, 1:-1] + image[:, 2:]
    by_col = (down[:, 2:] - down[:, :-2]) / 8
    by_row = (right[2:] - right[:-2]) / 8
    magnitude = np.sqrt(by_col * by_col + by_row * by_row)
    known = np.isfinite(magnitude)
    if not known.any():
        return _Votes(*(np.empty(0) for _ in range(4)))
    strongest, typical = _usual_strongest(magnitude[known]), median(magnitude[known])
    rows, cols = np.nonzero(known & (magnitude > max(0.2 * strongest, 2 * typical, 1e-300)))
    x, y = by_col[rows, cols], by_row[rows, cols]
    direction = np.degrees(np.arctan2(y, x))
    row, col = (places.astype(float) + 1.0 for places in (rows, cols))
    return _Votes(row, col, direction, np.minimum(magnitude[rows, cols], strongest))


def _usual_strongest(magnitude: Floats) -> float:
    """The strongest gradient without those of a few bad pixels, eight each."""
    few = min(magnitude.size // 40, 34)
    spoiled = max(few, min(magnitude.size // 500, 500))
    place = magnitude.size - 1 - spoiled
    return float(np.partition(magnitude, place)[place])


def _strongest(votes: _Votes) -> tuple[Segment, NDArray[np.bool_]] | None:
    """The strongest segment and the votes that are its own."""
    best: tuple[float, float, float] | None = None
    for direction in _favoured_directions(votes):
        x, y = unit_vector(direction)
        near = direction_difference(votes.direction_deg, direction) < _WINDOW_DEG
        offset = x * votes.col[near] + y * votes.row[near]
        first = float(offset.min())
        profile = np.bincount((offset - first).astype(np.intp), votes.magnitude[near])
        # Three bins together: the votes of a line lie within the blur's width.
        runs = profile.copy()
        runs[1:] += profile[:-1]
        runs[:-1] += profile[1:]
        place = int(np.argmax(runs))
        if best is None or runs[place] > best[0]:
            best = float(runs[place]), direction, first + place + 0.5
    if best is None:
        return None
    return _refined(votes, best[1], best[2])


def _favoured_directions(votes: _Votes, most: int = 4) -> list[float]:
    """Directions with the most votes, as peaks of the smoothed circular histogram."""
    number = ((votes.direction_deg + 180.0) / _BIN_DEG).astype(np.intp) % _BINS
    histogram = np.bincount(number, votes.magnitude, _BINS)
    smooth = histogram + histogram[_BEFORE] + histogram[_AFTER]
    peaks = (smooth >= smooth[_BEFORE]) & (smooth > smooth[_AFTER]) & (smooth > 0)
    order = np.flatnonzero(peaks)
    order = order[np.argsort(smooth[order])[::-1][:most]]
    return [float((k + 0.5) * _BIN_DEG - 180.0) for k in order]


def _refined(
    votes: _Votes, direction: float, offset: float
) -> tuple[Segment, NDArray[np.bool_]] | None:
    """Place the line through the votes near it by weighted least squares, twice."""
    angle = math.radians(direction)
    own = np.zeros(votes.row.size, bool)
    for reach, window in ((_REACH_PX + 2.0, _WINDOW_DEG), (_REACH_PX, _WINDOW_DEG)):
        x, y = math.cos(angle), math.sin(angle)
        distance = x * votes.col + y * votes.row - offset
        own = np.abs(distance) < reach
        own &= direction_difference(votes.direction_deg, math.degrees(angle)) < window
        if np.count_nonzero(own) < _MIN_LENGTH_PX:
            return None
        weight = votes.magnitude[own] ** 2
        weight /= weight.sum()
        along, away = x * votes.row[own] - y * votes.col[own], distance[own]
        middle, across = float(weight @ along), float(weight @ away)
        pull = weight * (along - middle)
        variance = float(pull @ along)
        if variance <= 0:
            return None
        tilt = float(pull @ away) / variance
        # The line's points are (offset + across) n + along t, tilted by `tilt`.
        col = x * (offset + across) - y * middle
        row = y * (offset + across) + x * middle
        angle -= math.atan(tilt)
        offset = math.cos(angle) * col + math.sin(angle) * row
    stretch = _longest_stretch(along)
    if stretch is None:
        return None
    start, stop = stretch
    centre = 0.5 * (start + stop) - middle
    x, y = math.cos(angle), math.sin(angle)
    line = Line(row + x * centre, col - y * centre, wrap_direction(math.degrees(angle)))
    inside = (along >= start) & (along <= stop)
    strength = float(votes.magnitude[own][inside].sum())
    mine = own.copy()
    mine[np.flatnonzero(own)[~inside]] = False
    half = 0.5 * (stop - start)
    return Segment(line, -half, half, strength), mine


def _longest_stretch(along: Floats, gap_px: float = 4.0) -> tuple[float, float] | None:
    """The longest stretch of positions without a gap."""
    ordered = np.sort(along)
    breaks = (ordered[1:] - ordered[:-1] > gap_px).nonzero()[0]
    starts = np.concatenate([[0], breaks + 1])
    stops = np.concatenate([breaks, [ordered.size - 1]])
    lengths = ordered[stops] - ordered[starts]
    longest = int(np.argmax(lengths))
    if lengths[longest] <= 0:
        return None
    return float(ordered[starts[longest]]), float(ordered[stops[longest]])
