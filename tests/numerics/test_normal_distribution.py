"""The normal distribution and polynomials of compiled loops against those of the libraries."""

import numpy as np
import pytest
from scipy.special import ndtr

from acutance.numerics.compiled import compiled
from acutance.numerics.lorentz_tail import tail_esf, tail_lsf
from acutance.numerics.normal_distribution import normal_distribution
from acutance.numerics.polynomial import interpolated, polynomial_value

Z = np.linspace(-12, 12, 2401)


@compiled
def along(z):
    found = np.empty((2, z.size))
    for k in range(z.size):
        found[0, k], found[1, k] = normal_distribution(z[k])
    return found


def test_normal_distribution_is_that_of_the_library():
    below, density = along(Z)
    assert np.max(np.abs(below - ndtr(Z))) < 2e-13
    assert np.max(np.abs(density - np.exp(-0.5 * Z**2) / np.sqrt(2 * np.pi))) < 2e-13


def test_small_shares_are_right_to_a_part_of_themselves():
    low = Z[(Z < 0) & (Z > -9)]
    assert along(low)[0] == pytest.approx(ndtr(low), rel=2e-12)


def test_nothing_lies_beyond_nine_standard_deviations():
    below, density = along(np.array([-np.inf, -40.0, 40.0, np.inf]))
    assert below == pytest.approx([0, 0, 1, 1], abs=1e-18)
    assert density == pytest.approx(np.zeros(4), abs=1e-17)


def test_tail_is_the_lorentz_curve():
    s = Z.reshape(-1, 7)
    assert np.max(np.abs(tail_esf(s, 0.7) - (np.arctan(s / 0.7) / np.pi + 0.5))) < 1e-14
    assert np.max(np.abs(tail_lsf(s, 0.7) - 0.7 / np.pi / (s * s + 0.49))) < 1e-15


def test_interpolation_gives_a_polynomial_itself():
    found = interpolated(lambda x: 2 - x + 0.5 * x**3, 1.0, 4.0, 5)
    assert found == pytest.approx([2, -1, 0, 0.5, 0, 0], abs=1e-10)
    assert polynomial_value(found, 3.0) == pytest.approx(12.5)
