"""Wide bars stand alone: those that stand in a row, as far apart as they are wide, are a group."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from acutance.geometry.angles import axis_difference
from acutance.geometry.bar_group import Bars

__all__ = ["in_rows"]

_ONE_DIRECTION_DEG: Final = 12.0
_ALIKE: Final = 1.3
"""Ratio of lengths, and of widths, of bars of one group, as they are measured one by one."""
_NEXT: Final = (0.75, 1.3)
"""Distance of two neighbours over the period that their widths tell."""
_ASIDE: Final = 0.25
"""How far neighbours may be displaced along their length, in lengths."""


def in_rows(alone: Sequence[Bars]) -> list[tuple[list[int], Bars]]:
    """Groups of single bars.

    Parameters
    ----------
    alone : sequence of Bars
        Groups of one bar, whose period is twice its width.

    Returns
    -------
    list of (list of int, Bars)
        The numbers of the bars of every row of two and more, and the group that they make.
    """
    rows = [[number] for number in range(len(alone))]
    for number, one in enumerate(alone):
        for other in range(number):
            if _are_neighbours(one, alone[other]):
                first, second = (next(row for row in rows if k in row) for k in (number, other))
                if first is not second:
                    first += second
                    rows.remove(second)
    return [(row, _joined([alone[k] for k in row])) for row in rows if len(row) > 1]


def _are_neighbours(one: Bars, other: Bars) -> bool:
    if axis_difference(one.normal_deg, other.normal_deg) > _ONE_DIRECTION_DEG:
        return False
    for a, b in ((one.length_px, other.length_px), (one.period_px, other.period_px)):
        if max(a, b) > _ALIKE * min(a, b):
            return False
    across, along = one.across_and_along(np.array([other.row]), np.array([other.col]))
    apart = abs(float(across[0])) / math.sqrt(one.period_px * other.period_px)
    aside = abs(float(along[0])) / min(one.length_px, other.length_px)
    return _NEXT[0] < apart < _NEXT[1] and aside < _ASIDE


def _joined(bars: Sequence[Bars]) -> Bars:
    """The group of bars that stand in a row."""
    middle = bars[0]
    normal = middle.normal_deg + float(
        np.mean([(one.normal_deg - middle.normal_deg + 90) % 180 - 90 for one in bars])
    )
    row, col = (float(np.mean([getattr(one, name) for one in bars])) for name in ("row", "col"))
    length = float(np.mean([one.length_px for one in bars]))
    turned = Bars(row, col, normal, middle.period_px, len(bars), length)
    places, _ = turned.across_and_along(
        np.array([one.row for one in bars]), np.array([one.col for one in bars])
    )
    period = float(np.ptp(places)) / (len(bars) - 1)
    return Bars(row, col, normal, period, len(bars), length)
