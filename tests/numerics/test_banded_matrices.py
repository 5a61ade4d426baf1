"""Bands of factors are those of the whole matrices."""

import numpy as np
import pytest

from acutance.numerics.banded_matrices import (
    banded_back_substitution,
    banded_factor,
    banded_substitution,
    between_banded_factors,
)


def spline_products(size: int, seed: int) -> np.ndarray:
    """Products of columns of which four are not zero in a row, (n, n)."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((20 * size, size))
    first = rng.integers(0, size - 3, len(rows))
    rows[np.arange(len(rows))[:, None], first[:, None] + np.arange(4)] = rng.random((len(rows), 4))
    return np.asarray(rows.T @ rows)


def whole(bands: np.ndarray) -> np.ndarray:
    return np.asarray(sum(np.diag(bands[d, : bands.shape[1] - d], -d) for d in range(4)))


@pytest.mark.parametrize("size", [4, 5, 63, 200])
def test_the_factor_is_that_of_cholesky(size: int) -> None:
    matrix = spline_products(size, size)
    found = whole(banded_factor(matrix))
    assert found == pytest.approx(np.linalg.cholesky(matrix), rel=1e-8, abs=1e-9)


def test_substitutions_solve_triangular_equations() -> None:
    bands = banded_factor(spline_products(50, 1))
    right = np.random.default_rng(2).standard_normal((50, 7))
    assert whole(bands) @ banded_substitution(bands, right) == pytest.approx(right)
    assert whole(bands).T @ banded_back_substitution(bands, right[:, 0]) == pytest.approx(
        right[:, 0]
    )


def test_products_of_both_sides_are_those_of_whole_matrices() -> None:
    bands = banded_factor(spline_products(50, 1))
    middle = np.random.default_rng(2).standard_normal((50, 50))
    expected = whole(bands).T @ middle @ whole(bands)
    assert between_banded_factors(bands, middle) == pytest.approx(expected)


def test_fewer_rows_than_columns_are_explained_as_far_as_they_tell() -> None:
    """As of narrow targets, whose cells are smaller than pixels."""
    rng = np.random.default_rng(3)
    rows = np.zeros((200, 360))
    rows[np.arange(200)[:, None], rng.integers(0, 357, 200)[:, None] + np.arange(4)] = rng.random(
        (200, 4)
    )
    values = rng.standard_normal((200, 3))
    found = banded_substitution(banded_factor(rows.T @ rows), rows.T @ values)
    projected = rows @ np.linalg.lstsq(rows, values)[0]
    assert found.T @ found == pytest.approx(projected.T @ projected, rel=1e-6, abs=1e-6)


def test_columns_without_a_pixel_have_none_of_the_solution() -> None:
    matrix = spline_products(50, 1)
    matrix[20:25], matrix[:, 20:25] = 0.0, 0.0
    right = matrix @ np.random.default_rng(2).standard_normal((50, 1))
    found = banded_substitution(banded_factor(matrix), right)
    assert np.all(np.isfinite(found))
    assert np.all(found[20:25] == 0)
