"""The sensor under soft objects: shares and information of edges drawn from the model."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.information import expected_information, observed_information, sensor_terms
from acutance.scan.population import SoftnessGrid, fit_shares, softness_grid
from acutance.scan.shares import SECTORS, START, sectors_of, share_covariances
from acutance.scan.softness import KINDS, PARTS, PSEUDO_COUNTS, law_chances

FREQ = np.array([0.1, 0.25, 0.4, 0.5])
TRUE = np.concatenate([np.exp(-2 * (np.pi * 0.5 * FREQ) ** 2), np.zeros(4)])
STD = 0.02


def drawn(soft_share, count=600, seed=0):
    """Edges of one direction whose transfer functions are known to STD, their softness."""
    rng = np.random.default_rng(seed)
    tau = np.where(rng.random(count) < soft_share, np.abs(rng.normal(0, 0.8, count)), 0.0)
    blur = np.exp(-2 * (np.pi * np.outer(tau, FREQ)) ** 2)
    seen = TRUE * np.hstack([blur, blur]) + rng.normal(0, STD, (count, 8))
    return known_to_std(seen), tau


def known_to_std(seen):
    """Edges of one direction whose transfer functions (n, 8) are known to STD."""
    count = len(seen)
    root = np.broadcast_to(np.eye(8) / STD, (count, 8, 8))
    rank, bins = np.full(count, 8.0), np.zeros(count, int)
    return EdgeLikelihoods.of_roots(FREQ, root, seen / STD, rank, bins, np.zeros(count))


def test_laws_are_roots_of_sums_of_squares():
    edge = np.array([0.05, 0.3, 1.0, 6.0])
    found = law_chances(edge)
    sizes = (0.15, 0.21, 0.3, 0.42, 0.6, 0.85, 1.2, 1.7)
    expected = [
        np.diff(stats.chi(causes, scale=size / causes**0.5).cdf(edge))
        for causes, first in ((1, 0), (2, 1), (4, 2))
        for size in sizes[first:]
    ]
    assert found == pytest.approx(np.array(expected), abs=1e-12)
    assert len(PARTS) == len(expected) + 2


def test_kinds_divide_the_parts():
    assert sum(KINDS.values()) == pytest.approx(np.ones(len(PARTS)))
    # Of the narrowest half-normal law half of the objects are within a tenth of a pixel.
    assert KINDS["ideal"][:2] == pytest.approx([1.0, 0.495], abs=0.001)
    assert KINDS["strange"][-1] == 1.0


def test_the_grid_of_an_edge_covers_its_softness():
    edges, tau = drawn(0.6)
    objects = edges.of_objects(TRUE[None])
    grid = softness_grid(objects)
    middle, width = grid.middle_px, grid.width_px
    assert np.all((middle[:, 0] - width < tau) & (tau < middle[:, -1] + width))
    # Several places in what the pixels of an edge allow, however soft its object is.
    power = -0.5 * objects.powers(*grid, middle.shape[1])[:, 1:]
    near = np.sum(power > power.max(axis=1, keepdims=True) - 2, axis=1)
    assert near.min() >= 4


def test_what_is_said_of_objects_is_what_is_said_of_edges():
    rng = np.random.default_rng(1)
    root, value = rng.normal(0, 1, (5, 8, 6)), rng.normal(0, 1, (5, 6))
    bins = np.array([0, 1, 0, 1, 1])
    edges = EdgeLikelihoods.of_roots(FREQ, root, value, np.full(5, 6.0), bins, np.zeros(5))
    gain, otf = rng.uniform(0.8, 1.2, (5, 4)), rng.normal(0, 1, (2, 8))
    edges = edges.turned(gain)
    first, width = np.full(5, 0.3), np.full(5, 0.1)
    power = edges.of_objects(otf).powers(first, width, 3) + edges.square[:, None]
    for t, softness in enumerate((0.0, 0.3, 0.4, 0.5)):
        seen = np.tile(gain * np.exp(-2 * (np.pi * softness * FREQ) ** 2), 2) * otf[bins]
        off = np.einsum("nkr,nk->nr", root, seen) - value
        assert power[:, t] == pytest.approx(np.sum(off**2, axis=1))


def test_cells_have_the_chances_of_their_laws():
    grid = SoftnessGrid(np.array([0.02, 0.7, 9.0]), np.array([0.04, 0.031, 0.5]))
    border = grid.middle_px - 0.5 * grid.width_px[:, None]
    border = np.hstack([border, border[:, -1:] + grid.width_px[:, None]])
    found = np.moveaxis(grid.chances(slice(None)), 1, 0)
    assert found == pytest.approx(law_chances(border), abs=2e-4)
    assert found.min() >= 0


def test_the_likelihood_is_that_of_a_fine_integral():
    edges, _ = drawn(0.6, 20)
    otf = TRUE[None] * 0.98
    share = START / START.sum(axis=1, keepdims=True)
    border = np.linspace(0, 6, 20001)
    fine = 0.5 * (border[:-1] + border[1:])
    chances = law_chances(border)
    for one in range(20):
        alone = edges.chosen(np.array([one]))
        member = fit_shares(alone, otf, share)
        updated = member.share[0]
        blur = np.exp(-2 * (np.pi * np.outer(fine, FREQ)) ** 2)
        off = otf * np.hstack([blur, blur]) / STD - STD * edges.pull[one]
        likelihood = np.exp(-0.5 * np.sum(off**2, axis=1))
        soft = np.tensordot(updated[1:-1], chances, axes=1)
        strange = likelihood[0] ** (1 / 100) * 100**-4.0
        whole = updated[0] * likelihood[0] + soft @ likelihood + updated[-1] * strange
        assert member.log_likelihood == pytest.approx(np.log(whole), abs=0.02)


@pytest.mark.parametrize("soft_share", [0.0, 0.4, 0.8])
def test_the_shares_are_found_within_their_deviations(soft_share):
    edges, _ = drawn(soft_share)
    member = fit_shares(edges, TRUE[None], START)
    share = member.share[0]
    covariance, *_ = share_covariances(member.part, member.sector, member.share)
    assert share.sum() == pytest.approx(1)
    assert len(share) == len(PARTS)
    # Of the soft ones a tenth is as sharp as ideal ones, of a half-normal of .8 px.
    ideal = 1 - 0.9 * soft_share
    std = (KINDS["ideal"] @ covariance @ KINDS["ideal"]) ** 0.5
    assert abs(KINDS["ideal"] @ share - ideal) < 3 * std + 0.03
    assert share[-1] < 0.02
    assert np.abs(covariance.sum(axis=0)).max() < 1e-9


def test_the_share_of_ideal_objects_errs_as_its_deviation_says():
    """Of 500 draws the RMS error is 1.00 of the stated deviation, and 93 % of intervals hold."""
    ideal, off, stated = KINDS["ideal"], [], []
    truth = 0.5 + 0.5 * (2 * stats.norm.cdf(0.1 / 0.8) - 1)
    for seed in range(100):
        edges, _ = drawn(0.5, 40, seed)
        member = fit_shares(edges, TRUE[None], START)
        covariance, *_ = share_covariances(member.part, member.sector, member.share)
        off.append(float(ideal @ member.share[0]) - truth)
        stated.append(float(ideal @ covariance @ ideal) ** 0.5)
    assert 0.8 < np.sqrt(np.mean(np.square(off))) / np.mean(stated) < 1.25
    assert np.mean(np.abs(off) < 1.96 * np.array(stated)) > 0.87


def test_directions_have_shares_of_their_own():
    edges, tau = drawn(0.5)
    along = tau > 0
    mixed = replace(edges, normal_deg=np.where(along, -85.0, 4.0))
    member = fit_shares(mixed, TRUE[None], START)
    share = member.share
    ideal = share @ KINDS["ideal"]
    across, down = sectors_of(np.array([0.0, 90.0]))
    assert ideal[across] > 0.97
    assert ideal[down] < 0.15
    assert set(member.sector) == {across, down}
    # Where no edge is, there is what was before.
    assert share[1] == pytest.approx(PSEUDO_COUNTS / PSEUDO_COUNTS.sum())


def test_sectors_lie_about_their_axes():
    normal_deg = np.array([-90.0, -78.9, -78.5, -11.3, -11.2, 0.0, 11.3, 78.8, 89.0])
    assert sectors_of(normal_deg).tolist() == [4, 4, 5, 7, 0, 0, 1, 4, 4]


def test_every_edge_has_the_softness_of_its_object():
    edges, tau = drawn(0.5)
    member = fit_shares(edges, TRUE[None], START)
    far = tau > 0.5
    assert np.abs(member.mean_px - tau)[far].mean() < 0.05
    assert member.ideal[tau == 0].mean() > 0.8
    assert member.ideal[far].max() < 0.01
    assert member.part.sum(axis=1) == pytest.approx(1.0)


def test_edges_of_another_sensor_are_strange():
    edges, _ = drawn(0.0)
    sharper = STD**2 * edges.pull
    sharper[:30] += 0.3
    mixed = known_to_std(sharper)
    member = fit_shares(mixed, TRUE[None], START)
    share = member.share[0]
    assert member.part[:30, -1].min() > 0.99
    assert share[-1] == pytest.approx(0.05, abs=0.02)


def test_the_gradient_is_that_of_the_likelihood():
    edges, _ = drawn(0.5, 40)
    otf = TRUE[None] * 0.97
    member = fit_shares(edges, otf, START)
    gradient = sum(terms.gradient.sum(axis=0) for terms in sensor_terms(edges, otf, member))

    # At the likeliest shares, with the prior of the shares, their change has no effect.
    def log_posterior(values):
        at = fit_shares(edges, values, member.share)
        return at.log_likelihood + PSEUDO_COUNTS / SECTORS @ np.log(at.share[0])

    for place in range(4):
        step = np.zeros((1, 8))
        step[0, place] = 1e-4
        rise = (log_posterior(otf + step) - log_posterior(otf - step)) / 2e-4
        assert gradient[place] == pytest.approx(rise, rel=0.02, abs=0.5)


def test_the_information_is_the_curvature_of_the_likelihood():
    edges, _ = drawn(0.5, 200, seed=3)
    member = fit_shares(edges, TRUE[None], START)
    start = np.tile(member.part.mean(axis=0) + 1e-3, (SECTORS, 1))
    member = fit_shares(edges, TRUE[None], start)
    (terms,) = sensor_terms(edges, TRUE[None], member)
    step = np.zeros((1, 8))
    step[0, 3] = 2e-3

    def pull(values):
        # Of so many edges the shares hardly move: what changes is what every edge is.
        at = fit_shares(edges, values, member.share)
        (there,) = sensor_terms(edges, values, at)
        return there.gradient.sum(axis=0)[3]

    falls = (pull(TRUE[None] - step) - pull(TRUE[None] + step)) / 4e-3
    assert terms.information.sum(axis=0)[3, 3] == pytest.approx(falls, rel=0.1)


def test_hidden_softness_costs_information():
    edges, _ = drawn(0.6)
    member = fit_shares(edges, TRUE[None], START)
    (complete,), _ = expected_information(edges, member)
    left = observed_information(edges, TRUE[None], member)
    assert np.linalg.eigvalsh(complete - left).min() > -1e-6 * np.trace(complete)
    nyquist = 3
    assert np.linalg.inv(left)[nyquist, nyquist] > np.linalg.inv(complete)[nyquist, nyquist]


def test_ideal_edges_alone_give_the_mean_of_all():
    edges, _ = drawn(0.0, 400)
    member = fit_shares(edges, TRUE[None], START)
    (information,), (projection,) = expected_information(edges, member)
    mean = np.linalg.solve(information, projection)
    assert mean[:4] == pytest.approx(TRUE[:4], abs=4 * STD / 20)
