"""The error of a shape that functions cannot follow: a share of a departure, none at zero."""

import numpy as np
import pytest

from acutance.numerics.shape_error import ShapeError

SHARE, DEPARTURE = 0.05, 0.2


@pytest.fixture(scope="module")
def error():
    """Of an OTF that departs by .2 across and not at all along."""

    def departure(u, v):
        size = np.hypot(u, v)
        return DEPARTURE * np.where(size > 0, u / np.where(size > 0, size, 1.0), 0.0) + 0j

    return ShapeError.of(departure, 1.5, SHARE)


def test_it_is_a_share_of_the_mean_over_directions(error):
    freq = np.array([0.1, 0.5, 1.0])
    std = np.linalg.norm(error.factor(freq, np.ones(3, complex)), axis=1)
    assert std == pytest.approx(np.full(3, SHARE * DEPARTURE / np.sqrt(2)), rel=0.1)


def test_an_otf_is_one_at_zero_frequency(error):
    assert not np.any(error.factor(np.zeros(1), np.ones(1, complex)))


def test_it_is_along_the_otf(error):
    turn = np.exp(0.7j)
    factor = error.factor(np.array([0.3]), np.array([0.4 * turn]))
    assert np.imag(factor / turn) == pytest.approx(0, abs=1e-12)


def test_near_frequencies_err_together(error):
    factor = error.factor(np.array([0.3, 0.35, 1.2]), np.ones(3, complex)).real
    unit = factor / np.linalg.norm(factor, axis=1, keepdims=True)
    together = unit @ unit.T
    assert together[0, 1] > 0.95
    assert together[0, 2] < 0.1
