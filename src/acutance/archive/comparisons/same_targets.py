"""The difference of two groups that saw the same targets, in different images.

Two sensors over one catalogue of targets: what is peculiar to a target is in the numbers of both,
and cancels where target is compared with target. What it does to one of them alone (a soft border
is softer to pixels that are smaller) is how much the differences scatter between targets, which
they show themselves: nothing is assumed of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.comparisons.crossed_effects import SharedEffect, crossed_mean
from acutance.archive.comparisons.degrees import StdPart
from acutance.archive.comparisons.groups import MeasuredGroup, Target
from acutance.archive.comparisons.pairing import MIN_IMAGES
from acutance.archive.comparisons.target_cells import TargetCells, numbered_cells

__all__ = ["SameTargets", "same_targets"]

_MIN_TARGETS: Final = 3
"""That both groups hold: how differences of two scatter is hardly known."""
_MAX_PARTNERS: Final = 64
"""Of one image, among those of the other group: more of them tell nothing more."""


@dataclass(frozen=True, eq=False)
class SameTargets:
    """What two groups measured of the targets that both hold.

    Attributes
    ----------
    first, second : TargetCells
        Their targets and sites are numbered alike.
    share : float
        Of the measurements of that group of which less is left.
    """

    first: TargetCells
    second: TargetCells
    share: float

    def difference(self) -> tuple[float, StdPart]:
        """The mean of the differences of every image with the others of its target."""
        one, other = self._partners()
        first, second = self.first, self.second
        return crossed_mean(
            first.value[one] - second.value[other],
            (
                SharedEffect.of(first.target[one]),
                SharedEffect.of(first.site[one]),
                SharedEffect.of(first.image[one]),
                SharedEffect.of(second.image[other]),
                SharedEffect.of(one, first.variance[one]),
                SharedEffect.of(other, second.variance[other]),
            ),
        )

    def _partners(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Cells of the first group, and those of the second that each is compared with.

        Of many, those that follow one another, as in a dial: each comes as often as any other.
        """
        one, other = [], []
        for target in np.unique(self.first.target):
            own = np.flatnonzero(self.first.target == target)
            others = np.flatnonzero(self.second.target == target)
            count = min(others.size, max(_MAX_PARTNERS, -(-others.size // own.size)))
            place = count * np.arange(own.size)[:, None] + np.arange(count)
            one.append(np.repeat(own, count))
            other.append(others[place.ravel() % others.size])
        return np.concatenate(one), np.concatenate(other)


def same_targets(first: MeasuredGroup, second: MeasuredGroup) -> SameTargets | None:
    """What two groups have of the same targets; None of too few of them, or in too few images.

    Parameters
    ----------
    first, second : MeasuredGroup
    """
    common = set(first.target) & set(second.target) - {None}
    if len(common) < _MIN_TARGETS:
        return None
    kept = [_where(group, common) for group in (first, second)]
    if min(np.unique(group.image).size for group in kept) < MIN_IMAGES:
        return None
    of_all = zip(kept, (first, second), strict=True)
    share = min(own.value.size / group.value.size for own, group in of_all)
    one, other = (_cells(group, sorted(common, key=str)) for group in kept)
    return SameTargets(one, other, share)


def _where(group: MeasuredGroup, targets: set[Target | None]) -> MeasuredGroup:
    return group.where(np.array([one in targets for one in group.target]))


def _cells(group: MeasuredGroup, targets: Sequence[Target | None]) -> TargetCells:
    number = {name: at for at, name in enumerate(targets)}
    target = np.array([number[one] for one in group.target], np.int64)
    sites = {name[0]: at for at, name in enumerate(targets) if name is not None}
    site = np.array([sites[one[0]] for one in group.target if one is not None], np.int64)
    return numbered_cells(group.value, group.std, group.image, target, site)
