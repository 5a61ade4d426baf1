"""The mean of numbers that share images, targets, sites: closed forms; intervals hold."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.archive.comparisons.crossed_effects import SharedEffect, crossed_mean
from acutance.archive.comparisons.target_cells import mean_of_cells, target_cells


def test_one_target_an_image_is_the_scatter_of_the_targets() -> None:
    rng = np.random.default_rng(1)
    target = np.repeat(np.arange(4), 10)
    value = 3 * rng.standard_normal(4)[target] + rng.standard_normal(40)
    mean, part = crossed_mean(value, [SharedEffect.of(np.arange(40)), SharedEffect.of(target)])
    means = value.reshape(4, 10).mean(axis=1)
    assert mean == pytest.approx(means.mean())
    assert part.std == pytest.approx(means.std(ddof=1) / 2)
    assert part.degrees == pytest.approx(3)


def test_every_target_in_every_image_is_the_sum_of_both_scatters() -> None:
    """Mean squares of rows and columns less that of the cells: Henderson's balanced case."""
    rng = np.random.default_rng(2)
    rows, columns = 12, 5
    value = 2 * rng.standard_normal((rows, 1)) + 2 * rng.standard_normal(columns)
    value = value + rng.standard_normal((rows, columns))
    image, target = (place.ravel() for place in np.indices((rows, columns)))
    effects = [SharedEffect.of(one) for one in (image, target, np.arange(image.size))]
    mean, part = crossed_mean(value.ravel(), effects)
    of_rows, of_columns = value.mean(axis=1), value.mean(axis=0)
    off = value - of_rows[:, None] - of_columns + value.mean()
    error = (off**2).sum() / ((rows - 1) * (columns - 1)) / value.size
    variance = of_rows.var(ddof=1) / rows + of_columns.var(ddof=1) / columns - error
    assert mean == pytest.approx(value.mean())
    assert part.std == pytest.approx(np.sqrt(variance))
    assert columns - 1 < part.degrees < rows + columns


def test_neither_of_two_targets_counts_for_nothing() -> None:
    """Twenty images of one and two of another: the mean lies between, and is hardly known."""
    target = np.repeat([0, 1], [20, 2])
    mean, part = crossed_mean(
        target.astype(float), [SharedEffect.of(np.arange(22)), SharedEffect.of(target)]
    )
    assert 0.2 < mean < 0.5
    assert part.degrees == pytest.approx(1)


def test_less_than_what_is_stated_is_never_found() -> None:
    labels = [SharedEffect.of(np.arange(12) // 4), SharedEffect.of(np.arange(12), np.ones(12))]
    _, part = crossed_mean(np.zeros(12), labels)
    assert part.std == pytest.approx(0.8 / np.sqrt(12))


@pytest.mark.parametrize(
    ("seen", "sites"),
    [(np.arange(24) % 4, 4), (np.repeat([0, 1, 2, 3], [15, 4, 3, 2]), 4),
     (np.repeat([0, 1, 2], 8), 1)],
    ids=["balanced", "unbalanced", "one site"],
)  # fmt: skip
def test_intervals_hold_whatever_images_show(seen: np.ndarray, sites: int) -> None:
    rng = np.random.default_rng(3)
    images = np.arange(24)
    held = []
    for _ in range(300):
        value = rng.standard_normal(4)[seen] + 0.7 * rng.standard_normal(24)
        target = [(f"S{one % sites}", f"T{one}") for one in seen.tolist()]
        cells = target_cells(value, np.full(24, 0.5), images, target)
        mean, part = mean_of_cells(cells)
        held.append(abs(mean) < 1.96 * part.estimate(mean).std)
    assert np.mean(held) > 0.92


def test_targets_of_one_image_are_joined_there() -> None:
    target = [("S", "a"), ("S", "b"), ("S", "a"), ("S", "c"), None, None]
    cells = target_cells(np.arange(6.0), np.full(6, 0.1), np.array([1, 1, 2, 2, 3, 3]), target)
    assert cells.image.tolist() == [1, 1, 2, 2, 3]
    assert cells.value.tolist() == pytest.approx([1.0, 0.0, 3.0, 2.0, 4.5])
    assert (cells.target >= 0).tolist() == [False, True, False, True, False]
    assert (cells.site >= 0).tolist() == [True, True, True, True, False]
    assert cells.are_shared
    lone = target_cells(np.arange(2.0), np.full(2, 0.1), np.arange(2), [("S", "a")] * 2)
    assert not lone.are_shared
