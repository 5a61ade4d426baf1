"""Factors, inverses and products of small matrices against their definitions."""

import numpy as np
import pytest

from acutance.numerics.small_matrices import (
    add_product,
    factorize,
    forward_substitution,
    lower_inverse,
    lower_square,
)


@pytest.mark.parametrize("size", [1, 2, 4, 5, 7, 8, 51, 102])
def test_the_inverse_and_the_square_of_a_lower_triangular_matrix(size):
    rng = np.random.default_rng(size)
    lower = np.tril(rng.standard_normal((size, size)) / size, -1) + np.diag(rng.uniform(1, 2, size))
    found = lower_inverse(lower)
    assert np.allclose(found @ lower, np.eye(size), rtol=0, atol=1e-12)
    assert not np.triu(found, 1).any()
    assert np.allclose(lower_square(lower), lower.T @ lower, rtol=0, atol=1e-12)


@pytest.mark.parametrize("size", [1, 3, 4, 9, 18])
def test_factors_and_solutions_in_place(size):
    rng = np.random.default_rng(size)
    half, right = rng.standard_normal((size, size + 2)), rng.standard_normal((size, 5))
    found, solved = half @ half.T, right.copy()
    factorize(found)
    assert np.allclose(found, np.linalg.cholesky(half @ half.T), rtol=0, atol=1e-12)
    forward_substitution(found, solved)
    assert np.allclose(found @ solved, right, rtol=0, atol=1e-10)


@pytest.mark.parametrize("rows", [3, 4, 9])
@pytest.mark.parametrize("inner", [1, 3, 4, 6, 8])
def test_a_product_is_added(rows, inner):
    rng = np.random.default_rng(inner)
    left, right = rng.standard_normal((rows, inner)), rng.standard_normal((inner, 5))
    found = np.ones((rows, 5))
    add_product(found, left, right)
    assert np.allclose(found, 1 + left @ right, rtol=0, atol=1e-12)
