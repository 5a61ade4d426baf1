"""Factors, inverses and products of small matrices against their definitions."""

import numpy as np
import pytest

from acutance.numerics.small_matrices import (
    add_product,
    add_products_of_rows,
    factorize,
    forward_substitution,
    lower_inverse,
    lower_square,
    products_of_rows,
    sparse_product,
    symmetric_product,
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


@pytest.mark.parametrize("rows", [3, 4, 9, 21])
@pytest.mark.parametrize("inner", [1, 4, 6, 24])
def test_products_of_what_is_mostly_zero_and_of_what_is_symmetric(rows, inner):
    rng = np.random.default_rng(rows)
    near = np.abs(np.subtract.outer(np.arange(rows), np.arange(inner))) < 3
    left, right = near * rng.standard_normal((rows, inner)), rng.standard_normal((inner, 5))
    assert np.allclose(sparse_product(left, right), left @ right, rtol=0, atol=1e-12)
    half = rng.standard_normal((rows, inner))
    assert np.allclose(symmetric_product(half, half.T.copy()), half @ half.T, rtol=0, atol=1e-12)


@pytest.mark.parametrize("size", [4, 8, 28])
@pytest.mark.parametrize("columns", [1, 511, 512, 1300])
def test_products_of_long_rows(size, columns):
    rows = np.random.default_rng(columns).standard_normal((size, columns))
    assert np.allclose(products_of_rows(rows), rows @ rows.T, rtol=0, atol=1e-11)


def test_products_of_rows_are_added_below_the_diagonal_from_one_column_on():
    left, right = np.random.default_rng(1).standard_normal((2, 8, 60))
    found = np.ones((8, 8))
    add_products_of_rows(found, left, right, 5, 20)
    expected = 1 + left[:, 5:25] @ right[:, 5:25].T
    below = np.tril(np.ones((8, 8), bool))
    assert np.allclose(found[below], expected[below], rtol=0, atol=1e-12)
