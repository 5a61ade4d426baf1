"""Splines on two grids: through their samples, with slopes and transforms that are theirs."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.targets.points.psf_spline import COARSE, FINE, coarse_share, parity_part, whole

RNG = np.random.default_rng(4)
PLACES = RNG.uniform(-3, 3, (2, 50))


def light(u, v):
    """A leaning, shifted Gaussian of about half a width."""
    return np.exp(-2 * ((u - 0.2) ** 2 + 0.7 * (u - 0.2) * v + v * v))


@pytest.fixture(scope="module")
def coefficients():
    v, u = np.meshgrid(FINE.centres, FINE.centres, indexing="ij")
    return FINE.coefficients(light(u, v))


def test_the_spline_passes_through_what_it_was_made_of(coefficients):
    u, v = PLACES
    assert FINE.rows(u, v) @ coefficients.ravel() == pytest.approx(light(u, v), abs=2e-3)


@pytest.mark.parametrize("slope", [(1, 0), (0, 1)])
def test_slopes_are_derivatives(coefficients, slope):
    u, v = PLACES
    step = 1e-5
    more = FINE.rows(u + step * slope[0], v + step * slope[1]) @ coefficients.ravel()
    less = FINE.rows(u - step * slope[0], v - step * slope[1]) @ coefficients.ravel()
    found = FINE.rows(u, v, slope) @ coefficients.ravel()
    assert found == pytest.approx((more - less) / (2 * step), abs=1e-7)


@pytest.mark.parametrize("grid", [FINE, COARSE])
def test_a_grid_ends_in_nothing(grid):
    ones = grid.coefficients(np.ones((grid.size, grid.size)))
    end = grid.step * (grid.reach - 1)
    far = np.array([end, 40.0, -40.0, 0.0])
    assert not (grid.rows(far, far[::-1]) @ ones.ravel()).any()


@pytest.mark.parametrize("parity", [1, -1])
def test_the_transform_of_a_half_row_is_its_sum(parity):
    freq = np.array([0.0, 0.3, 1.1])
    quadrant = RNG.normal(size=FINE.reach + 1)
    quadrant[-3:] = 0
    if parity < 0:
        quadrant[0] = 0
    row = np.concatenate([parity * quadrant[:0:-1], quadrant])
    fine = np.arange(-6, 6, 0.005)
    coefficients = np.zeros((FINE.size, FINE.size))
    coefficients[FINE.reach] = row
    drawn = FINE.rows(fine, np.zeros(fine.size)) @ coefficients.ravel() * 1.5
    sums = np.exp(-2j * np.pi * np.multiply.outer(freq, fine)) @ drawn * 0.005
    turn = 1 if parity > 0 else -1j
    assert turn * (FINE.waves(freq, parity) @ quadrant) == pytest.approx(sums, abs=1e-6)


def test_parts_of_all_parities_make_the_whole():
    field = RNG.normal(size=(3, 9, 9))
    parities = [(across, along) for across in (1, -1) for along in (1, -1)]
    parts = [whole(parity_part(field, *one), *one) for one in parities]
    assert np.sum(parts, axis=0) == pytest.approx(field)
    for (across, along), part in zip(parities, parts, strict=True):
        assert part[:, :, ::-1] == pytest.approx(across * part)
        assert part[:, ::-1] == pytest.approx(along * part)


def test_the_coarse_grid_takes_what_is_far_out():
    assert coarse_share(np.array([0.0, 2.0, 5.0])) == pytest.approx([0, 0, 1])
