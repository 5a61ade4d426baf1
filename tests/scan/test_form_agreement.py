"""Edges that are unlike every form of sensor say so."""

import numpy as np
import pytest
from bare_ground import bare_ground

import acutance as ac
from acutance import optics, simulate
from acutance.scan import first_sensor
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.form_agreement import agreement_of_form
from acutance.scan.population import fit_shares
from acutance.scan.shares import START
from acutance.targets.combine.sensor_forms import SCENE_FORMS

FREQ = np.array([0.1, 0.25, 0.4, 0.5])
TRUE = np.concatenate([np.exp(-2 * (np.pi * 0.4 * FREQ) ** 2), np.zeros(4)])[None]
SHIFTED = optics.Sensor(
    [optics.Gaussian(0.35), optics.Detector(), optics.Shift(0.4, 0.25, "cubic")]
)


def chi_square(otf, count, std, seed):
    """Of ideal edges of one direction whose transfer functions are known to a deviation."""
    seen = TRUE + np.random.default_rng(seed).normal(0, std, (count, 8))
    root = np.broadcast_to(np.eye(8) / std, (count, 8, 8))
    edges = EdgeLikelihoods.of_roots(
        FREQ, root, seen / std, np.full(count, 8.0), np.zeros(count, int), np.zeros(count),
    )  # fmt: skip
    return agreement_of_form(edges, otf, fit_shares(edges, otf, START))


def test_about_the_true_sensor_it_is_the_degrees_of_freedom():
    found = [chi_square(TRUE, 60, 0.1, seed) for seed in range(60)]
    assert {one.expected for one in found} == {8}
    # The mean of sixty has a deviation of .5; edges that may be soft pull a little less.
    assert 6.0 < np.mean([one.value for one in found]) < 9.0


def test_what_all_edges_may_have_in_common_is_no_disagreement():
    off = TRUE + np.array([0.002] * 4 + [0.0] * 4)
    assert chi_square(off, 4000, 0.03, 1).value < 20


@pytest.mark.parametrize("part", ["real", "imaginary"])
def test_about_another_sensor_it_is_larger(part):
    off = np.zeros(8)
    off[2 if part == "real" else 6] = 0.08
    assert chi_square(TRUE + off, 60, 0.1, 1).value > 25


@pytest.fixture(scope="module")
def shifted():
    rng = np.random.default_rng(5)
    options = bare_ground(density_per_mpx=90)
    return simulate.landscape(SHIFTED, shape=(760, 760), snr=100, options=options, rng=rng)[0]


def check_of(scene):
    (found,) = (one for one in scene.checks if one.name == "form_agrees")
    return found


def test_a_scene_interpolated_at_one_phase_is_measured(shifted):
    scene = ac.scan_scene(shifted)
    assert check_of(scene).passed
    assert check_of(scene).value < 1.3
    for direction, normal_deg in ((scene.across, 0), (scene.along, 90)):
        true = SHIFTED.response_along(normal_deg).mtf_nyquist.value
        assert abs(direction.mtf_nyquist.value - true) < 3 * direction.mtf_nyquist.std < 0.02


def test_without_a_form_for_it_the_scan_is_doubtful(shifted, monkeypatch):
    known = tuple(terms for terms in SCENE_FORMS if "phase" not in terms)
    monkeypatch.setattr(first_sensor, "SCENE_FORMS", known)
    scene = ac.scan_scene(shifted)
    assert check_of(scene).value > 1.8
    assert scene.verdict.word == "doubtful"
    assert "form of the sensor" in check_of(scene).message
