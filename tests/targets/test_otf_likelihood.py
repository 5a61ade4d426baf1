"""What the pixels say of an OTF, taken out of a posterior."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.numerics.stacked import stacked
from acutance.targets import OtfSlices
from acutance.targets.otf_likelihood import OtfLikelihood

RNG = np.random.default_rng(3)
PLACES, SHAPES, PIXELS, NOISE = 4, 5, 40, 2.0


def complexes(*shape):
    return RNG.standard_normal(shape) + 1j * RNG.standard_normal(shape)


@pytest.fixture(scope="module")
def problem():
    """An OTF of random shapes about a mean, seen by pixels: its posterior, and its likelihood."""
    mean, shapes = complexes(PLACES), 0.3 * complexes(PLACES, SHAPES)
    seen = RNG.standard_normal((PIXELS, SHAPES))
    precision = seen.T @ seen / NOISE**2
    pixels = seen @ RNG.standard_normal(SHAPES) + NOISE * RNG.standard_normal(PIXELS)
    covariance = np.linalg.inv(precision + np.eye(SHAPES))
    best = covariance @ seen.T @ pixels / NOISE**2
    factor = shapes @ np.linalg.cholesky(covariance)
    likelihood = OtfLikelihood.of_posterior(shapes @ best, factor, shapes)
    return mean, shapes, best, likelihood, lambda weights: np.sum((pixels - seen @ weights) ** 2)


def test_it_is_that_of_the_pixels(problem):
    mean, shapes, best, likelihood, squares = problem
    posterior = mean + shapes @ best

    def found(weights):
        otf = mean + shapes @ weights
        return np.sum((likelihood.whitened(otf - posterior) - likelihood.offset) ** 2)

    drawn = RNG.standard_normal((6, SHAPES))
    wanted = [(squares(one) - squares(drawn[0])) / NOISE**2 for one in drawn]
    assert [found(one) - found(drawn[0]) for one in drawn] == pytest.approx(wanted, rel=2e-3)


def test_further_errors_add_to_the_covariance(problem):
    likelihood = problem[3]
    factor = complexes(PLACES, 2)
    root, lever = stacked(likelihood.root), stacked(factor)
    # Errors of what the pixels do not show change nothing.
    inside = root @ np.linalg.pinv(root) @ lever
    wanted = np.linalg.pinv(np.linalg.pinv(root @ root.T) + inside @ inside.T, rcond=1e-10)
    found = stacked(likelihood.with_errors(factor).root)
    assert found @ found.T == pytest.approx(wanted, rel=1e-6, abs=1e-6)


def test_a_document_holds_it(problem):
    likelihood = problem[3]
    again = OtfLikelihood.from_dict(json.loads(json.dumps(likelihood.to_dict())))
    otf = complexes(PLACES)
    squares = [np.sum((one.whitened(otf) - one.offset) ** 2) for one in (likelihood, again)]
    assert squares[1] == pytest.approx(squares[0], rel=5e-3)


@pytest.fixture(scope="module")
def edge():
    sensor = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])
    image, _ = simulate.edge(sensor, angle_deg=6, snr=100, rng=np.random.default_rng(1))
    return sensor, image


def test_an_edge_says_what_its_pixels_say(edge):
    sensor, image = edge
    found = ac.measure_edge(image)
    slices = found.slices
    true = sensor.otf(*slices.places)
    z = slices.likelihood.whitened(true - slices.otf) - slices.likelihood.offset
    assert 8 < z.size < 2 * slices.freq_cpp.size
    assert 0.2 < np.mean(z**2) < 2
    # Pixels say less than pixels and prior together.
    about = slices.likelihood.root
    assert np.linalg.norm(stacked(about), 2) < 1 / 2e-3
    assert ac.measure_edge(image, method="iso12233").slices.likelihood is None


def test_the_light_half_and_the_record_keep_it(edge):
    found = ac.measure_edge(edge[1])
    light = found.without_details()
    for slices in (light.slices, found.record.slices, OtfSlices.from_dict(found.slices.to_dict())):
        assert slices.likelihood.offset == pytest.approx(light.slices.likelihood.offset, abs=0.02)


def test_what_is_stated_of_the_target_makes_pixels_say_less(edge):
    def precision(options):
        """Of all of the OTF together, as uncertain levels change it."""
        slices = ac.measure_edge(edge[1], options=options).slices
        return np.sum(slices.likelihood.whitened(slices.otf) ** 2)

    exact, stated = precision(None), precision(ac.EdgeOptions(level_uncertainty=0.02))
    assert 1 / stated - 1 / exact == pytest.approx(0.02**2, rel=0.1)


@pytest.mark.parametrize("change", [{"offset": [1.0]}, {"root_real": [[1.0]]}])
def test_a_changed_document_is_refused(edge, change):
    document = ac.measure_edge(edge[1]).slices.to_dict()
    document["likelihood"] |= change
    with pytest.raises(ac.OptionError, match="slices of the OTF"):
        OtfSlices.from_dict(document)
