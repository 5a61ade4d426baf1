"""The sensor under soft objects: shares and information of edges drawn from the model."""

from dataclasses import replace

import numpy as np
import pytest

from acutance.scan.population import (
    PARTS,
    EdgeLikelihoods,
    expected_information,
    fit_shares,
    observed_information,
    share_std,
)

FREQ = np.array([0.1, 0.25, 0.4, 0.5])
TRUE = np.concatenate([np.exp(-2 * (np.pi * 0.5 * FREQ) ** 2), np.zeros(4)])
STD = 0.02
START = np.array([0.6, 0.1, 0.1, 0.1, 0.1])


def drawn(soft_share, count=600, seed=0):
    """Edges of one direction whose transfer functions are known to STD, their softness."""
    rng = np.random.default_rng(seed)
    tau = np.where(rng.random(count) < soft_share, np.abs(rng.normal(0, 0.8, count)), 0.0)
    blur = np.exp(-2 * (np.pi * np.outer(tau, FREQ)) ** 2)
    seen = TRUE * np.hstack([blur, blur]) + rng.normal(0, STD, (count, 8))
    root = np.broadcast_to(np.eye(8) / STD, (count, 8, 8))
    rank, bins = np.full(count, 8.0), np.zeros(count, int)
    return EdgeLikelihoods(FREQ, root, seen / STD, rank, bins, np.zeros(count)), tau


@pytest.mark.parametrize("soft_share", [0.0, 0.4, 0.8])
def test_the_shares_are_found_within_their_deviations(soft_share):
    edges, _ = drawn(soft_share)
    share, member = fit_shares(edges, TRUE[None], START)
    std = share_std(member, share)
    assert share.sum() == pytest.approx(1)
    assert len(share) == len(PARTS)
    assert abs(share[0] - (1 - soft_share)) < 3 * std[0] + 0.03
    assert share[-1] < 0.02


def test_every_edge_has_the_softness_of_its_object():
    edges, tau = drawn(0.5)
    _, member = fit_shares(edges, TRUE[None], START)
    far = tau > 0.5
    assert np.abs(member.softness_px - tau)[far].mean() < 0.05
    assert member.part[tau == 0, 0].mean() > 0.8
    assert member.part[far, 0].max() < 0.01


def test_edges_of_another_sensor_are_strange():
    edges, _ = drawn(0.0)
    sharper = edges.value.copy()
    sharper[:30] += 0.3 / STD
    mixed = replace(edges, value=sharper)
    share, member = fit_shares(mixed, TRUE[None], START)
    assert member.part[:30, -1].min() > 0.99
    assert share[-1] == pytest.approx(0.05, abs=0.02)


def test_the_gradient_is_that_of_the_likelihood():
    edges, _ = drawn(0.5, 40)
    share = np.array([0.5, 0.15, 0.15, 0.1, 0.1])
    otf = TRUE[None] * 0.97

    def log_likelihood(values):
        from acutance.scan.population import memberships

        power = -0.5 * np.sum(edges.off(values) ** 2, axis=2)
        return memberships(edges, power, share)

    member = log_likelihood(otf)
    _, gradient = observed_information(edges, otf, member, share)
    for place in range(8):
        step = np.zeros((1, 8))
        step[0, place] = 1e-5
        rise = (
            log_likelihood(otf + step).log_likelihood - log_likelihood(otf - step).log_likelihood
        ) / 2e-5
        assert gradient[place] == pytest.approx(rise, rel=1e-4, abs=1e-3)


def test_hidden_softness_costs_information():
    edges, _ = drawn(0.6)
    share, member = fit_shares(edges, TRUE[None], START)
    (complete,), _ = expected_information(edges, member)
    left, _ = observed_information(edges, TRUE[None], member, share)
    assert np.linalg.eigvalsh(complete - left).min() > -1e-6 * np.trace(complete)
    nyquist = 3
    assert np.linalg.inv(left)[nyquist, nyquist] > np.linalg.inv(complete)[nyquist, nyquist]


def test_ideal_edges_alone_give_the_mean_of_all():
    edges, _ = drawn(0.0, 400)
    _, member = fit_shares(edges, TRUE[None], START)
    (information,), (projection,) = expected_information(edges, member)
    mean = np.linalg.solve(information, projection)
    assert mean[:4] == pytest.approx(TRUE[:4], abs=4 * STD / 20)
