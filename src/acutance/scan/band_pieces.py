"""Pieces of edges in several registered bands: each found once, in the band that shows it best.

A border of the ground is an edge in every band in which its two sides differ, of either sign.
Every band has its own edge points; what the stronger band (gradient over noise) has found already
is left out of the weaker one's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from acutance.curves.grid import Floats
from acutance.geometry.angles import axis_difference, wrap_direction
from acutance.raster import Box
from acutance.scan.edge_points import Gradient, edge_points
from acutance.scan.options import ScanOptions
from acutance.scan.pieces import pieces
from acutance.scan.segments import find_segments
from acutance.scan.windows import Window
from acutance.targets.straight.find_edges import Segment

__all__ = ["UNSEEN", "BandPiece", "Unseen", "band_pieces", "in_band"]

UNSEEN = "its two sides differ too little in this band"
"""What the reason of an edge that a band does not show begins with."""

_NEAR_PX = 3.0
"""Lines of two bands that lie closer, of like direction, are one edge: registered bands are
displaced by less."""
_LIKE_DEG = 15.0
_STEP_PX = 0.5
_ACROSS_PX: Floats = np.arange(-2.0, 2.1, 0.5)
"""Where the gradient of another band is looked for, along the normal."""


class BandPiece(NamedTuple):
    """A piece of an edge, and the band it was found in."""

    segment: Segment
    band: int


class Unseen(NamedTuple):
    """A piece that a band does not show, and why."""

    segment: Segment
    reason: str


def band_pieces(
    slopes: Sequence[Gradient], window: Window, options: ScanOptions
) -> list[BandPiece]:
    """Pieces of edges in the core of a window, in its pixels, each found in one band.

    Parameters
    ----------
    slopes : sequence of Gradient
        Of every band.
    window : Window
    options : ScanOptions
    """
    found = [
        BandPiece(segment, band)
        for band, slope in enumerate(slopes)
        for segment in _segments(slope, window, options)
    ]
    if len(slopes) == 1:
        return found
    strength = [one.segment.strength / slopes[one.band].noise for one in found]
    kept: list[BandPiece] = []
    for place in np.argsort(strength)[::-1]:
        segment, band = found[place]
        free = _longest_free(segment, [one.segment for one in kept if one.band != band])
        if free.stop_px - free.start_px >= options.min_length_px:
            kept.append(BandPiece(free, band))
    return kept


def _segments(slope: Gradient, window: Window, options: ScanOptions) -> Iterator[Segment]:
    """Pieces of the edges of one band."""
    points = edge_points(slope, options.min_gradient_sigmas)
    core, whole = window.core, window.whole
    own = Box(core.row - whole.row, core.col - whole.col, core.height, core.width)
    for segment in find_segments(points, whole.shape, options.min_length_px):
        yield from pieces(segment, own, options.min_length_px, options.max_length_px)


def _longest_free(segment: Segment, others: Sequence[Segment]) -> Segment:
    """The longest part of a segment that no other, of like direction, lies along."""
    along = np.arange(segment.start_px, segment.stop_px + _STEP_PX / 2, _STEP_PX)
    x, y = segment.line.normal
    row, col = segment.line.row + x * along, segment.line.col - y * along
    taken = np.zeros(along.size, bool)
    for other in others:
        line = other.line
        if axis_difference(line.normal_deg, segment.line.normal_deg) < _LIKE_DEG:
            there = line.tangent_distance(row, col)
            inside = (other.start_px - _NEAR_PX < there) & (there < other.stop_px + _NEAR_PX)
            taken |= inside & (np.abs(line.normal_distance(row, col)) < _NEAR_PX)
    if not taken.any():
        return segment
    first, last = _longest_run(~taken)
    start, stop = along[first], along[max(last - 1, first)]
    half = 0.5 * float(stop - start)
    line = replace(segment.line.slid(0.5 * float(start + stop)), length_px=2 * half)
    share = 2 * half / (segment.stop_px - segment.start_px)
    return Segment(line, -half, half, share * segment.strength)


def _longest_run(free: NDArray[np.bool_]) -> tuple[int, int]:
    """Where the longest run of truth begins, and behind its end."""
    steps = np.diff(np.concatenate([[0], free.astype(int), [0]]))
    first, last = np.flatnonzero(steps > 0), np.flatnonzero(steps < 0)
    if first.size == 0:
        return 0, 0
    longest = int(np.argmax(last - first))
    return int(first[longest]), int(last[longest])


def in_band(
    found: Sequence[BandPiece], band: int, slope: Gradient, options: ScanOptions
) -> Iterator[Segment | Unseen]:
    """The pieces as a band shows them, their normals from its dark to its bright side.

    Parameters
    ----------
    found : sequence of BandPiece
        Of all bands.
    band : int
        Number of the band.
    slope : Gradient
        Of the band.
    options : ScanOptions
    """
    for segment, own in found:
        if own == band:
            yield segment
            continue
        rise = _rise(segment, slope)
        if abs(rise) > options.min_gradient_sigmas * slope.noise:
            yield segment if rise > 0 else _turned(segment)
        else:
            yield Unseen(
                segment,
                f"{UNSEEN}: the gradient is "
                f"{abs(rise) / max(slope.noise, 1e-300):.1f} deviations of its noise, at least "
                f"{options.min_gradient_sigmas:g} are needed",
            )


def _rise(segment: Segment, slope: Gradient) -> float:
    """The largest gradient of a band along a segment's normal, the mean over its length."""
    along = np.arange(segment.start_px, segment.stop_px + 0.5, 1.0)
    x, y = segment.line.normal
    row = segment.line.row + x * along + y * _ACROSS_PX[:, None]
    col = segment.line.col - y * along + x * _ACROSS_PX[:, None]
    down, right = (
        ndimage.map_coordinates(part, [row, col], order=1, mode="nearest") for part in slope[:2]
    )
    rises = (y * down + x * right).mean(axis=1)
    return float(rises[np.argmax(np.abs(rises))])


def _turned(segment: Segment) -> Segment:
    """The same stretch with the opposite normal."""
    line = segment.line
    opposite = replace(
        line,
        normal_deg=float(wrap_direction(line.normal_deg + 180.0)),
        curvature_per_px=-line.curvature_per_px,
    )
    return Segment(opposite, -segment.stop_px, -segment.start_px, segment.strength)
