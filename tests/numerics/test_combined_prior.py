"""A prior of sums: the same posterior as that of the sums' covariance."""

from __future__ import annotations

import numpy as np

from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.marginal_likelihood import Prior
from acutance.numerics.normal_equations import Normal


def test_posterior_is_that_of_the_covariance() -> None:
    rng = np.random.default_rng(3)
    design, combination = rng.normal(size=(60, 3)), np.hstack([np.eye(3), [[1.0], [-2.0], [0.5]]])
    noise = 0.5
    y = design @ np.array([1.0, -2.0, 0.4]) + noise * rng.normal(size=60)
    normal = Normal(design.T @ design, design.T @ y, float(y @ y), 60.0)
    prior = Prior(
        block=np.full(4, -1.0), scale=np.array([0.3, 0.3, 0.3, 2.0]), mean=np.zeros(4),
        log_amplitude=np.zeros(1), log_amplitude_std=1.0, height=1.0, noise_floor=1e-6,
    )  # fmt: skip
    found = CombinedPrior(prior, combination)
    posterior = found.posterior(normal, noise**2)
    spread = combination * prior.scale
    precision = np.linalg.inv(spread @ spread.T) + normal.gram / posterior.variance
    expected = np.linalg.solve(precision, normal.projection / posterior.variance)
    assert np.allclose(posterior.beta, expected, rtol=0.02)
    covariance = posterior.factor @ posterior.factor.T
    assert np.allclose(covariance, np.linalg.inv(precision), rtol=0.1, atol=1e-4)
    response = found.response(posterior, posterior.variance)
    assert np.allclose(response @ normal.projection, posterior.beta, rtol=0.02)
