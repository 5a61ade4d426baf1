"""The difference of two groups that were measured in different images.

Each has its own mean over images with random effects, of its targets too where several come again.
A sensor that drifts looks sharper to the method that came first, so a drift common to both groups
is fitted within the groups and taken out; its uncertainty counts by the time between their mean
dates. Where a group has too few images to show its own scatter, levels and drift are fitted
together and have one scatter. Where both saw the same targets, target is compared with target
(`same_targets`). What cannot be told from a drift (a step between two groups that
follow one another) is said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from acutance.archive.comparisons.degrees import StdPart, joined_std, part_of_mean
from acutance.archive.comparisons.groups import MeasuredGroup
from acutance.archive.comparisons.pairing import Basis
from acutance.archive.comparisons.random_difference import RandomDifference
from acutance.archive.comparisons.same_targets import same_targets
from acutance.archive.comparisons.target_cells import mean_of_cells, target_cells
from acutance.archive.comparisons.target_notes import target_notes
from acutance.archive.trends.images import ImageMeans, image_means
from acutance.archive.trends.series import Series
from acutance.archive.trends.tuned import DRIFT_STDS_PER_YEAR
from acutance.archive.weighted_means import weighted_mean
from acutance.curves.grid import Floats

__all__ = ["difference_of_means"]

_DRIFT_STD: Final = math.sqrt(sum(part * std**2 for std, part in DRIFT_STDS_PER_YEAR.items()))
"""Of the prior of a drift, relative to the level: that of trends, as one normal density."""
_APART_YEARS: Final = 0.02
"""Mean dates that are closer need no drift."""
_MIN_DEGREES: Final = 2
"""Left to a group beside a drift, to have a scatter of its own."""
_MOST: Final = 0.5
"""Share of the measurements on common targets from which these alone are asked."""
_Groups = tuple[MeasuredGroup, MeasuredGroup]


@dataclass(frozen=True)
class _Drift:
    """The drift a year, drawn towards none by its prior; `share` of 1 is that of the images."""

    rate: float
    variance: float
    share: float
    degrees: float

    def part(self, years: float) -> StdPart:
        """Its part of a difference; the more of it is the prior's, the better it is known."""
        degrees = self.degrees / self.share**2 if self.share > 0 else math.inf
        return StdPart(math.sqrt(self.variance) * abs(years), degrees)


def difference_of_means(
    first: MeasuredGroup, second: MeasuredGroup, *, one_sensor: bool
) -> RandomDifference:
    """The difference of the means over the whole time.

    Parameters
    ----------
    first, second : MeasuredGroup
    one_sensor : bool
        Whether both are of one sensor, which drifts for both.
    """
    images = _images(first), _images(second)
    level = 0.5 * sum(float(one.value.mean()) for one in images)
    dated = all(np.isfinite(one.when).all() for one in images)
    years = float(images[0].when.mean() - images[1].when.mean()) if dated else 0.0
    has_drift = one_sensor and abs(years) > _APART_YEARS
    drift = _drift(images, level) if has_drift else _Drift(0.0, 0.0, 0.0, math.inf)
    groups = (first, second)
    if drift.rate:
        groups = (_without_drift(first, drift.rate), _without_drift(second, drift.rate))
    basis, value, part = _difference(groups, drift, years)
    notes = tuple(_notes(images, first, second, one_sensor=one_sensor, dated=dated, basis=basis))
    return RandomDifference(
        basis, value - drift.rate * years, part, level, None, (images[0].size, images[1].size),
        notes,
    )  # fmt: skip


def _difference(groups: _Groups, drift: _Drift, years: float) -> tuple[Basis, float, StdPart]:
    """On the targets that both saw, or of means where these are few of many and means tell more."""
    same = same_targets(*groups)
    if same is None:
        return "means", *_difference_apart(groups, drift, years)
    value, part = same.difference()
    part = joined_std(part, drift.part(years))
    if same.share < _MOST:
        found = _difference_apart(groups, drift, years)
        if found[1].estimate(0.0).std < part.estimate(0.0).std:
            return "means", *found
    return "targets", value, part


def _difference_apart(groups: _Groups, drift: _Drift, years: float) -> tuple[float, StdPart]:
    """The means of both, each by itself."""
    images = _images(groups[0]), _images(groups[1])
    spent = _spent_degrees(images) if drift.rate else (0.0, 0.0)
    # What a drift leaves of one or two degrees of freedom is too uneven to be joined.
    least = _MIN_DEGREES if drift.rate else 1
    if all(one.size - 1 - own >= least for one, own in zip(images, spent, strict=True)):
        found = [_mean(group, own) for group, own in zip(groups, spent, strict=True)]
        part = joined_std(*(own for _, own in found), drift.part(years))
    else:
        found = [_over_targets(group) or (_level(group), StdPart(0.0)) for group in groups]
        part = _part_of_one_scatter(images, drift, years)
        part = joined_std(part, *(own for _, own in found))
    return found[0][0] - found[1][0], part


