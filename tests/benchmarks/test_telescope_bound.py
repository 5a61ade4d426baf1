"""The Bayesian bound of the benchmark of telescopes: its images are right, and so its posterior."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import acutance as ac

FILE = Path(__file__).parents[2] / "benchmarks" / "telescope_bound.py"


@pytest.fixture(scope="module")
def bound():
    spec = importlib.util.spec_from_file_location("telescope_bound", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def population(bound):
    return bound.Population.drawn(100, 40, np.random.default_rng(1))


def drawn_edge(bound, rng, **wanted):
    sensor = ac.Sensor([bound.draw_aperture(rng), *bound.draw_blur(rng)])
    angle = float(rng.uniform(*bound.ANGLE_DEG))
    return sensor, *ac.simulate.edge(sensor, angle_deg=angle, rng=rng, **wanted)


def test_images_of_a_telescope_are_those_of_its_profile(bound, population):
    sensor, _, truth = drawn_edge(bound, np.random.default_rng(2))
    distance_px = np.linspace(-25, 25, 201)
    esf, lsf = population._images(distance_px)
    direction = np.deg2rad(truth.line.normal_deg)
    freq_cpp = np.arange(len(population.otf)) * bound.STEP_CPP
    otf = sensor.otf(freq_cpp * np.cos(direction), freq_cpp * np.sin(direction)).real
    share = otf @ population.otf
    profile = sensor.profile(truth.line.normal_deg)
    assert 0.5 + esf @ share == pytest.approx(profile.esf(distance_px + profile.half_px), abs=2e-4)
    assert lsf @ share == pytest.approx(profile.lsf(distance_px + profile.half_px), abs=1e-4)


def test_a_likelihood_is_that_of_least_squares_over_levels_and_place(bound, population):
    _, image, truth = drawn_edge(bound, np.random.default_rng(3), shape=(15, 15), snr=30)
    distance_px = truth.line.normal_distance(*np.indices(image.shape)).ravel()
    value = image.ravel() / 33.3
    found = population._log_likelihood(distance_px, value)[:5]
    esf, lsf = population._images(distance_px)
    expected = []
    for share in population.share[:5]:
        design = np.stack([np.ones_like(value), esf @ share, lsf @ share], axis=1)
        left = value - design @ np.linalg.lstsq(design, value, rcond=None)[0]
        expected.append(-0.5 * (left @ left + np.linalg.slogdet(design.T @ design)[1]))
    assert np.diff(found) == pytest.approx(np.diff(expected), abs=1e-6)


def test_posteriors_err_as_much_as_they_state(bound, population):
    rng = np.random.default_rng(4)
    z, std, effective = [], [], []
    for _ in range(30):
        _, image, truth = drawn_edge(bound, rng, shape=(20, 20), snr=50)
        found = population.posterior(image, truth, 20.0)
        z.append((found.mean - truth.mtf_nyquist.value) / found.std)
        std.append(found.std)
        effective.append(found.effective)
    assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.4
    assert np.median(std) < 0.5 * population.nyquist.std()
    assert np.median(effective) > 30
