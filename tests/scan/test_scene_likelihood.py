"""What the edges of a scene say of its sensor alone: one more measurement of a combination."""

import json

import numpy as np
import pytest
from bare_ground import bare_ground

import acutance as ac
from acutance import optics, simulate
from acutance.curves import Otf2d
from acutance.scan.scene_likelihood import likelihood_of_slices
from acutance.scan.stated_objects import OtfBehindObjects
from acutance.targets.combine.curves import OtfSamples
from acutance.targets.combine.fit import combine_curves
from acutance.targets.slices import OtfSlices

SENSOR = simulate.reference_systems()["gaussian"]
U_CPP, V_CPP = np.array([0.5, 0.0, 0.25]), np.array([0.0, 0.5, 0.25])
CERTAIN = (ac.Estimate(0.0), ac.Estimate(0.0))
FEW_FORMS = ac.CombineOptions(forms=(("gaussian",), ("gaussian", "halo")))


@pytest.fixture(scope="module")
def scene():
    image, _ = simulate.landscape(
        SENSOR, shape=(600, 600), snr=100, options=bare_ground(), rng=np.random.default_rng(5)
    )
    return ac.scan_scene(image)


def numbers(model):
    """MTF and its standard deviations."""
    otf, factor = model.otf(U_CPP, V_CPP), model.factor(U_CPP, V_CPP)
    along = np.real(np.conj(otf / np.abs(otf))[:, None] * factor)
    return np.abs(otf), np.sqrt(np.sum(along**2, axis=1))


def combined(slices):
    """The forms of sensors fitted to what the edges say."""
    samples = OtfSamples("scene", *slices.places, slices.otf, slices.factor, slices.likelihood)
    return numbers(combine_curves([samples]).unwidened)


def test_with_the_prior_of_the_forms_it_is_the_scene_again(scene):
    document = json.loads(json.dumps(scene.to_dict()))
    kept = ac.Record.from_dict(document).slices
    (mtf, std), (own, own_std) = combined(kept), numbers(scene.otf.model)
    assert np.all(np.abs(mtf - own) < 0.4 * own_std)
    assert std == pytest.approx(own_std, rel=0.25)


@pytest.mark.parametrize("row", [(0.03, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.005)])
def test_errors_that_all_edges_have_in_common_stay(scene, row):
    fit = scene.details
    model = OtfBehindObjects(fit.otf, CERTAIN, {"in common": np.array([row])})
    slices = OtfSlices.of_otf2d(Otf2d(model))
    said = OtfSlices(
        slices.normal_deg, slices.freq_cpp, slices.otf, slices.factor,
        likelihood_of_slices(fit, model, slices),
    )  # fmt: skip
    (mtf, std), (own, own_std) = combined(said), numbers(model)
    assert np.all(np.abs(mtf - own) < 0.7 * own_std)
    # The prior of the forms knows something of such a blur, too.
    assert np.all(std > 0.6 * own_std)


def test_the_same_of_objects_whose_softness_is_stated(scene):
    fit = scene.details
    soft = ac.Estimate(0.04, 0.002)
    model = OtfBehindObjects(fit.otf, (soft, soft))
    slices = OtfSlices.of_otf2d(Otf2d(model))
    said = likelihood_of_slices(fit, model, slices)
    plain = OtfSlices.of_otf2d(Otf2d(fit.otf))
    behind = likelihood_of_slices(fit, fit.otf, plain)
    # What the sensor behind the objects leaves is what it leaves with them.
    assert np.sum(said.residual(slices.otf) ** 2) == pytest.approx(
        np.sum(behind.residual(plain.otf) ** 2), abs=0.5
    )


def with_an_edge(scene, sensor, snr=60, options=FEW_FORMS):
    """A scan and an edge, 30 degrees off the grid."""
    image, _ = simulate.edge(sensor, angle_deg=30, snr=snr, rng=np.random.default_rng(2))
    return ac.combine([scene, ac.measure_edge(image)], options=options)


def test_chi_square_expects_of_a_scene_what_it_was_not_fitted_to(scene):
    both = with_an_edge(scene, SENSOR)
    values = [one.likelihood.values.size for one in (scene.slices, both.details.data.curves[1])]
    # Of the scene's own values forms follow a few, and the combination these.
    assert both.plain_sensor.expected < values[1] < values[0]
    assert 0.3 * both.plain_sensor.expected < both.plain_sensor.value
    assert both.plain_sensor.p_value > 0.1
    assert both.chi_square.p_value > 0.1
    assert both.birge_ratio == 1


def test_a_scene_fits_beside_an_edge_that_hardly_counts(scene):
    """A mean over other forms than the scan's own misses that by some of its deviations."""
    other = ac.CombineOptions(forms=(("gaussian", "close halo"),))
    both = with_an_edge(scene, SENSOR, snr=12, options=other)
    (own, _) = both.parts
    assert own.chi_square.expected < 1.5
    assert own.chi_square.p_value > 0.05


def test_an_edge_of_another_sensor_is_told_from_that_of_a_scene(scene):
    other = ac.Sensor([optics.Gaussian(0.45), optics.Detector(1.0)])
    both = with_an_edge(scene, other)
    assert both.plain_sensor.p_value < 1e-4
    assert both.chi_square.p_value < 1e-6
    failed = {check.name for check in both.failed_checks}
    assert {"agreement", "plain_sensor"} <= failed
