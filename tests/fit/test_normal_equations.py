"""The fast sums over the pixels against the dense design matrix."""

import numpy as np

from acutance.fit.normal import accumulate
from acutance.fit.spline import HALF_SUPPORT, edge_weights, spread

RNG = np.random.default_rng(5)
N = 700
U = RNG.uniform(-HALF_SUPPORT - 2, HALF_SUPPORT + 2, N)
Y = RNG.standard_normal(N)
WEIGHT = RNG.uniform(0.2, 2.0, N)
COLUMNS = RNG.standard_normal((2, N))


def test_sums_are_those_of_the_dense_design():
    found = accumulate([edge_weights(U)], Y, WEIGHT, COLUMNS, N)
    design = np.hstack([spread(*edge_weights(U)), COLUMNS.T])
    assert np.allclose(found.gram, design.T @ (WEIGHT[:, None] * design), rtol=0, atol=1e-10)
    assert np.allclose(found.projection, design.T @ (WEIGHT * Y), rtol=0, atol=1e-10)
    assert np.isclose(found.data, Y @ (WEIGHT * Y))
    assert found.count == N


def test_combined_equations_are_those_of_the_combined_design():
    found = accumulate([edge_weights(U)], Y, WEIGHT, COLUMNS, N)
    directions = RNG.standard_normal((found.projection.size, 6))
    design = np.hstack([spread(*edge_weights(U)), COLUMNS.T]) @ directions
    combined = found.combined(directions)
    assert np.allclose(combined.gram, design.T @ (WEIGHT[:, None] * design))
    assert np.allclose(combined.projection, design.T @ (WEIGHT * Y))
    assert combined.data == found.data


def test_no_further_columns():
    found = accumulate([edge_weights(U)], Y, WEIGHT, np.empty((0, N)), N)
    dense = spread(*edge_weights(U))
    assert np.allclose(found.gram, dense.T @ (WEIGHT[:, None] * dense), rtol=0, atol=1e-10)


def test_two_steps_match_the_dense_design():
    cell, basis = edge_weights(U)
    other, other_basis = edge_weights(U - 2.3)
    stencils = [(cell, basis), (other, -0.8 * other_basis)]
    dense = np.vstack([(spread(cell, basis) + spread(other, -0.8 * other_basis)).T, COLUMNS]).T
    found = accumulate(stencils, Y, WEIGHT, COLUMNS, N)
    np.testing.assert_allclose(found.gram, dense.T @ (WEIGHT[:, None] * dense), atol=1e-10)
    np.testing.assert_allclose(found.projection, dense.T @ (WEIGHT * Y), atol=1e-10)
