"""What is peculiar to targets and sites that come again in image after image.

A target is sharper or softer than the mean of all: it is painted worse, lit otherwise, or rougher.
So is a site. That does not average out over images, and where one target takes over from another it
looks like a change of the sensor. Measurement i of target k in image j is

    y_i = trend(t_j) + u_j + g_k + e_i,        g_k ~ N(0, s^2),

and so with sites. Within an image the sensor is one: what its targets differ by tells their
effects, whatever the sensor did. With Z the membership of measurements, W their weights, and image
means taken out, ``M = Z^T W Z`` and ``r = Z^T W y`` are the normal equations of effects beside free
images (S. R. Searle, Linear Models, 1971, section 7.1). So the effects given s are normal, with the
inverse covariance ``M + 1 / s^2`` and the mean ``m = (M + 1 / s^2)^-1 r``; the evidence of s is

    log p = r^T m / 2 - log det(1 + s^2 M) / 2.

What is left open (the common part of all targets of an image) is left to the regression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.images import ImageMeans, image_means, stated_variance
from acutance.archive.trends.series import Series
from acutance.archive.trends.tuned import FREE_TARGET_STD
from acutance.curves.grid import Floats

__all__ = ["EffectsGiven", "TargetEffects", "effects_and_images"]

_PASSES: Final = 3
_MAX_DIRECTIONS: Final = 12
"""Independent combinations of effects that a regression is given: those that are open most."""
_NOTHING: Final = 1e-4
"""Relative size of a combination that changes no image."""


@dataclass(frozen=True, eq=False)
class EffectsGiven:
    """The effects in the means of j images, if targets differ by a given deviation.

    Attributes
    ----------
    shift : (j,) array
        Their mean, as far as measurements within images tell it.
    columns : (j, k) array
        What remains open: multiples of independent normal numbers of deviation one.
    log_evidence : float
        Of that deviation, by what targets differ within images.
    """

    shift: Floats
    columns: Floats
    log_evidence: float


@dataclass(frozen=True, eq=False)
class TargetEffects:
    """Effects of k targets and sites, of which some come again, in the means of j images.

    Attributes
    ----------
    share : (j, k) array
        Weight of each in the mean of an image.
    information, pull : (k, k) and (k,) array
        What measurements within images say: M and r above.
    taken : (k,) array
        Effects that were taken out of the measurements before the images were joined.
    targets, sites : int
        How many there are.
    in_turn : bool
        Whether targets, or sites, follow one another in time: none comes back after another.
    """

    share: Floats
    information: Floats
    pull: Floats
    taken: Floats
    targets: int = 0
    sites: int = 0
    in_turn: bool = False

    @classmethod
    def none(cls, images: int) -> TargetEffects:
        """Of measurements without targets that come again."""
        return cls(np.zeros((images, 0)), np.zeros((0, 0)), np.zeros(0), np.zeros(0))

    @property
    def are_known(self) -> bool:
        """Whether there are any."""
        return self.pull.size > 0

    @property
    def equal_targets(self) -> float:
        """As many equal ones have as much in common: the images' mean is no better than theirs."""
        squares = float((self.share.mean(axis=0) ** 2).sum())
        return 1 / squares if squares > 0 else 1.0

    def given(self, std: float) -> EffectsGiven:
        """The effects if they have this standard deviation.

        Parameters
        ----------
        std : float
            In the units of the metric.
        """
        power, axes = self._axes
        precision = power + 1 / std**2
        pulled = self.pull @ axes
        mean = axes @ (pulled / precision)
        open_part = (self.share @ axes) / np.sqrt(precision)
        left, size, _ = np.linalg.svd(open_part, full_matrices=False)
        kept = (size > _NOTHING * std)[:_MAX_DIRECTIONS].nonzero()[0]
        evidence = 0.5 * float(pulled @ (pulled / precision))
        evidence -= 0.5 * float(np.log1p(std**2 * power).sum())
        return EffectsGiven(
            self.share @ (mean - self.taken), left[:, kept] * size[kept], evidence
        )  # fmt: skip

    @cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        power, axes = np.linalg.eigh(self.information)
        return np.maximum(power, 0.0), axes

    def joined(self, parts: Sequence[NDArray[np.intp]]) -> TargetEffects:
        """The same where images are joined to places."""
        return replace(self, share=np.array([self.share[part].mean(axis=0) for part in parts]))


