"""Factors of matrices that are hardly of full rank."""

import numpy as np
import pytest

from acutance.numerics.pivoted_root import least_squares, pivoted_root

RNG = np.random.default_rng(6)
SIZES = np.array([100.0, 10.0, 1.0, 1e-4, 1e-7, 0.0])
AXES = np.linalg.qr(RNG.standard_normal((6, 6)))[0]
MATRIX = AXES * SIZES @ AXES.T


@pytest.mark.parametrize("least", [1e-2, 1e-5])
def test_what_the_root_lacks_is_small(least):
    root = pivoted_root(MATRIX, least)
    assert root.shape == (6, np.count_nonzero(least < SIZES))
    left = MATRIX - root @ root.T
    assert np.abs(left).max() <= least
    assert np.all(np.diff(np.abs(root).max(axis=0)) < 0)


def test_values_in_reach_of_the_root_are_solved_exactly():
    root = pivoted_root(MATRIX, 1e-2)
    wanted = RNG.standard_normal(root.shape[1])
    assert least_squares(root, root @ wanted) == pytest.approx(wanted)
