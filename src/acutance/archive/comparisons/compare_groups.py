"""From rows of an archive to the answer whether groups of them differ."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations
from numbers import Real
from typing import Final

import numpy as np

from acutance.archive.columns import Columns
from acutance.archive.comparisons.comparison import Comparison, GroupScatter
from acutance.archive.comparisons.degrees import StdPart, joined_std
from acutance.archive.comparisons.difference import Difference
from acutance.archive.comparisons.groups import MeasuredGroup, Stratum, strata_of
from acutance.archive.comparisons.means import difference_of_means
from acutance.archive.comparisons.pairing import find_pairs
from acutance.archive.comparisons.same_images import difference_of_pairs
from acutance.archive.weighted_means import weighted_mean
from acutance.curves import Estimate
from acutance.errors import OptionError

__all__ = ["MARGIN", "compare_groups"]

MARGIN: Final = 0.05
"""Relative difference below which groups are said to agree: what methods are trusted to."""
_SEVERAL: Final = 3


def compare_groups(
    rows: Columns, metric: str, by: str = "orientation", *, margin: float = MARGIN
) -> Comparison:
    """Whether groups of measurements differ, all else being the same.

    Groups that were measured in the same images are compared there, so that what an image does to
    both cancels; others by their means, with a drift of the sensor allowed for.

    Parameters
    ----------
    rows : Columns
        Of `acutance.Archive.measurements`.
    metric : str
    by : {"orientation", "method", "kind", "band", "level", "sensor", "site", "target"}, optional
    margin : float, optional
        Relative difference below which groups are said to agree.

    Returns
    -------
    Comparison

    Raises
    ------
    OptionError
        If there is no such metric or group, or there are too many groups.
    NothingSelectedError
        If there are no rows.
    """
    if not (isinstance(margin, Real) and 0 < margin < math.inf):
        raise OptionError(f"margin is {margin!r}: give a relative difference, such as 0.05")
    differences: list[Difference] = []
    scatters = []
    for stratum in strata_of(rows, metric, by):
        found = list(_differences(stratum, metric, by, float(margin)))
        differences += found
        if len(stratum.groups) >= _SEVERAL:
            scatters.append(_scatter(stratum, by, found))
    return Comparison(
        metric=metric, by=by, differences=tuple(differences), scatters=tuple(scatters)
    )


def _differences(stratum: Stratum, metric: str, by: str, margin: float) -> Iterator[Difference]:
    for first, second in combinations(stratum.groups, 2):
        yield _difference(first, second, stratum.name, metric, by, margin)


def _difference(
    first: MeasuredGroup, second: MeasuredGroup, of: str, metric: str, by: str, margin: float
) -> Difference:
    pairs = find_pairs(first, second, by)
    if pairs is None:
        groups = first, second
        found = difference_of_means(first, second, one_sensor=by != "sensor")
    else:
        groups = pairs.first, pairs.second
        found = difference_of_pairs(pairs)
    systematic = math.hypot(*(float(np.mean(one.systematic_std)) for one in groups))
    part = joined_std(found.part, StdPart(systematic))
    level = abs(found.level) or 1.0
    difference = part.estimate(found.value)
    return Difference(
        of=of, metric=metric, by=by, first=first.name, second=second.name, difference=difference,
        relative=(1 / level) * difference, probability=part.probability_above(found.value),
        systematic_std=systematic, scatter=found.scatter, basis=found.basis, images=found.images,
        measurements=(groups[0].value.size, groups[1].value.size), margin=margin,
        notes=(*found.notes, *_mixed(groups, by)),
    )  # fmt: skip


def _mixed(groups: tuple[MeasuredGroup, MeasuredGroup], by: str) -> Iterator[str]:
    """What else differs between the groups than what is compared."""
    if by in ("method", "kind"):
        return
    own = [sorted(set(group.procedure)) for group in groups]
    if own[0] != own[1]:
        yield (
            f"{groups[0].name} was measured by {', '.join(own[0])}, {groups[1].name} by "
            f"{', '.join(own[1])}: what these differ by is part of the difference."
        )


def _scatter(stratum: Stratum, by: str, differences: list[Difference]) -> GroupScatter:
    """Offsets of the groups from their mean, and their scatter.

    With errors of the groups that are independent the variance of a difference is the sum of two
    of them, from which each follows.
    """
    names = [group.name for group in stratum.groups]
    place = {name: at for at, name in enumerate(names)}
    count = len(names)
    value, variance = np.zeros((count, count)), np.zeros((count, count))
    for one in differences:
        at, other = place[one.first], place[one.second]
        value[at, other], value[other, at] = one.relative.value, -one.relative.value
        variance[at, other] = variance[other, at] = np.nan_to_num(one.relative.std) ** 2
    total = variance.sum() / 2 / (count - 1)
    own = np.sqrt(np.maximum((variance.sum(axis=1) - total) / (count - 2), 0.0))
    offset = value.sum(axis=1) / count
    found = weighted_mean(offset, own)
    return GroupScatter(
        of=stratum.name, by=by,
        offsets={name: Estimate(float(offset[at]), float(own[at])) for name, at in place.items()},
        scatter=found.scatter, interval=found.scatter_interval,
    )  # fmt: skip
