"""Pieces of edges: the part of a segment that lies in a window's core, cut to lengths."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from acutance.raster import Box
from acutance.targets.straight.find_edges import Segment

__all__ = ["pieces", "region_box"]


def pieces(
    segment: Segment, core: Box, min_length_px: float, max_length_px: float
) -> Iterator[Segment]:
    """The parts of a segment inside a core, of about equal length.

    Parameters
    ----------
    segment : Segment
        In the pixels that the core is in.
    core : Box
    min_length_px, max_length_px : float
        What is shorter is left out, what is longer is cut.
    """
    start, stop = _inside(segment, core)
    length = stop - start
    if length < min_length_px:
        return
    count = math.ceil(length / max_length_px)
    for k in range(count):
        first, last = start + length * k / count, start + length * (k + 1) / count
        half = 0.5 * (last - first)
        line = replace(segment.line.slid(0.5 * (first + last)), length_px=2 * half)
        share = (last - first) / (segment.stop_px - segment.start_px)
        yield Segment(line, -half, half, share * segment.strength)


def _inside(segment: Segment, core: Box) -> tuple[float, float]:
    """Where along its line a segment enters a box and leaves it."""
    x, y = segment.line.normal
    start, stop = segment.start_px, segment.stop_px
    ends = (
        (segment.line.row, x, core.row - 0.5, core.row + core.height - 0.5),
        (segment.line.col, -y, core.col - 0.5, core.col + core.width - 0.5),
    )
    for at, slope, low, high in ends:
        if abs(slope) < 1e-9:
            if not low <= at < high:
                return 0.0, 0.0
            continue
        first, last = sorted(((low - at) / slope, (high - at) / slope))
        start, stop = max(start, first), min(stop, last)
    return start, stop


def region_box(segment: Segment, half_width_px: float, within: Box) -> Box:
    """The upright box about a piece and so much ground on both sides of it, inside another."""
    x, y = (abs(part) for part in segment.line.normal)
    half = 0.5 * (segment.stop_px - segment.start_px) + 2.0
    down = x * half + y * half_width_px
    right = y * half + x * half_width_px
    row, col = math.floor(segment.line.row - down), math.floor(segment.line.col - right)
    height = math.ceil(segment.line.row + down) - row + 1
    width = math.ceil(segment.line.col + right) - col + 1
    return Box(row, col, height, width).intersection(within) or within
