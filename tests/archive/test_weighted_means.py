"""Means of measurements that disagree."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.archive.weighted_means import weighted_mean

DRAWS = 1000


@pytest.mark.parametrize("scatter", [0.5, 1.5, 6.0])
def test_deviations_are_true_ones(scatter: float) -> None:
    """A deviation 0.8 or 1.25 times the true one leaves these bounds, as the other two show."""
    rng = np.random.default_rng(7)
    held, heavier, lighter, count = 0, 0, 0, 12
    for _ in range(DRAWS):
        std = rng.uniform(0.5, 2, count)
        value = scatter * rng.normal(size=count) + std * rng.normal(size=count)
        mean = weighted_mean(value, std).mean
        held += abs(mean.value) < 1.96 * mean.std
        lighter += abs(mean.value) < 0.8 * 1.96 * mean.std
        heavier += abs(mean.value) < 1.25 * 1.96 * mean.std
    assert 0.93 < held / DRAWS < 0.97
    assert lighter / DRAWS < 0.93
    assert heavier / DRAWS > 0.97


def test_three_measurements_have_long_tails() -> None:
    rng = np.random.default_rng(7)
    draws = (6 * rng.normal(size=3) + rng.normal(size=3) for _ in range(DRAWS))
    means = [weighted_mean(value, 1.0).mean for value in draws]
    held = np.mean([abs(mean.value) < 1.96 * mean.std for mean in means])
    assert 0.93 < held < 0.97


def test_measurements_that_disagree_are_not_weighed_by_their_variances_alone() -> None:
    found = weighted_mean([0.16, 0.20], [0.0001, 0.01])
    assert found.mean.value > 0.1605
    assert found.mean.std > 0.02
    assert found.scatter_interval[0] < found.scatter.value < found.scatter_interval[1]


def test_measurements_that_agree_by_chance_keep_what_they_state() -> None:
    found = weighted_mean([0.1600, 0.1601], [0.003, 0.003])
    assert found.mean.std >= 0.8 * 0.003 / np.sqrt(2) * 0.999
    assert found.scatter_interval == (0.0, pytest.approx(0.003))


def test_what_a_group_shares_does_not_average_out() -> None:
    value, std = np.full(100, 1.0), np.full(100, 0.1)
    one = weighted_mean(value, std, systematic_std=0.05)
    assert one.systematic_std == pytest.approx(0.05)
    assert one.mean.std > 0.05
    two = weighted_mean(value, std, systematic_std=0.05, group=["a", "b"] * 50)
    assert two.systematic_std == pytest.approx(0.05 / np.sqrt(2))


def test_deviations_that_are_not_stated() -> None:
    found = weighted_mean([0.4393, 0.4401, 0.4081, 0.4225, 0.4236, 0.4277], np.nan)
    assert found.mean.value == pytest.approx(0.4269, abs=5e-5)
    assert found.mean.std > 0
    assert np.isnan(weighted_mean([0.09, 0.09], np.nan).mean.std)
    assert np.isnan(weighted_mean([0.09], np.nan).mean.std)


def test_probability_belongs_to_the_interval() -> None:
    found = weighted_mean([1.0, 1.2, 0.9, 1.1], 0.05)
    low, high = found.mean.interval()
    assert found.probability_below(low) == pytest.approx(0.025, abs=1e-4)
    assert found.probability_below(high) == pytest.approx(0.975, abs=1e-4)
    for shared in (0.001, 0.03, 1.0):
        found = weighted_mean([1.0, 1.2, 0.9, 1.1], 0.05, systematic_std=shared)
        low, high = found.mean.interval()
        assert found.probability_below(low) == pytest.approx(0.025, abs=0.003)
        assert found.probability_below(high) == pytest.approx(0.975, abs=0.003)


@pytest.mark.parametrize("shared", [0.5, 5.0])
@pytest.mark.parametrize("count", [2, 3, 4, 10])
def test_a_truth_at_the_limit_is_seldom_surely_below_it(count: int, shared: float) -> None:
    """What measurements share is normal: by Student's t with two of them it was in 12 %."""
    rng = np.random.default_rng(1)
    draws, surely, held = 1000, 0, 0
    for _ in range(draws):
        value = rng.normal() * shared + rng.normal(size=count)
        found = weighted_mean(value, np.ones(count), systematic_std=np.full(count, shared))
        surely += found.probability_below(0.0) > 0.95
        low, high = found.mean.interval()
        held += low <= 0 <= high
    noise = 3 * np.sqrt(0.05 * 0.95 / draws)
    assert surely / draws < 0.05 + noise
    assert held / draws > 0.95 - noise


@pytest.mark.parametrize("value", [[], [1.0, np.nan]])
def test_nothing_has_no_mean(value: list[float]) -> None:
    with pytest.raises(ac.OptionError, match="give at least one, and finite values"):
        weighted_mean(value, 0.1)
