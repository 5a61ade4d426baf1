"""The spline basis against its definitions, by dense sums and numerical integrals."""

import numpy as np
import pytest

from acutance.targets.straight.spline import (
    CELL,
    CELLS,
    CENTRES,
    HALF_SUPPORT,
    SIZE,
    SplineRows,
    combine,
    edge_and_line_weights,
    edge_weights,
    esf_from_lsf,
    expand,
    quasi_interpolant,
    transform,
)

U = np.linspace(-HALF_SUPPORT - 1, HALF_SUPPORT + 1, 1801)


def quadratic_spline(u):
    """The B-spline of degree 2 with unit cells, by its pieces."""
    u = np.abs(u)
    return np.where(u < 0.5, 0.75 - u**2, np.where(u < 1.5, 0.5 * (1.5 - u) ** 2, 0.0))


def line_weights(u):
    """Cells and slopes; on the way the edge's weights, which have to be the same."""
    cell, weights, slopes = edge_and_line_weights(u)
    own_cell, own_weights = edge_weights(u)
    assert np.array_equal(cell, own_cell)
    assert np.array_equal(weights, own_weights)
    return cell, slopes


def test_edge_weights_sum_to_one_everywhere():
    cell, weights = edge_weights(U)
    assert np.max(np.abs(weights.sum(axis=0) - 1)) < 1e-14
    assert cell.min() == 0
    assert cell.max() == CELLS - 1


def test_line_weights_are_the_derivative_of_the_edge_weights():
    inside = U[np.abs(U) < HALF_SUPPORT - 1e-3]
    step = 1e-5
    high, low = (expand(*edge_weights(inside + k * step)) for k in (0.5, -0.5))
    slope = (high - low) / step
    assert np.max(np.abs(slope - expand(*line_weights(inside)))) < 1e-4


def test_line_weights_make_the_quadratic_spline_of_every_coefficient():
    for j in (0, 1, 40, SIZE - 1):
        c = np.zeros(SIZE)
        c[j] = 1.0
        lsf = combine(*line_weights(U), esf_from_lsf(c))
        assert np.max(np.abs(lsf - quadratic_spline((U - CENTRES[j]) / CELL))) < 1e-12


def test_esf_is_the_integral_of_the_lsf_and_level_beyond():
    c = np.random.default_rng(0).standard_normal(SIZE)
    e = esf_from_lsf(c)
    grid = np.linspace(-HALF_SUPPORT, HALF_SUPPORT, 160001)
    lsf = combine(*line_weights(grid), e)
    middles = np.concatenate([[0.0], np.cumsum(0.5 * (lsf[1:] + lsf[:-1])) * (grid[1] - grid[0])])
    assert np.max(np.abs(combine(*edge_weights(grid), e) - middles)) < 1e-7
    ends = combine(*edge_weights(np.array([-20.0, 20.0])), e)
    assert ends == pytest.approx([0.0, CELL * c.sum()], abs=1e-13)


def test_spread_is_the_dense_form_of_combine():
    coefficients = np.random.default_rng(1).standard_normal(CELLS + 3)
    cell, weights = edge_weights(U)
    dense = expand(cell, weights)
    assert np.max(np.abs(dense @ coefficients - combine(cell, weights, coefficients))) < 1e-13
    assert np.count_nonzero(dense) <= 4 * U.size
    wider = expand(cell, weights, further=2)
    assert np.array_equal(wider[:, :-2], dense)
    assert not wider[:, -2:].any()


@pytest.mark.parametrize("own", [slice(None), slice(7, 11), slice(None, None, 3)])
def test_products_of_rows_are_those_of_the_whole_matrix(own):
    rng = np.random.default_rng(6)
    cell, weights = edge_weights(U)
    rows = SplineRows(cell, weights, rng.standard_normal((U.size, 2)), further=1)
    rows = rows.with_column(rng.standard_normal(U.size))[own]
    whole = np.asarray(rows)
    assert whole.shape == rows.shape == (U[own].size, CELLS + 5)
    expected = expand(cell[own], weights[:, own], further=2)
    assert np.array_equal(whole[:, :-3], expected[:, :-3])
    matrix = rng.standard_normal((rows.shape[1], 3))
    assert np.max(np.abs(rows @ matrix - whole @ matrix)) < 1e-13
    factors = (-0.1, 0.6, 0.7, -0.2)
    for first in (0, rows.shape[0] - 4):
        wanted = np.array(factors) @ whole[first : first + 4]
        assert np.max(np.abs(rows.blend(first, factors) - wanted)) < 1e-13


def test_esf_from_lsf_takes_columns():
    c = np.random.default_rng(2).standard_normal((SIZE, 3))
    each = np.stack([esf_from_lsf(column) for column in c.T], axis=1)
    assert np.array_equal(esf_from_lsf(c), each)


def test_quasi_interpolant_is_of_high_order():
    errors = []
    for width in (0.6, 1.2):
        values = np.exp(-0.5 * (CENTRES / width) ** 2)
        lsf = combine(*line_weights(U), esf_from_lsf(quasi_interpolant(values)))
        errors.append(np.max(np.abs(lsf - np.exp(-0.5 * (U / width) ** 2))))
    # The cell is twice as fine for the wider curve: between third and fourth order.
    assert errors[0] < 1e-3
    assert errors[0] / errors[1] > 10


def test_quasi_interpolant_keeps_quadratics():
    values = 0.3 + 0.2 * CENTRES + 0.1 * CENTRES**2
    lsf = combine(*line_weights(U), esf_from_lsf(quasi_interpolant(values)))
    inner = np.abs(U) < HALF_SUPPORT - 5 * CELL
    assert np.max(np.abs(lsf - 0.3 - 0.2 * U - 0.1 * U**2)[inner]) < 1e-11


def test_transform_is_the_numerical_fourier_transform():
    rng = np.random.default_rng(3)
    e = esf_from_lsf(rng.standard_normal(SIZE))
    freq = np.arange(0, 2.01, 0.04)
    grid = (np.arange(32000) + 0.5) * (2 * HALF_SUPPORT / 32000) - HALF_SUPPORT
    lsf = combine(*line_weights(grid), e)
    numerical = np.exp(-2j * np.pi * np.outer(freq, grid)) @ lsf * (grid[1] - grid[0])
    assert np.max(np.abs(transform(freq) @ e - numerical)) < 1e-6


def test_transform_at_zero_is_the_height():
    e = esf_from_lsf(np.random.default_rng(4).standard_normal(SIZE))
    assert (transform(np.arange(3) * 0.1) @ e)[0] == pytest.approx(e[-1], abs=1e-13)


def test_transform_about_another_place_turns_the_phase():
    freq = np.arange(0, 1.01, 0.1)
    turn = 0.25 * np.exp(2j * np.pi * freq * 0.7)
    moved = transform(freq, about=0.7, scale=0.25, further=2)
    assert np.max(np.abs(moved[:, :-2] - turn[:, None] * transform(freq))) < 1e-13
    assert not moved[:, -2:].any()
