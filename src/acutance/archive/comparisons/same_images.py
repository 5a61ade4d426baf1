"""The difference of two groups that were measured in the same images."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acutance.archive.comparisons.degrees import StdPart, joined_std, part_of_mean
from acutance.archive.comparisons.pairing import MIN_IMAGES, Basis, Pairs
from acutance.archive.comparisons.target_part import target_part
from acutance.archive.trends.images import image_means
from acutance.archive.trends.series import Series
from acutance.archive.weighted_means import weighted_mean

__all__ = ["RandomDifference", "difference_of_pairs"]


@dataclass(frozen=True)
class RandomDifference:
    """First minus second, before what does not average out is added.

    Attributes
    ----------
    basis : str
    value : float
    part : StdPart
    level : float
        Mean of both.
    scatter : float or None
        Of the differences between images, beyond their stated deviations.
    images : (int, int)
        Of the first group and of the second.
    notes : tuple of str
    """

    basis: Basis
    value: float
    part: StdPart
    level: float
    scatter: float | None
    images: tuple[int, int]
    notes: tuple[str, ...] = ()


def difference_of_pairs(pairs: Pairs) -> RandomDifference:
    """The mean difference with its deviation, by the scatter between images.

    Images are the units: what one image does to all of its pairs is one number. Of fewer than
    three images with at least three pairs the pairs are.
    """
    images = np.unique(pairs.image).size
    by_image = images >= MIN_IMAGES or pairs.value.size < MIN_IMAGES
    unit = pairs.image if by_image else np.arange(pairs.value.size)
    means = image_means(
        Series(
            metric="", when=np.zeros(pairs.value.size), value=pairs.value, std=pairs.std,
            image=unit,
        )
    )  # fmt: skip
    unknown = np.isnan(pairs.std).all()
    std = np.full(means.size, np.nan) if unknown else np.sqrt(means.variance)
    mean = weighted_mean(means.value, std)
    part = part_of_mean(mean)
    targets = list(_target_parts(pairs)) if images > 1 and by_image else []
    scatter = mean.scatter.value
    return RandomDifference(
        pairs.basis, mean.mean.value, joined_std(part, *targets), pairs.level,
        scatter if np.isfinite(scatter) else None, (images, images),
        tuple(_notes(pairs, images, by_image)),
    )  # fmt: skip


def _target_parts(pairs: Pairs) -> Iterator[StdPart]:
    """What differs between targets: of the differences, or of each group if it has its own."""
    sides = (pairs,) if pairs.basis != "image" else (pairs.first, pairs.second)
    for side in sides:
        part = target_part(side.value, side.image, side.target)
        if part is not None:
            yield part


def _notes(pairs: Pairs, images: int, by_image: bool) -> Iterator[str]:
    if images == 1 and pairs.value.size == 1:
        yield "One image: how the difference scatters between images is not known."
    elif not by_image:
        yield (
            f"The deviation is by the scatter of the pairs: {images} image"
            f"{'s do' if images > 1 else ' does'} not show what an image does to all of its pairs."
        )
    if images > 1:
        names = {pairs.first.name: pairs.first, pairs.second.name: pairs.second}
        alone = [
            name
            for name, one in names.items()
            if len(set(one.target)) == 1 and one.target[0] is not None
        ]
        if alone:
            of = "each group" if len(alone) == 2 else alone[0]
            yield f"One target of {of}: what is peculiar to it is part of the difference."