def effects_and_images(series: Series) -> tuple[TargetEffects, ImageMeans]:
    """Effects of targets and sites that come again, and the images without what is known of them.

    Parameters
    ----------
    series : Series
        With dates and values (`Series.dated`).
    """
    member = _membership(series)
    images = image_means(series)
    if not member.size:
        return TargetEffects.none(images.size), images
    variance, prior = stated_variance(series.std), (FREE_TARGET_STD * _level(series)) ** 2
    taken = np.zeros(member.shape[1])
    for _ in range(_PASSES):
        # The scatter within images is known once the targets no longer add to it.
        weight = 1 / np.maximum(variance + images.within_std**2, 1e-12 * prior)
        information, pull = _within_images(series, member, weight)
        taken = np.asarray(np.linalg.solve(information + np.eye(pull.size) / prior, pull), float)
        images = image_means(replace(series, value=series.value - member @ taken))
    share = _share_of_images(series, images, member, weight)
    labels = (series.target, series.site)
    found = TargetEffects(
        share, information, pull, taken, _count(series.target), _count(series.site),
        in_turn=any(_follow(label, series.when) for label in labels),
    )  # fmt: skip
    return found, images


def _level(series: Series) -> float:
    return abs(float(np.median(series.value))) or 1.0


def _count(label: NDArray[np.int64] | None) -> int:
    return 0 if label is None else np.unique(label[label >= 0]).size


def _follow(label: NDArray[np.int64] | None, when: Floats) -> bool:
    """Whether several labels stand in blocks in time."""
    if label is None or _count(label) < 2:
        return False
    known = label[label >= 0][np.argsort(when[label >= 0], kind="stable")]
    return bool(1 + np.count_nonzero(np.diff(known)) == _count(label))


def _membership(series: Series) -> Floats:
    """Which measurements are of which target or site that comes again, (n, k)."""
    found: list[NDArray[np.int64]] = []
    for label in (series.target, series.site):
        if label is None:
            continue
        again = _coming_again(label, series.image)
        # One target in all images is what the trend is of.
        if np.unique(again).size < 2 or any(_are_same(again, other) for other in found):
            continue
        found.append(again)
    columns = [label == one for label in found for one in np.unique(label[label >= 0])]
    return np.array(columns, float).T if columns else np.zeros((series.size, 0))


def _coming_again(label: NDArray[np.int64], image: NDArray[np.int64]) -> NDArray[np.int64]:
    """The labels of what is seen in several images; -1 of all else."""
    seen = np.unique(np.column_stack([label, image]), axis=0)[:, 0]
    often = [one for one in np.unique(seen) if one >= 0 and np.count_nonzero(seen == one) > 1]
    return np.where(np.isin(label, often), label, -1)


def _are_same(one: NDArray[np.int64], other: NDArray[np.int64]) -> bool:
    """Whether two labels make the same groups."""
    pairs = np.unique(np.column_stack([one, other]), axis=0).shape[0]
    return bool(pairs == np.unique(one).size == np.unique(other).size)


def _within_images(series: Series, member: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """M and r of the effects, with the means of the images taken out."""
    _, image = np.unique(series.image, return_inverse=True)
    total = np.bincount(image, weight)

    def without_means(column: Floats) -> Floats:
        return column - (np.bincount(image, weight * column) / total)[image]

    inside = np.column_stack([without_means(column) for column in member.T])
    weighted = weight[:, None] * inside
    return weighted.T @ inside, weighted.T @ without_means(series.value)


def _share_of_images(series: Series, images: ImageMeans, member: Floats, weight: Floats) -> Floats:
    """Weights of the effects in the means of the images, in their order, (j, k)."""
    names, image = np.unique(series.image, return_inverse=True)
    total = np.bincount(image, weight)
    share = np.column_stack([np.bincount(image, weight * column) / total for column in member.T])
    return np.asarray(share[np.searchsorted(names, images.label)])
