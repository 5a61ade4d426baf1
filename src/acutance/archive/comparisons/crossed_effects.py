"""The mean of numbers that share effects: of their images, of their targets, of both.

Images may all hold the same targets, each its own, or anything in between. The variance of the
mean is then a sum of components that no single grouping shows. From the sums of squares over
images, over targets and over single numbers follows the combination of them whose expectation is
that variance whatever the components (Henderson's method of moments). No component is cut off at
zero on the way: where every image holds one target the outcome is the scatter between the means of
the targets with so many degrees of freedom less one, which is exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.comparisons.degrees import StdPart
from acutance.archive.weighted_means import TRUSTED
from acutance.curves.grid import Floats

__all__ = ["SharedEffect", "crossed_mean"]

_SMALLEST: Final = 1e-3
"""Relative singular value below which two groupings are the same to the data."""


@dataclass(frozen=True, eq=False)
class SharedEffect:
    """An effect that is the same in all numbers of one label.

    Attributes
    ----------
    label : (n,) int array
        From 0 on, of the n numbers.
    stated : (m,) array
        Variance that is stated for each of the m labels: the effect may scatter more, or less.
    """

    label: NDArray[np.intp]
    stated: Floats

    @classmethod
    def of(cls, label: NDArray[np.int64], stated: Floats | None = None) -> SharedEffect:
        """The effect of any integers; `stated` is that of each of the n numbers."""
        _, first, index = np.unique(label, return_index=True, return_inverse=True)
        return cls(index, np.zeros(first.size) if stated is None else stated[first])

    @property
    def size(self) -> int:
        """Number of labels."""
        return int(self.stated.size)


def crossed_mean(value: Floats, effects: Sequence[SharedEffect]) -> tuple[float, StdPart]:
    """The mean of n numbers and its deviation.

    Weights follow from how many numbers share the label of each, not from the values: of a target
    in twenty images and another in two neither counts for nothing.

    Parameters
    ----------
    value : (n,) array
    effects : sequence of SharedEffect
        One of them at least has several labels.

    Returns
    -------
    float
    StdPart
    """
    effects = _distinct(effects)
    weight = _weights(effects)
    crossings = [[_crossing(row, column, weight) for column in effects] for row in effects]
    mean = float(weight @ value)
    square = np.array([
        float((_sums(one, weight * (value - mean)) ** 2).sum()) for one in effects
    ])  # fmt: skip
    total = [_sums(one, weight) for one in effects]
    own = np.array([float((one**2).sum()) for one in total])
    expected = np.array([
        [one.expected_square(np.ones(one.of_column.size)) for one in row] for row in crossings
    ])  # fmt: skip
    stated = np.array([
        sum(one.expected_square(column.stated) for one, column in zip(row, effects, strict=True))
        for row in crossings
    ])  # fmt: skip
    certain = sum(
        float(one.stated @ sums**2) for one, sums in zip(effects, total, strict=True)
    )  # fmt: skip
    share, components = _solved(expected, own, square - stated)
    variance = float(share @ (square - stated)) + certain
    degrees = np.array([
        _degrees(sums, _cluster_variance(row, effects, components))
        for row, sums in zip(crossings, total, strict=True)
    ])  # fmt: skip
    parts = [
        StdPart(max(variance, 0.0) ** 0.5, _joined_degrees(share * square, degrees)),
        # What one grouping alone shows, and what is stated, are least values: few squares may
        # also agree by chance.
        *map(StdPart, np.sqrt(square * own / np.diag(expected)).tolist(), degrees.tolist()),
        StdPart(TRUSTED * certain**0.5),
    ]
    return mean, max(parts, key=_width)


def _width(part: StdPart) -> float:
    return part.estimate(0.0).std


def _sums(effect: SharedEffect, number: Floats) -> Floats:
    return np.asarray(np.bincount(effect.label, number), float)


def _distinct(effects: Sequence[SharedEffect]) -> list[SharedEffect]:
    """Effects without those of one label, and those of equal groupings as one."""
    found: list[SharedEffect] = []
    for one in effects:
        if one.size < 2:
            continue
        for at, other in enumerate(found):
            if one.size == other.size == np.unique(_codes(one, other)).size:
                first = np.unique(one.label, return_index=True)[1]
                stated = other.stated.copy()
                stated[other.label[first]] += one.stated
                found[at] = SharedEffect(other.label, stated)
                break
        else:
            found.append(one)
    return found


def _codes(row: SharedEffect, column: SharedEffect) -> NDArray[np.intp]:
    """One number for the pair of labels of each of the n numbers."""
    return np.asarray(row.label * column.size + column.label)


def _weights(effects: Sequence[SharedEffect]) -> Floats:
    """Shares in the mean: the fewer others share a number's effects, the larger."""
    crowd = np.zeros(effects[0].label.size)
    for one in effects:
        typical = float(np.median(one.stated))
        own = one.stated / typical if typical > 0 else np.ones(one.size)
        crowd += (np.bincount(one.label) * np.maximum(own, 1.0))[one.label]
    weight = 1 / crowd
    return np.asarray(weight / weight.sum())


