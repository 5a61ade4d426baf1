"""The posterior against dense Bayesian formulas, log evidence slopes against differences."""

import numpy as np
import pytest

from acutance.numerics import marginal_likelihood
from acutance.numerics.marginal_likelihood import Prior, log_evidence_slopes, regress, whiten
from acutance.numerics.normal_equations import Normal

M, N = 14, 60
NOISE = 0.3**2
AMPLITUDE = np.array([-0.4, 0.3])


@pytest.fixture(scope="module")
def problem():
    rng = np.random.default_rng(6)
    design = rng.standard_normal((N, M))
    block = np.array([-1, -1, -1, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, -1])
    prior = Prior(
        block=block,
        scale=np.where(block < 0, 2.0, 1.0),
        mean=np.where(np.arange(M) == 2, 0.7, 0.0),
        log_amplitude=np.array([-1.0, -0.5]),
        log_amplitude_std=1.0,
        height=1.5,
        noise_floor=1e-6,
    )
    beta = prior.mean + standard_deviations(prior, AMPLITUDE) * rng.standard_normal(M)
    y = design @ beta + np.sqrt(NOISE) * rng.standard_normal(N)
    normal = Normal(design.T @ design, design.T @ y, float(y @ y), N)
    return design, y, prior, normal


def standard_deviations(prior, log_amplitude):
    amplitude = np.append(np.exp(log_amplitude), 1.0)[prior.block]
    return prior.height * prior.scale * amplitude


def log_evidence(design, y, prior, log_amplitude):
    """Logarithm of the density of the data and the amplitudes, by dense matrices."""
    sigma = standard_deviations(prior, log_amplitude)
    covariance = (design * sigma**2) @ design.T + NOISE * np.eye(N)
    left = y - design @ prior.mean
    likelihood = -0.5 * left @ np.linalg.solve(covariance, left)
    likelihood -= 0.5 * np.linalg.slogdet(covariance)[1]
    beyond = (log_amplitude - prior.log_amplitude) / prior.log_amplitude_std
    return likelihood - 0.5 * beyond @ beyond


def test_mean_and_covariance_are_the_dense_formula(problem):
    design, y, prior, normal = problem
    sigma = standard_deviations(prior, AMPLITUDE)
    precision = design.T @ design / NOISE + np.diag(1 / sigma**2)
    covariance = np.linalg.inv(precision)
    mean = covariance @ (design.T @ y / NOISE + prior.mean / sigma**2)
    found = whiten(normal, prior, AMPLITUDE, NOISE)
    assert np.allclose(found.sigma * found.mean, mean, rtol=1e-9)
    factor = found.sigma[:, None] * found.root
    assert np.allclose(factor @ factor.T, covariance, rtol=1e-9, atol=1e-12)


def test_the_log_evidence_is_the_dense_one_up_to_a_constant(problem):
    design, y, prior, normal = problem
    points = [AMPLITUDE, prior.log_amplitude, np.array([0.5, -2.0]), np.array([-6.0, 1.0])]
    dense = [log_evidence(design, y, prior, point) for point in points]
    found = [marginal_likelihood.log_evidence(normal, prior, point, NOISE) for point in points]
    assert np.ptp(np.subtract(found, dense)) < 1e-8 * np.ptp(dense)


def test_gradient_and_hessian_of_the_log_evidence(problem):
    design, y, prior, normal = problem
    found = log_evidence_slopes(whiten(normal, prior, AMPLITUDE, NOISE), prior, AMPLITUDE)
    h = 1e-3
    axes = h * np.eye(2)

    def value(a):
        return log_evidence(design, y, prior, a)

    gradient = [(value(AMPLITUDE + e) - value(AMPLITUDE - e)) / (2 * h) for e in axes]
    hessian = [
        [
            (
                value(AMPLITUDE + d + e)
                - value(AMPLITUDE + d - e)
                - value(AMPLITUDE - d + e)
                + value(AMPLITUDE - d - e)
            )
            / (4 * h * h)
            for d in axes
        ]
        for e in axes
    ]
    assert found.gradient == pytest.approx(np.array(gradient), rel=1e-4, abs=1e-5)
    assert found.hessian == pytest.approx(np.array(hessian), rel=1e-3, abs=1e-3)


def test_moves_are_the_derivative_of_the_mean(problem):
    _, _, prior, normal = problem
    found = whiten(normal, prior, AMPLITUDE, NOISE)
    moves = found.sigma[:, None] * log_evidence_slopes(found, prior, AMPLITUDE).by_amplitude
    for k, step in enumerate(1e-5 * np.eye(2)):
        high, low = (whiten(normal, prior, AMPLITUDE + sign * step, NOISE) for sign in (1, -1))
        slope = (high.sigma * high.mean - low.sigma * low.mean) / 2e-5
        assert moves[:, k] == pytest.approx(slope, rel=1e-5, abs=1e-7)


def test_amplitudes_settle_where_the_evidence_is_highest(problem):
    _, _, prior, normal = problem
    found = regress(normal, prior, NOISE)
    slope = log_evidence_slopes(
        whiten(normal, prior, found.log_amplitude, found.variance), prior, found.log_amplitude
    )
    assert np.all(np.abs(slope.step()) < 0.06)
    assert found.variance == pytest.approx(NOISE, rel=0.6)
    assert 0 < found.freedom <= M


def test_variance_is_the_misfit_per_degree_of_freedom(problem):
    design, y, prior, normal = problem
    found = regress(normal, prior, NOISE)
    misfit = float(np.sum((y - design @ found.beta) ** 2))
    assert found.freedom > 5
    assert found.variance == pytest.approx(misfit / (N - found.freedom), rel=0.015)


def test_the_first_guess_of_the_noise_does_not_matter(problem):
    _, _, prior, normal = problem
    small, large = (regress(normal, prior, NOISE * k) for k in (0.05, 20))
    assert small.variance == pytest.approx(large.variance, rel=0.02)
    assert np.allclose(small.beta, large.beta, atol=0.02)


def test_uncertain_amplitudes_widen_the_covariance(problem):
    _, _, prior, normal = problem
    found = regress(normal, prior, NOISE)
    widened = found.factor @ found.factor.T
    fixed = whiten(normal, prior, found.log_amplitude, found.variance)
    plain = fixed.sigma[:, None] * fixed.covariance * fixed.sigma
    extra = np.linalg.eigvalsh(widened - plain)
    assert extra.min() > -0.05 * extra.max()
    assert found.factor.shape == (M, M + 2)
    assert extra.max() > 0


def test_inflation_widens_the_covariance(problem):
    _, _, prior, normal = problem
    plain, inflated = (regress(normal, prior, NOISE, k) for k in (1.0, 4.0))
    ratio = np.linalg.norm(inflated.factor[0]) / np.linalg.norm(plain.factor[0])
    assert 1.6 < ratio < 2.2
