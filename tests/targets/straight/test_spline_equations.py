"""The fast sums over the pixels against the dense design matrix."""

import numpy as np
import pytest

from acutance.targets.straight.spline import HALF_SUPPORT, edge_weights, expand
from acutance.targets.straight.spline_equations import accumulate, renewed

RNG = np.random.default_rng(5)
N = 700
U = RNG.uniform(-HALF_SUPPORT - 2, HALF_SUPPORT + 2, N)
Y = RNG.standard_normal(N)
WEIGHT = RNG.uniform(0.2, 2.0, N)
COLUMNS = RNG.standard_normal((2, N))


def test_sums_are_those_of_the_dense_design():
    found = accumulate([edge_weights(U)], Y, WEIGHT, [COLUMNS], N)
    design = np.hstack([expand(*edge_weights(U)), COLUMNS.T])
    assert np.allclose(found.gram, design.T @ (WEIGHT[:, None] * design), rtol=0, atol=1e-10)
    assert np.allclose(found.projection, design.T @ (WEIGHT * Y), rtol=0, atol=1e-10)
    assert np.isclose(found.data, Y @ (WEIGHT * Y))
    assert found.count == N


@pytest.mark.parametrize("taken", [83, 84, 85])
def test_combined_equations_are_those_of_the_combined_design(taken):
    found = accumulate([edge_weights(U)], Y, WEIGHT, [COLUMNS], N)
    directions = RNG.standard_normal((taken, 6))
    dense = np.hstack([expand(*edge_weights(U)), COLUMNS.T])
    design = np.hstack([dense[:, :taken] @ directions, dense[:, taken:]])
    combined = found.combined(directions)
    assert np.allclose(combined.gram, design.T @ (WEIGHT[:, None] * design))
    assert np.allclose(combined.projection, design.T @ (WEIGHT * Y))
    assert combined.data == found.data


def test_exchanged_directions_give_the_equations_of_the_new_combinations():
    found = accumulate([edge_weights(U)], Y, WEIGHT, [COLUMNS], N)
    first, gone, last = (RNG.standard_normal((84, k)) for k in (2, 5, 3))
    new = RNG.standard_normal((84, 4))
    directions = np.hstack([first, new, last])
    before = found.combined(np.hstack([first, gone, last]))
    expected = found.combined(directions)
    exchanged = before.exchanged(found, directions, slice(2, 6), slice(2, 7))
    assert np.allclose(exchanged.gram, expected.gram)
    assert np.allclose(exchanged.projection, expected.projection)


def test_no_further_columns():
    found = accumulate([edge_weights(U)], Y, WEIGHT, [], N)
    dense = expand(*edge_weights(U))
    assert np.allclose(found.gram, dense.T @ (WEIGHT[:, None] * dense), rtol=0, atol=1e-10)


def test_two_steps_match_the_dense_design():
    cell, basis = edge_weights(U)
    other, other_basis = edge_weights(U - 2.3)
    stencils = [(cell, basis), (other, -0.8 * other_basis)]
    dense = np.vstack([(expand(cell, basis) + expand(other, -0.8 * other_basis)).T, COLUMNS]).T
    found = accumulate(stencils, Y, WEIGHT, [COLUMNS], N)
    np.testing.assert_allclose(found.gram, dense.T @ (WEIGHT[:, None] * dense), atol=1e-10)
    np.testing.assert_allclose(found.projection, dense.T @ (WEIGHT * Y), atol=1e-10)


def test_renewed_equations_are_those_of_the_new_columns():
    stencils = [edge_weights(U), (edge_weights(U - 2.3)[0], -0.8 * edge_weights(U - 2.3)[1])]
    fixed, old, new = (RNG.standard_normal((k, N)) for k in (3, 2, 2))
    before = accumulate(stencils, Y, WEIGHT, [fixed, old], N)
    columns = [fixed, new]
    found = renewed(before, stencils, Y, WEIGHT, columns)
    expected = accumulate(stencils, Y, WEIGHT, columns, N)
    np.testing.assert_allclose(found.gram, expected.gram, atol=1e-10)
    np.testing.assert_allclose(found.projection, expected.projection, atol=1e-10)
    assert (found.data, found.count) == (before.data, N)


def test_all_pixels_beyond_the_support_or_in_one_cell():
    for u in (np.array([-20.0, 20.0, 21.0]), np.full(5, 0.03)):
        y, weight = RNG.standard_normal((2, u.size)) ** 2
        found = accumulate([edge_weights(u)], y, weight, [np.ones((1, u.size))], u.size)
        dense = np.hstack([expand(*edge_weights(u)), np.ones((u.size, 1))])
        np.testing.assert_allclose(found.gram, dense.T @ (weight[:, None] * dense), atol=1e-12)
        np.testing.assert_allclose(found.projection, dense.T @ (weight * y), atol=1e-12)