@dataclass(frozen=True, eq=False)
class _Crossing:
    """Which labels of two effects, `row` and `column`, occur together, p pairs of them.

    `at` and `other` are the labels of each pair, `weight` the weight of its numbers; `of_row` and
    `of_column` the weight of each label.
    """

    at: NDArray[np.intp]
    other: NDArray[np.intp]
    weight: Floats
    of_row: Floats
    of_column: Floats

    def expected_square(self, variance: Floats) -> float:
        """The sum of squares over the row's labels if the column alone scatters, by `variance`."""
        mixed = self.weight * (self.weight - 2 * self.of_row[self.at] * self.of_column[self.other])
        common = (self.of_row**2).sum() * (variance @ self.of_column**2)
        return float((variance[self.other] * mixed).sum() + common)


def _crossing(row: SharedEffect, column: SharedEffect, weight: Floats) -> _Crossing:
    pairs, index = np.unique(_codes(row, column), return_inverse=True)
    at, other = np.divmod(pairs, column.size)
    joint = np.asarray(np.bincount(index, weight), float)
    of_row, of_column = np.bincount(at, joint), np.bincount(other, joint)
    return _Crossing(at, other, joint, np.asarray(of_row), np.asarray(of_column))


def _solved(expected: Floats, own: Floats, square: Floats) -> tuple[Floats, Floats]:
    """How much of each sum of squares makes the variance of the mean; the components."""
    scale = 1 / np.sqrt(np.diag(expected))
    inverse = np.linalg.pinv(scale[:, None] * expected * scale, rcond=_SMALLEST)
    inverse = scale[:, None] * inverse * scale
    return inverse.T @ own, np.maximum(inverse @ square, 0.0)


def _cluster_variance(
    crossings: Sequence[_Crossing], effects: Sequence[SharedEffect], components: Floats
) -> Floats:
    """Variances of the means of the labels of a row of crossings."""
    total = crossings[0].of_row
    found = np.zeros(total.size)
    for one, column, component in zip(crossings, effects, components.tolist(), strict=True):
        own = component + column.stated[one.other]
        found += np.bincount(one.at, own * one.weight**2, total.size)
    found /= total**2
    return found if found.max() > 0 else np.ones(total.size)


def _degrees(weight: Floats, variance: Floats) -> float:
    """Of the weighted sum of squares of independent numbers about their weighted mean.

    Twice the squared expectation over the variance: with M the matrix of the form and S the
    variances, the squared trace of SM over the trace of (SM)².
    """
    square = weight**2
    sides = np.column_stack([weight, square])
    middle = np.array([[square.sum(), -1.0], [-1.0, 0.0]])
    form = sides.T @ (variance[:, None] * sides) @ middle
    cross = sides.T @ ((variance**2 * square)[:, None] * sides) @ middle
    first = float(variance @ square) + float(np.trace(form))
    second = float(variance**2 @ square**2) + 2 * float(np.trace(cross))
    return first**2 / (second + float(np.trace(form @ form)))


def _joined_degrees(parts: Floats, degrees: Floats) -> float:
    """Satterthwaite's degrees of a sum of parts, no fewer than those of its largest part."""
    doubt = float((parts**2 / degrees).sum())
    if not doubt > 0:
        return math.inf
    least = float(degrees[parts > 0].min(initial=math.inf)) if (parts > 0).any() else 1.0
    return max(float(parts.sum()) ** 2 / doubt, least)
