"""Complex values as real ones, and back."""

import numpy as np
import pytest

from acutance.numerics.normal_equations import Normal
from acutance.numerics.stacked import stacked, unstacked


@pytest.mark.parametrize("shape", [(3,), (3, 2), (3, 0)])
def test_stacked_values_are_real_parts_over_imaginary_parts(shape):
    rng = np.random.default_rng(1)
    values = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    found = stacked(values)
    assert found.shape == (6, *shape[1:])
    assert np.array_equal(found[:3], values.real)
    assert np.array_equal(unstacked(found), values)


def test_the_misfit_of_normal_equations_is_that_of_the_pixels():
    rng = np.random.default_rng(2)
    design, y, weight = rng.normal(size=(9, 3)), rng.normal(size=9), rng.uniform(1, 2, 9)
    weighted = design * weight[:, None]
    normal = Normal(weighted.T @ design, weighted.T @ y, float(weight @ y**2), 9.0)
    beta = rng.normal(size=3)
    wanted = float(weight @ (y - design @ beta) ** 2)
    assert normal.misfit(beta) == pytest.approx(wanted)