def _images(group: MeasuredGroup) -> ImageMeans:
    return image_means(
        Series(metric="", when=group.when, value=group.value, std=group.std, image=group.image)
    )


def _without_drift(group: MeasuredGroup, rate: float) -> MeasuredGroup:
    """The values as they would be on the mean date of the group's images."""
    middle = float(_images(group).when.mean())
    return replace(group, value=group.value - rate * (group.when - middle))


def _mean(group: MeasuredGroup, spent: float) -> tuple[float, StdPart]:
    """The mean of a group, of whose degrees of freedom a drift has taken some."""
    if (found := _over_targets(group)) is not None:
        return found
    images = _images(group)
    mean = weighted_mean(images.value, np.sqrt(images.variance))
    part, degrees = part_of_mean(mean), mean.count - 1 - spent
    return mean.mean.value, StdPart(part.std * math.sqrt((mean.count - 1) / degrees), degrees)


def _over_targets(group: MeasuredGroup) -> tuple[float, StdPart] | None:
    """The mean of a group over targets that come again; None where there are none."""
    cells = target_cells(group.value, group.std, group.image, group.target)
    return mean_of_cells(cells) if cells.are_shared else None


def _level(group: MeasuredGroup) -> float:
    return float(_images(group).value.mean())


def _part_of_one_scatter(
    images: tuple[ImageMeans, ImageMeans], drift: _Drift, years: float
) -> StdPart:
    """The deviation of a difference of levels and of a drift that have one scatter.

    The images of the smaller group are taken to scatter as all do, or as they do by themselves if
    that is more; a lone one by what is stated for it.
    """
    sizes = [one.size for one in images]
    if sizes == [1, 1]:
        stated = float(np.concatenate([one.variance for one in images]).sum())
        return StdPart(math.sqrt(stated) if min(one.variance[0] for one in images) else math.nan)
    free = sum(sizes) - 2 - bool(drift.rate)
    if free < 1:
        return StdPart(math.nan)
    pooled = sum(float((_off(one.value) ** 2).sum()) for one in images) / free
    of_drift = drift.variance * years**2
    small, large = sorted(images, key=lambda one: one.size)
    few, degrees = _scatter_of_few(small) if small.size < large.size else (0.0, math.inf)
    level, other = max(few, pooled) / small.size, pooled / large.size
    # All grow with the scatter, the drift less the more of it is the prior's.
    by_all = other + drift.share * of_drift
    if few > pooled:
        doubt = level**2 / degrees + by_all**2 / free
    else:
        doubt = (level + by_all) ** 2 / free
    variance = level + other + of_drift
    return StdPart(math.sqrt(variance), variance**2 / doubt if doubt > 0 else math.inf)


def _scatter_of_few(images: ImageMeans) -> tuple[float, float]:
    """The variance that a small group shows by itself, or states for one, and its degrees."""
    if images.size == 1:
        return float(images.variance[0]), math.inf
    free = images.size - 1
    return float((_off(images.value) ** 2).sum()) / free, free


def _spent_degrees(images: tuple[ImageMeans, ImageMeans]) -> tuple[float, float]:
    """What of the one degree of freedom of the drift each group gave."""
    one, other = (float((_off(group.when) ** 2).sum()) for group in images)
    return (one / (one + other), other / (one + other)) if one + other > 0 else (0.0, 0.0)


def _drift(images: tuple[ImageMeans, ImageMeans], level: float) -> _Drift:
    """The drift within both groups."""
    when = np.concatenate([_off(one.when) for one in images])
    value = np.concatenate([_off(one.value) for one in images])
    prior = (_DRIFT_STD * level) ** 2
    square, free = float(when @ when), when.size - 3
    if free < 1 or square == 0:
        return _Drift(0.0, prior, 0.0, math.inf)
    slope = float(when @ value) / square
    variance = float(((value - slope * when) ** 2).sum()) / free / square
    share = prior / (prior + variance)
    return _Drift(slope * share, share * variance, share, free)


def _off(number: Floats) -> Floats:
    return np.asarray(number - number.mean())


def _notes(
    images: tuple[ImageMeans, ImageMeans], first: MeasuredGroup, second: MeasuredGroup, *,
    one_sensor: bool, dated: bool, basis: Basis,
) -> Iterator[str]:  # fmt: skip
    if min(one.size for one in images) < 2:
        lone = [group.name for group, one in zip((first, second), images, strict=True)
                if one.size < 2]  # fmt: skip
        yield f"One image of {' and of '.join(lone)}: its own scatter is not known."
    if basis == "means":
        yield from target_notes(first, second)
    if not one_sensor:
        return
    if not dated:
        yield "Some images have no date: a drift of the sensor is not allowed for."
        return
    ends = [(float(one.when.min()), float(one.when.max())) for one in images]
    if ends[0][1] < ends[1][0] or ends[1][1] < ends[0][0]:
        early, late = (first, second) if ends[0][1] < ends[1][0] else (second, first)
        yield (
            f"{late.name} took over from {early.name}: a step of the sensor in between would look "
            "the same."
        )
