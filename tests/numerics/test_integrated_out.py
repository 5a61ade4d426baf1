"""Unknowns integrated out, and put back, against the whole system."""

import numpy as np
import pytest

from acutance.numerics.integrated_out import integrated_out

RNG = np.random.default_rng(4)
DESIGN = RNG.standard_normal((30, 7))
INFORMATION, PROJECTION = DESIGN.T @ DESIGN, DESIGN.T @ RNG.standard_normal(30)


@pytest.mark.parametrize(
    ("kept", "others"),
    [(slice(4), slice(4, None)), (slice(3, None), slice(3))],
)
def test_all_unknowns_are_those_of_the_whole_system(kept, others):
    std = np.full(7, np.inf)
    std[others] = RNG.uniform(0.2, 2.0, std[others].size)
    covariance = np.linalg.inv(INFORMATION + np.diag(std**-2.0))
    found = integrated_out(INFORMATION, PROJECTION, std[others], kept, others)
    own = np.linalg.inv(found.information)
    assert own == pytest.approx(covariance[kept, kept])
    mean, whole = found.all_unknowns(own @ found.projection, own)
    assert mean == pytest.approx(covariance @ PROJECTION)
    assert whole == pytest.approx(covariance)
