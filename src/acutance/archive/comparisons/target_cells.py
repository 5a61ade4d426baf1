"""Targets in images: what of a group's numbers comes again in every image.

What is peculiar to a target, or to its site, does not average out over images. Targets that are
seen in one image only cannot be told from that image, and are joined there.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.archive.comparisons.crossed_effects import SharedEffect, crossed_mean
from acutance.archive.comparisons.degrees import StdPart
from acutance.archive.comparisons.groups import Target
from acutance.archive.trends.images import image_means
from acutance.archive.trends.series import Series
from acutance.curves.grid import Floats

__all__ = ["TargetCells", "difference_of_cells", "mean_of_cells", "numbered_cells", "target_cells"]


@dataclass(frozen=True, eq=False)
class TargetCells:
    """One mean for every target of every image, n of them.

    Attributes
    ----------
    value, variance : (n,) array
        The variance is the stated one.
    image : (n,) int array
        In rising order.
    target, site : (n,) int array
        Below 0 for what one image alone holds: another number in each.
    """

    value: Floats
    variance: Floats
    image: NDArray[np.int64]
    target: NDArray[np.int64]
    site: NDArray[np.int64]

    @property
    def are_shared(self) -> bool:
        """Whether there are several targets or sites, of which one at least comes again."""
        return any(one.max() >= 0 and np.unique(one).size > 1 for one in (self.target, self.site))


def target_cells(
    value: Floats, std: Floats, image: NDArray[np.int64], target: Sequence[Target | None]
) -> TargetCells:
    """The means of the targets of each image.

    Parameters
    ----------
    value, std : (n,) array
    image : (n,) int array
    target : sequence of n
        Site and name; None where it is not known.
    """
    images = np.unique(image, return_inverse=True)[1]
    which = _coming_again(target, images)
    site = _coming_again([None if one is None else one[0] for one in target], images)
    return numbered_cells(value, std, image, which, site)


def numbered_cells(
    value: Floats, std: Floats, image: NDArray[np.int64], target: NDArray[np.int64],
    site: NDArray[np.int64],
) -> TargetCells:  # fmt: skip
    """The same where targets and sites have numbers.

    Parameters
    ----------
    value, std : (n,) array
    image, target, site : (n,) int array
    """
    names, images = np.unique(image, return_inverse=True)
    cells = np.column_stack([images, target])
    pairs, first, label = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    label = label.reshape(-1)
    means = image_means(
        Series(metric="", when=label.astype(float), value=value, std=std, image=label)
    )
    return TargetCells(
        means.value, means.variance, names[pairs[:, 0]], pairs[:, 1], site[first]
    )  # fmt: skip


def _coming_again(
    word: Sequence[Hashable | None], image: NDArray[np.intp]
) -> NDArray[np.int64]:  # fmt: skip
    """A number from 0 on for every word of several images; of one image -1 less its number."""
    index = {one: at for at, one in enumerate(dict.fromkeys(word))}
    which = np.array([index[one] for one in word], np.int64)
    seen = np.unique(np.column_stack([which, image]), axis=0)[:, 0]
    comes_again = np.bincount(seen)[which] > 1
    comes_again &= np.array([one is not None for one in word])
    return np.where(comes_again, which, -1 - image)


def mean_of_cells(cells: TargetCells) -> tuple[float, StdPart]:
    """The mean of one group, by what differs between its images, targets and sites."""
    return crossed_mean(
        cells.value,
        (
            SharedEffect.of(cells.image),
            SharedEffect.of(cells.target),
            SharedEffect.of(cells.site),
            SharedEffect.of(np.arange(cells.value.size), cells.variance),
        ),
    )


def difference_of_cells(
    first: TargetCells, second: TargetCells, image: NDArray[np.int64]
) -> tuple[float, StdPart]:
    """The mean of the differences of every two targets in one image, and its deviation.

    Parameters
    ----------
    first, second : TargetCells
        Their images are places in `image`: what is measured there may be told apart further.
    image : (m,) int array
        The image of each place.
    """
    start, end = (np.searchsorted(second.image, first.image, side) for side in ("left", "right"))
    count = end - start
    one = np.repeat(np.arange(count.size), count)
    other = np.arange(one.size) + np.repeat(start - np.cumsum(count) + count, count)
    return crossed_mean(
        first.value[one] - second.value[other],
        (
            SharedEffect.of(image[first.image[one]]),
            SharedEffect.of(first.target[one]),
            SharedEffect.of(second.target[other]),
            SharedEffect.of(first.site[one]),
            SharedEffect.of(one, first.variance[one]),
            SharedEffect.of(other, second.variance[other]),
        ),
    )
