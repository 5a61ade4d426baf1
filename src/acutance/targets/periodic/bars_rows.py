"""Wide bars stand alone: those that stand in a row, as far apart as they are wide, are a group."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from acutance.geometry.angles import axis_difference, wrap_axis
from acutance.geometry.bar_group import Bars

__all__ = ["in_rows"]

_ONE_DIRECTION_DEG: Final = 12.0
_ALIKE: Final = 1.3
"""Ratio of lengths, and of widths, of bars of one group, as they are measured one by one."""
_NEXT: Final = (0.75, 1.3)
"""Distance of two neighbours over the period that their widths tell."""
_ASIDE: Final = 0.25
"""How far neighbours may be displaced along their length, in lengths."""


def in_rows(alone: Sequence[Bars]) -> list[Bars]:
    """The groups that single bars make: every row of two and more.

    Parameters
    ----------
    alone : sequence of Bars
        Groups of one bar, whose period is twice its width.
    """
    if not alone:
        return []
    near = [
        [j < k and _are_neighbours(one, other) for j, other in enumerate(alone)]
        for k, one in enumerate(alone)
    ]
    count, number = connected_components(csr_array(near), directed=False)
    rows = [[one for one, own in zip(alone, number, strict=True) if own == k] for k in range(count)]
    return [_joined(row) for row in rows if len(row) > 1]


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
    first = bars[0]
    rows, cols, lengths, turns = np.array([
        (one.row, one.col, one.length_px, wrap_axis(one.normal_deg - first.normal_deg))
        for one in bars
    ]).T  # fmt: skip
    group = replace(
        first, row=float(rows.mean()), col=float(cols.mean()), count=len(bars),
        normal_deg=first.normal_deg + float(turns.mean()), length_px=float(lengths.mean()),
    )  # fmt: skip
    places, _ = group.across_and_along(rows, cols)
    return replace(group, period_px=float(np.ptp(places)) / (len(bars) - 1))
