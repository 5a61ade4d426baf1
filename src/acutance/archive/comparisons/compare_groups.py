"""From rows of an archive to the answer whether groups of them differ."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from numbers import Real
from typing import Final

import numpy as np

from acutance.archive.columns import Columns
from acutance.archive.comparison_margin import MARGIN
from acutance.archive.comparisons.degrees import StdPart, joined_std
from acutance.archive.comparisons.difference import (
    ABSOLUTE,
    Difference,
    gsds_differ,
    is_of_pixels,
)
from acutance.archive.comparisons.group_comparison import GroupComparison, GroupScatter
from acutance.archive.comparisons.groups import (
    MeasuredGroup,
    Stratum,
    group_names,
    strata_of,
)
from acutance.archive.comparisons.means import difference_of_means
from acutance.archive.comparisons.pairing import find_pairs
from acutance.archive.comparisons.random_difference import RandomDifference
from acutance.archive.comparisons.same_images import difference_of_pairs
from acutance.archive.trends.possible_dates import impossible_date_notes
from acutance.archive.weighted_means import weighted_mean
from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import OptionError

__all__ = ["compare_groups"]

_SEVERAL: Final = 3
_MANY: Final = 2
"""Where groups have so many times the images that hold both, means may tell more."""
_LEAST_SHARE: Final = 0.25
"""Of the smallest variance of a group's differences: the least that is taken for its own."""


def compare_groups(
    rows: Columns, metric: str, by: str = "orientation", *, margin: float = MARGIN
) -> GroupComparison:
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
    GroupComparison

    Raises
    ------
    OptionError
        If there is no such metric or group, or there are too many groups.
    NothingSelectedError
        If there are no rows.
    """
    if not (isinstance(margin, Real) and 0 < margin <= 1):
        raise OptionError(
            f"margin is {margin!r}: give a relative difference between 0 and 1, 0.05 for 5 %"
        )
    differences: list[Difference] = []
    scatters = []
    for stratum in strata_of(rows, metric, by):
        found = list(_differences(stratum, metric, by, float(margin)))
        differences += found
        if len(stratum.groups) >= _SEVERAL:
            scatters.append(_scatter(stratum, by, found))
    return GroupComparison(
        metric=metric, by=by, groups=group_names(rows, metric, by),
        differences=tuple(differences), scatters=tuple(scatters),
        notes=tuple(impossible_date_notes(rows, np.isfinite(rows[metric]))),
    )  # fmt: skip


def _differences(stratum: Stratum, metric: str, by: str, margin: float) -> Iterator[Difference]:
    for first, second in combinations(stratum.groups, 2):
        yield _difference(first, second, stratum.name, metric, by, margin)


def _difference(
    first: MeasuredGroup, second: MeasuredGroup, of: str, metric: str, by: str, margin: float
) -> Difference:
    found, groups = _random_difference(first, second, by)
    systematic = math.hypot(*(float(np.mean(one.systematic_std)) for one in groups))
    part = joined_std(found.part, StdPart(systematic))
    # Numbers that agree to the last digit, without stated deviations, show none.
    part = part if part.std > 0 else StdPart(math.nan)
    level = 1.0 if metric in ABSOLUTE else abs(found.level) or 1.0
    difference = part.estimate(found.value)
    gsds = (groups[0].gsd_m, groups[1].gsd_m)
    return Difference(
        of=of, metric=metric, by=by, first=first.name, second=second.name, difference=difference,
        relative=(1 / level) * difference, probability=part.probability_above(found.value),
        systematic_std=systematic, scatter=found.scatter, basis=found.basis, images=found.images,
        measurements=(groups[0].value.size, groups[1].value.size), margin=margin, gsds_m=gsds,
        notes=(*found.notes, *_mixed(groups, by), *_gsd_notes(groups, metric)),
    )  # fmt: skip


def _random_difference(
    first: MeasuredGroup, second: MeasuredGroup, by: str
) -> tuple[RandomDifference, tuple[MeasuredGroup, MeasuredGroup]]:
    """On the same images, or of means where few of many images hold both and these tell more."""
    pairs = find_pairs(first, second, by)
    if pairs is None:
        return difference_of_means(first, second, one_sensor=by != "sensor"), (first, second)
    together = difference_of_pairs(pairs)
    if _MANY * together.images[0] < min(np.unique(one.image).size for one in (first, second)):
        apart = difference_of_means(first, second, one_sensor=by != "sensor")
        if apart.part.estimate(0.0).std < together.part.estimate(0.0).std:
            note = f"{together.images[0]} images hold both: alone they tell less than the means."
            return replace(apart, notes=(*apart.notes, note)), (first, second)
    return together, (pairs.first, pairs.second)


def _gsd_notes(groups: tuple[MeasuredGroup, MeasuredGroup], metric: str) -> Iterator[str]:
    if is_of_pixels(metric) and gsds_differ(groups[0].gsd_m, groups[1].gsd_m):
        yield (
            f"{groups[0].name} has a GSD of {groups[0].gsd_m:.3g} m, {groups[1].name} of "
            f"{groups[1].gsd_m:.3g} m: numbers per pixel do not tell which is sharper on the "
            "ground."
        )


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
    """Offsets of the groups from their mean, and the scatter of those that have a deviation."""
    names = [group.name for group in stratum.groups]
    place = {name: at for at, name in enumerate(names)}
    value, variance = np.zeros((len(names),) * 2), np.zeros((len(names),) * 2)
    for one in differences:
        at, other = place[one.first], place[one.second]
        value[at, other], value[other, at] = one.relative.value, -one.relative.value
        variance[at, other] = variance[other, at] = one.relative.std**2
    offset = value.sum(axis=1) / len(names)
    own = _own_stds(variance)
    known = np.isfinite(own)
    nothing = Estimate(math.nan, math.nan), (0.0, math.inf)
    found = weighted_mean(offset[known], own[known]) if known.sum() >= _SEVERAL else None
    scatter, interval = nothing if found is None else (found.scatter, found.scatter_interval)
    return GroupScatter(
        of=stratum.name, by=by,
        offsets={name: Estimate(float(offset[at]), float(own[at])) for name, at in place.items()},
        scatter=scatter, interval=interval,
    )  # fmt: skip


def _own_stds(variance: Floats) -> Floats:
    """Deviations of n groups from the variances (n, n) of their differences.

    With errors of the groups that are independent the variance of a difference is the sum of two
    of them, from which each follows. ``nan`` where that is not known.
    """
    known = np.ones(len(variance), bool)
    while np.isnan(variance[np.ix_(known, known)]).any():
        unknown = np.isnan(variance[:, known]).sum(axis=1)
        known[np.argmax(np.where(known, unknown, -1))] = False
    own = np.full(known.size, np.nan)
    count = int(known.sum())
    if count >= _SEVERAL:
        part = variance[np.ix_(known, known)]
        total = part.sum() / 2 / (count - 1)
        least = np.where(np.eye(count) > 0, np.inf, part).min(axis=1)
        found = (part.sum(axis=1) - total) / (count - 2)
        own[known] = np.sqrt(np.maximum(found, _LEAST_SHARE * least))
    return own
