"""Inverses of triangular matrices against those of any matrix."""

import numpy as np
import pytest

from acutance.numerics.triangular import lower_inverse


@pytest.mark.parametrize("size", [1, 2, 4, 5, 7, 8, 51, 102])
def test_the_inverse_of_a_lower_triangular_matrix(size):
    rng = np.random.default_rng(size)
    lower = np.tril(rng.standard_normal((size, size)) / size, -1) + np.diag(rng.uniform(1, 2, size))
    found = lower_inverse(lower)
    assert np.allclose(found @ lower, np.eye(size), rtol=0, atol=1e-12)
    assert not np.triu(found, 1).any()
