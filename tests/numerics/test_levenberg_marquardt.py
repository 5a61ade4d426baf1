"""Least squares of many problems side by side."""

import numpy as np
import pytest
from scipy.optimize import least_squares as one_at_a_time

from acutance.numerics.levenberg_marquardt import Expansion, least_squares

PLACES = np.linspace(0.0, 3.0, 25)


class Decays:
    """Curves ``a exp(-b x)``; every problem has its own values, and counts what is asked."""

    def __init__(self, values):
        self.values, self.asked = values, np.zeros(len(values), int)

    def residual(self, p, i):
        return p[0] * np.exp(-p[1] * PLACES) - self.values[i]

    def slopes(self, p):
        falls = np.exp(-p[1] * PLACES)
        return np.stack([falls, -p[0] * PLACES * falls], axis=1)

    def costs(self, x, which):
        self.asked[which] += 1
        with np.errstate(over="ignore", invalid="ignore"):
            return np.array([
                np.sum(self.residual(p, i) ** 2) for p, i in zip(x, which, strict=True)
            ])  # fmt: skip

    def expansions(self, x, which):
        slopes = [self.slopes(p) for p in x]
        gradient = [one.T @ self.residual(p, i) for one, p, i in zip(slopes, x, which, strict=True)]
        return Expansion(np.array([one.T @ one for one in slopes]), np.array(gradient))


@pytest.fixture
def decays():
    rng = np.random.default_rng(8)
    true = np.stack([rng.uniform(0.5, 4.0, 30), rng.uniform(0.1, 3.0, 30)], axis=1)
    values = true[:, :1] * np.exp(-true[:, 1:] * PLACES)
    return Decays(values + 0.02 * rng.standard_normal(values.shape))


def solved(problems, starts, most=60):
    return least_squares(problems, starts, np.ones_like(starts), most=most, settled=1e-9, flat=1e-9)


def test_all_problems_come_to_where_one_at_a_time_does(decays):
    starts = np.ones((30, 2))
    x, cost = solved(decays, starts)
    for i, (own, least) in enumerate(zip(x, cost, strict=True)):
        alone = one_at_a_time(decays.residual, starts[i], lambda p, i: decays.slopes(p), args=(i,))
        np.testing.assert_allclose(own, alone.x, rtol=1e-4)
        assert least == pytest.approx(2 * alone.cost, rel=1e-8)


def test_problems_do_not_know_of_each_other(decays):
    starts = np.ones((30, 2))
    x, cost = solved(decays, starts)
    others = Decays(decays.values[[3, 11]])
    alone, alone_cost = solved(others, starts[:2])
    np.testing.assert_array_equal(alone, x[[3, 11]])
    np.testing.assert_array_equal(alone_cost, cost[[3, 11]])


def test_a_problem_that_has_settled_is_asked_no_more(decays):
    at_end, _ = solved(decays, np.ones((30, 2)))
    starts = at_end.copy()
    starts[4] = 3.0, 0.0
    decays.asked[:] = 0
    solved(decays, starts)
    assert decays.asked[4] > 4 > np.delete(decays.asked, 4).max()


def test_no_problem_is_evaluated_more_often_than_allowed(decays):
    x, cost = solved(decays, np.full((30, 2), 20.0), most=5)
    assert decays.asked.max() == 5
    assert np.all(cost <= decays.costs(np.full((30, 2), 20.0), np.arange(30)))
    np.testing.assert_array_equal(cost, decays.costs(x, np.arange(30)))


def test_units_of_parameters_do_not_matter(decays):
    """With changes in the same units the steps are the same."""
    unit = np.array([1e3, 1e-4])

    class OtherUnits(Decays):
        def costs(self, x, which):
            return super().costs(x * unit, which)

        def expansions(self, x, which):
            gram, gradient = super().expansions(x * unit, which)
            return Expansion(gram * np.outer(unit, unit), gradient * unit)

    starts = np.ones((30, 2))
    x, _ = solved(decays, starts)
    found, _ = least_squares(
        OtherUnits(decays.values), starts / unit, np.ones_like(starts) / unit,
        most=60, settled=1e-9, flat=1e-9,
    )  # fmt: skip
    np.testing.assert_allclose(found * unit, x, rtol=1e-6)


def test_a_step_to_where_nothing_is_known_is_taken_back(decays):
    """Beyond a fence next to where the sums are least there are no numbers."""
    expected, _ = solved(decays, np.ones((30, 2)))
    fence = expected[:, 1] * 1.01
    beyond = []

    class Fenced(Decays):
        def costs(self, x, which):
            outside = x[:, 1] > fence[which]
            beyond.append(np.count_nonzero(outside))
            return np.where(outside, np.nan, super().costs(x, which))

    starts = np.tile([1.0, 0.05], (30, 1))
    x, _ = solved(Fenced(decays.values), starts, most=200)
    assert sum(beyond) > 20
    np.testing.assert_allclose(x, expected, rtol=1e-3)
