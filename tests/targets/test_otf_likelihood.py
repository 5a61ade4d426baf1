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
    """A spectrum of random shapes about a mean: its likelihood, and the misfit of its pixels."""
    mean, shapes = complexes(PLACES + 1), 0.3 * complexes(PLACES + 1, SHAPES)
    # Light is real.
    mean[0], shapes[0] = 1.0, shapes[0].real
    seen = RNG.standard_normal((PIXELS, SHAPES))
    precision = seen.T @ seen / NOISE**2
    pixels = seen @ RNG.standard_normal(SHAPES) + NOISE * RNG.standard_normal(PIXELS)
    covariance = np.linalg.inv(precision + np.eye(SHAPES))
    away = shapes @ covariance @ seen.T @ pixels / NOISE**2
    factor = shapes @ np.linalg.cholesky(covariance)
    likelihood = OtfLikelihood.of_posterior(mean + away, away, factor, shapes)
    return mean, shapes, likelihood, lambda weights: np.sum((pixels - seen @ weights) ** 2)


def test_it_is_that_of_the_pixels(problem):
    mean, shapes, likelihood, squares = problem

    def found(weights):
        light, *spectrum = mean + shapes @ weights
        off = likelihood.whitened(np.array(spectrum)) + light.real * likelihood.level
        return np.sum((off - likelihood.values) ** 2)

    drawn = RNG.standard_normal((6, SHAPES))
    wanted = [(squares(one) - squares(drawn[0])) / NOISE**2 for one in drawn]
    assert [found(one) - found(drawn[0]) for one in drawn] == pytest.approx(wanted, rel=2e-3)


def test_further_errors_add_to_the_covariance(problem):
    likelihood = problem[2]
    factor = complexes(PLACES, 2)
    root, lever = stacked(likelihood.root), stacked(factor)
    # Errors of what the pixels do not show change nothing.
    inside = root @ np.linalg.pinv(root) @ lever
    wanted = np.linalg.pinv(np.linalg.pinv(root @ root.T) + inside @ inside.T, rcond=1e-10)
    found = stacked(likelihood.with_errors(factor).root)
    assert found @ found.T == pytest.approx(wanted, rel=1e-6, abs=1e-6)


def test_a_document_holds_it(problem):
    likelihood = problem[2]
    again = OtfLikelihood.from_dict(json.loads(json.dumps(likelihood.to_dict())))
    otf = complexes(PLACES)
    squares = [np.sum(one.residual(otf) ** 2) for one in (likelihood, again)]
    assert squares[1] == pytest.approx(squares[0], rel=5e-3)


@pytest.mark.parametrize(("light", "place_px"), [(1.3, 0.0), (0.8, 0.15), (1.0, -0.2)])
def test_neither_light_nor_place_matters(light, place_px):
    """What a spectrum of other light at another place leaves of an OTF near by is the same."""
    freq = np.arange(1, 9) / 20
    otf = np.exp(-3 * freq**2) + 0j
    waves = -2j * np.pi * freq[:, None]
    root, level = 50 * complexes(freq.size, 12), 80 * RNG.standard_normal(12)
    noise = RNG.standard_normal(12)

    def near(light, place_px):
        spectrum = light * otf * np.exp(waves[:, 0] * place_px)
        values = stacked(root).T @ stacked(spectrum) + light * level + noise
        return OtfLikelihood(root, level, values).near(otf, waves)

    there, here = near(light, place_px), near(1.0, 0.0)
    assert there.values.size == 12 - 2
    assert np.sum(there.residual(otf) ** 2) == pytest.approx(
        np.sum(here.residual(otf) ** 2), rel=0.15
    )
    assert np.sum(there.residual(otf) ** 2) < np.sum(noise**2)


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
    near = slices.likelihood.near(true, -2j * np.pi * slices.freq_cpp[:, None])
    z = near.residual(true)
    assert 8 < z.size < 2 * slices.freq_cpp.size
    assert 0.4 < np.mean(z**2) < 1.6
    assert ac.measure_edge(image, method="iso12233").slices.likelihood is None


def test_the_light_half_and_the_record_keep_it(edge):
    found = ac.measure_edge(edge[1])
    light = found.without_details()
    for slices in (light.slices, found.record.slices, OtfSlices.from_dict(found.slices.to_dict())):
        squares = [np.sum(one.likelihood.residual(one.otf) ** 2) for one in (slices, light.slices)]
        assert squares[0] == pytest.approx(squares[1], rel=0.01)


def test_what_is_stated_of_the_target_makes_pixels_say_less(edge):
    def precision(options):
        """Of all of the OTF together, as uncertain levels change it."""
        slices = ac.measure_edge(edge[1], options=options).slices
        return np.sum(slices.likelihood.whitened(slices.otf) ** 2)

    exact, stated = precision(None), precision(ac.EdgeOptions(level_uncertainty=0.02))
    assert 1 / stated - 1 / exact == pytest.approx(0.02**2, rel=0.1)


def test_pixels_of_a_sharpened_sensor_say_what_it_is():
    """A prior that hardly allows for it leaves chi-square 4 to 20 times its freedom."""
    sensor = optics.Sensor(
        [optics.Gaussian(0.55), optics.Detector(), optics.Sharpening.both_axes(0.36)]
    )
    rng, found = np.random.default_rng(7), []
    for _ in range(6):
        image, _ = simulate.edge(sensor, angle_deg=6, shape=(50, 50), snr=100, rng=rng)
        slices = ac.measure_edge(image).slices
        true = sensor.otf(*slices.places)
        near = slices.likelihood.near(true, -2j * np.pi * slices.freq_cpp[:, None])
        found.append(np.mean(near.residual(true) ** 2))
    assert 0.5 < np.mean(found) < 1.5


@pytest.mark.parametrize("change", [{"level": [1.0]}, {"root_real": [[1.0]]}])
def test_a_changed_document_is_refused(edge, change):
    document = ac.measure_edge(edge[1]).slices.to_dict()
    document["likelihood"] |= change
    with pytest.raises(ac.OptionError, match="slices of the OTF"):
        OtfSlices.from_dict(document)


def test_of_more_values_than_an_otf_has_a_document_keeps_the_level():
    root, level = complexes(PLACES, 2 * PLACES + 3), np.zeros(2 * PLACES + 3)
    root[:, -1], level[-1] = 0.0, 1e5
    values = np.append(RNG.standard_normal(2 * PLACES + 2), 1e5)
    whole = OtfLikelihood(100 * root, level, values)
    kept = OtfLikelihood.from_dict(json.loads(json.dumps(whole.to_dict())))
    assert np.linalg.norm(kept.level) == pytest.approx(1e5)
    for _ in range(4):
        otf = complexes(PLACES)
        wanted = np.sum(whole.residual(otf) ** 2)
        assert np.sum(kept.residual(otf) ** 2) == pytest.approx(wanted, rel=1e-3)
