"""Bessel functions of many orders at once."""

import numpy as np
import pytest
from scipy.special import jv

from acutance.numerics.bessel_table import bessel_table


@pytest.mark.parametrize("orders", [(0, 1, 2), (20, 8, 21), (0, 430), (1000,), (5,)])
@pytest.mark.parametrize("reach", [0.5, 64.0, 700.0])
def test_all_orders_are_those_of_scipy(orders, reach):
    x = np.linspace(0.0, reach, 401)
    found = bessel_table(orders, x)
    assert found.shape == (len(orders), x.size)
    for order, row in zip(orders, found, strict=True):
        assert np.allclose(row, jv(order, x), rtol=0, atol=2e-13)
