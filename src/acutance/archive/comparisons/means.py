"""The difference of two groups that were measured in different images.

Each has its own mean over images with random effects. A sensor that drifts looks sharper to the
method that came first, so a drift common to both groups is fitted within the groups and taken
out; its uncertainty counts by the time between their mean dates. What cannot be told from a drift
(a step between two groups that follow one another) is said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from acutance.archive.comparisons.degrees import StdPart, joined_std, part_of_mean
from acutance.archive.comparisons.groups import MeasuredGroup
from acutance.archive.comparisons.same_images import RandomDifference
from acutance.archive.comparisons.target_part import target_part
from acutance.archive.trends.images import ImageMeans, image_means
from acutance.archive.trends.series import Series
from acutance.archive.trends.tuned import DRIFT_STDS_PER_YEAR
from acutance.archive.weighted_means import WeightedMean, weighted_mean

__all__ = ["difference_of_means"]

_DRIFT_STD: Final = math.sqrt(sum(part * std**2 for std, part in DRIFT_STDS_PER_YEAR.items()))
"""Of the prior of a drift, relative to the level: that of trends, as one normal density."""
_APART_YEARS: Final = 0.02
"""Mean dates that are closer need no drift."""


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
    drift, drift_part = _drift(images, level) if has_drift else (0.0, StdPart(0.0))
    means = [_mean(one, drift) for one in images]
    spent = _spent_degrees(images) if drift else (0.0, 0.0)
    parts = [
        _part(mean, other, one)
        for mean, other, one in zip(means, means[::-1], spent, strict=True)
    ]  # fmt: skip
    targets = [target_part(one.value, one.image, one.target) for one in (first, second)]
    value = means[0].mean.value - means[1].mean.value - drift * years
    return RandomDifference(
        "means", value,
        joined_std(
            *parts, *(part for part in targets if part is not None),
            StdPart(drift_part.std * abs(years), drift_part.degrees),
        ),
        level, None, (images[0].size, images[1].size),
        tuple(_notes(images, first, second, one_sensor=one_sensor, dated=dated)),
    )  # fmt: skip


def _images(group: MeasuredGroup) -> ImageMeans:
    return image_means(
        Series(metric="", when=group.when, value=group.value, std=group.std, image=group.image)
    )


def _mean(images: ImageMeans, drift: float) -> WeightedMean:
    """The mean of a group on its mean date."""
    away = images.when - images.when.mean() if drift else 0.0
    return weighted_mean(images.value - drift * away, np.sqrt(images.variance))


def _spent_degrees(images: tuple[ImageMeans, ImageMeans]) -> tuple[float, float]:
    """What of the one degree of freedom of the drift each group gave."""
    one, other = (float(((group.when - group.when.mean()) ** 2).sum()) for group in images)
    return (one / (one + other), other / (one + other)) if one + other > 0 else (0.0, 0.0)


def _part(mean: WeightedMean, other: WeightedMean, spent: float) -> StdPart:
    """The deviation of a mean; one image scatters as those of the other group do."""
    if mean.count > 1:
        part, degrees = part_of_mean(mean), mean.count - 1 - spent
        if degrees <= 0:
            return StdPart(math.nan)
        return StdPart(part.std * math.sqrt((mean.count - 1) / degrees), degrees)
    stated = 0.0 if math.isnan(mean.mean.std) else mean.mean.std
    if other.count < 2:
        return StdPart(stated or math.nan)
    return StdPart(math.hypot(stated, other.scatter.value), other.count - 1)


def _drift(images: tuple[ImageMeans, ImageMeans], level: float) -> tuple[float, StdPart]:
    """The drift a year within both groups, drawn towards none by its prior."""
    when = np.concatenate([one.when - one.when.mean() for one in images])
    value = np.concatenate([one.value - one.value.mean() for one in images])
    prior = (_DRIFT_STD * level) ** 2
    square, free = float(when @ when), when.size - 3
    if free < 1 or square == 0:
        return 0.0, StdPart(math.sqrt(prior))
    slope = float(when @ value) / square
    variance = float(((value - slope * when) ** 2).sum()) / free / square
    share = prior / (prior + variance)
    return slope * share, StdPart(math.sqrt(share * variance), free)


def _notes(
    images: tuple[ImageMeans, ImageMeans], first: MeasuredGroup, second: MeasuredGroup, *,
    one_sensor: bool, dated: bool,
) -> Iterator[str]:  # fmt: skip
    if min(one.size for one in images) < 2:
        lone = [group.name for group, one in zip((first, second), images, strict=True)
                if one.size < 2]  # fmt: skip
        yield f"One image of {' and of '.join(lone)}: its own scatter is not known."
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
