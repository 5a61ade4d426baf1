"""Sums by recurrence are those of every cosine by itself."""

import numpy as np
import pytest

from acutance.numerics.cosine_sums import cosine_sums


def test_the_sums_are_those_of_cosines() -> None:
    rng = np.random.default_rng(1)
    weights, angles_rad = rng.standard_normal((2, 110)), rng.uniform(0, 3, 110)
    angles_rad[0] = 0.0
    expected = weights @ np.cos(angles_rad[:, None] * np.arange(400))
    assert cosine_sums(weights, angles_rad, 400) == pytest.approx(expected, abs=1e-9)
