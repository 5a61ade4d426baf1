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
    mean = float(weight @ value)
    square = np.array([
        float((_sums(one, weight * (value - mean)) ** 2).sum()) for one in effects
    ])  # fmt: skip
    total = [_sums(one, weight) for one in effects]
    own = np.array([float((one**2).sum()) for one in total])
    expected = np.array([
        [_expected_square(row, column, weight, np.ones(column.size)) for column in effects]
        for row in effects
    ])  # fmt: skip
    stated = np.array([
        sum(_expected_square(row, column, weight, column.stated) for column in effects)
        for row in effects
    ])  # fmt: skip
    certain = sum(
        float(one.stated @ sums**2) for one, sums in zip(effects, total, strict=True)
    )  # fmt: skip
    share, components = _solved(expected, own, square - stated)
    variance = float(share @ (square - stated)) + certain
    degrees = np.array([
        _degrees(sums, _cluster_variance(one, effects, weight, components))
        for one, sums in zip(effects, total, strict=True)
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
            if one.size == other.size == _both(one, other)[0].size:
                first = np.unique(one.label, return_index=True)[1]
                stated = other.stated.copy()
                stated[other.label[first]] += one.stated
                found[at] = SharedEffect(other.label, stated)
                break
        else:
            found.append(one)
    return found


def _both(one: SharedEffect, other: SharedEffect) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
    """Codes of the pairs of labels that occur, and the place of each number's pair."""
    codes, index = np.unique(one.label * other.size + other.label, return_inverse=True)
    return codes, index


def _weights(effects: Sequence[SharedEffect]) -> Floats:
    """Shares in the mean: the fewer others share a number's effects, the larger."""
    crowd = np.zeros(effects[0].label.size)
    for one in effects:
        typical = float(np.median(one.stated))
        own = one.stated / typical if typical > 0 else np.ones(one.size)
        crowd += (np.bincount(one.label) * np.maximum(own, 1.0))[one.label]
    weight = 1 / crowd
    return np.asarray(weight / weight.sum())


def _expected_square(
    row: SharedEffect, column: SharedEffect, weight: Floats, variance: Floats
) -> float:
    """The sum of squares over the labels of `row` if only `column` scatters, by `variance`."""
    codes, index = _both(row, column)
    joint = np.bincount(index, weight)
    at, other = codes // column.size, codes % column.size
    of_row, of_column = _sums(row, weight), _sums(column, weight)
    own = variance[other]
    return float(
        (own * joint * (joint - 2 * of_row[at] * of_column[other])).sum()
        + (of_row**2).sum() * (variance @ of_column**2)
    )


def _solved(expected: Floats, own: Floats, square: Floats) -> tuple[Floats, Floats]:
    """How much of each sum of squares makes the variance of the mean; the components."""
    scale = 1 / np.sqrt(np.diag(expected))
    inverse = np.linalg.pinv(scale[:, None] * expected * scale, rcond=_SMALLEST)
    inverse = scale[:, None] * inverse * scale
    return inverse.T @ own, np.maximum(inverse @ square, 0.0)


def _cluster_variance(
    row: SharedEffect, effects: Sequence[SharedEffect], weight: Floats, components: Floats
) -> Floats:
    """Variances of the means of the labels of `row`."""
    found = np.zeros(row.size)
    for column, component in zip(effects, components.tolist(), strict=True):
        codes, index = _both(row, column)
        joint = np.bincount(index, weight)
        own = component + column.stated[codes % column.size]
        found += np.bincount(codes // column.size, own * joint**2, row.size)
    found /= _sums(row, weight) ** 2
    return found if found.max() > 0 else np.ones(row.size)


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
