"""The difference of two groups that were measured in the same images."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from acutance.archive.comparisons.degrees import StdPart, part_of_mean
from acutance.archive.comparisons.pairing import MIN_IMAGES, Pairs
from acutance.archive.comparisons.random_difference import RandomDifference
from acutance.archive.comparisons.target_cells import (
    TargetCells,
    difference_of_cells,
    mean_of_cells,
    target_cells,
)
from acutance.archive.comparisons.target_notes import target_notes
from acutance.archive.trends.images import image_means
from acutance.archive.trends.series import Series
from acutance.archive.weighted_means import weighted_mean

__all__ = ["difference_of_pairs"]


def difference_of_pairs(pairs: Pairs) -> RandomDifference:
    """The mean difference with its deviation, by the scatter between images and between targets.

    Images are the units where the same targets do not come again in them: what one image does to
    all of its pairs is one number. Of fewer than three images with at least three pairs the pairs
    are.
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
    scatter = mean.scatter.value
    value, part = mean.mean.value, part_of_mean(mean)
    cells = _cells(pairs)
    if by_image and any(one.are_shared for one in cells):
        value, part = _over_targets(pairs, cells)
    return RandomDifference(
        pairs.basis, value, part, pairs.level, scatter if np.isfinite(scatter) else None,
        (images, images), tuple(_notes(pairs, images, by_image)),
    )  # fmt: skip


def _cells(pairs: Pairs) -> tuple[TargetCells, ...]:
    """Of the pairs, if both are of one target, else of each group."""
    if pairs.basis != "image":
        std = np.nan_to_num(pairs.std)
        return (target_cells(pairs.value, std, pairs.image, pairs.target),)
    return tuple(
        target_cells(group.value, group.std, at, group.target)
        for group, at in ((pairs.first, pairs.first_at), (pairs.second, pairs.second_at))
    )


def _over_targets(pairs: Pairs, cells: tuple[TargetCells, ...]) -> tuple[float, StdPart]:
    if pairs.basis != "image":
        return mean_of_cells(cells[0])
    return difference_of_cells(cells[0], cells[1], pairs.image)


def _notes(pairs: Pairs, images: int, by_image: bool) -> Iterator[str]:
    if images == 1 and pairs.value.size == 1:
        yield "One image: how the difference scatters between images is not known."
    elif not by_image:
        yield (
            f"The deviation is by the scatter of the pairs: {images} image"
            f"{'s do' if images > 1 else ' does'} not show what an image does to all of its pairs."
        )
    if images > 1:
        yield from target_notes(pairs.first, pairs.second)
