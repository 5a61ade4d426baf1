"""Pairs: what two groups measured of the same thing.

The finest pairs cancel the most. One measurement across and along (points, stars) shares its
pixels and its atmosphere; two methods on one target of one image share them too; two targets of
one image share the atmosphere. Where too few images hold both groups there are no pairs.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from acutance.archive.comparisons.groups import MeasuredGroup, Target
from acutance.archive.trends.images import image_means
from acutance.archive.trends.series import Series
from acutance.curves.grid import Floats

__all__ = ["Basis", "Pairs", "find_pairs"]

Basis = Literal["measurement", "target", "image", "targets", "means"]
"""What two groups have in common: one measurement, one target of one image, one image, the targets
of different images, nothing."""

MIN_IMAGES: Final = 3
"""Images that must hold both groups: the scatter of two differences is hardly known."""

_Keys = list[Hashable | None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Pairs:
    """Differences of pairs, n of them.

    Attributes
    ----------
    basis : "measurement", "target" or "image"
    value, std : (n,) array
        First minus second. No deviation is stated (``nan``) where both are of the same pixels:
        their errors are partly the same, and only the scatter of the differences shows how much.
    level : float
        Mean of both.
    image : (n,) int array
    target : list of tuple or None
        Of pairs on one target.
    first, second : MeasuredGroup
        The measurements of the pairs.
    first_at, second_at : int array
        Of each measurement the place of its pair.
    """

    basis: Basis
    value: Floats
    std: Floats
    level: float
    image: NDArray[np.int64]
    target: list[Target | None]
    first: MeasuredGroup
    second: MeasuredGroup
    first_at: NDArray[np.int64]
    second_at: NDArray[np.int64]


def find_pairs(first: MeasuredGroup, second: MeasuredGroup, by: str) -> Pairs | None:
    """The finest pairs that at least half of the common images hold; None if there are none.

    Parameters
    ----------
    first, second : MeasuredGroup
    by : str
        What is compared: methods may be measured on the same pixels, directions together.
    """
    shared = np.intersect1d(first.image, second.image).size
    alone = np.union1d(first.image, second.image).size - shared
    if shared == 0:
        return None
    finest = None
    for basis, one_procedure in _bases(by):
        pairs = _pairs(basis, first, second, by, one_procedure=one_procedure)
        if pairs is None:
            continue
        images = np.unique(pairs.image).size
        if images >= MIN_IMAGES and 2 * images >= shared:
            return pairs
        finest = finest or pairs
    # One image with many pairs says something, two among forty others do not.
    return finest if alone == 0 else None


def _bases(by: str) -> list[tuple[Basis, bool]]:
    """What both may have in common, the finest first, and whether by one procedure."""
    if by in ("method", "kind"):
        return [("target", False), ("image", False)]
    side_by_side: list[tuple[Basis, bool]] = [("image", True), ("image", False)]
    if by == "orientation":
        return [("measurement", True), *side_by_side]
    return side_by_side if by in ("site", "target") else [("target", True), *side_by_side]


def _pairs(
    basis: Basis, first: MeasuredGroup, second: MeasuredGroup, by: str, *, one_procedure: bool
) -> Pairs | None:  # fmt: skip
    keys = tuple(_keys(basis, group, one_procedure=one_procedure) for group in (first, second))
    common = sorted((set(keys[0]) & set(keys[1])) - {None}, key=str)
    if not common:
        return None
    index = {key: at for at, key in enumerate(common)}
    groups, labels = [], []
    for group, own in zip((first, second), keys, strict=True):
        label = np.array([index.get(key, -1) for key in own])
        groups.append(group.where(label >= 0))
        labels.append(label[label >= 0])
    (value_1, variance_1), (value_2, variance_2) = (
        _means(group, label) for group, label in zip(groups, labels, strict=True)
    )
    at = np.array([np.flatnonzero(labels[0] == one)[0] for one in range(len(common))])
    same_pixels = basis == "measurement" or (basis == "target" and by == "method")
    stated = np.full(len(common), np.nan) if same_pixels else np.sqrt(variance_1 + variance_2)
    return Pairs(
        basis=basis, value=value_1 - value_2, std=stated,
        level=float(np.mean(value_1 + value_2)) / 2,
        image=groups[0].image[at], target=[groups[0].target[one] for one in at.tolist()],
        first=groups[0], second=groups[1], first_at=labels[0], second_at=labels[1],
    )  # fmt: skip


def _keys(basis: Basis, group: MeasuredGroup, *, one_procedure: bool) -> _Keys:
    """What has to be equal in both measurements of a pair; None where that is not known."""
    if basis == "measurement":
        return list(group.measurement.tolist())
    images = group.image.tolist()
    procedures: Sequence[str | None] = group.procedure if one_procedure else [None] * len(images)
    if basis == "image":
        return list(zip(images, procedures, strict=True))
    return [
        None if target is None else (image, target, procedure)
        for image, target, procedure in zip(images, group.target, procedures, strict=True)
    ]


def _means(group: MeasuredGroup, label: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Means and variances of the measurements of each label, in the order of the labels."""
    means = image_means(
        Series(
            metric="", when=label.astype(float), value=group.value, std=group.std, image=label
        )
    )  # fmt: skip
    return means.value, means.variance
