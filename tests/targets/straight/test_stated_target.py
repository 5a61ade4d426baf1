"""What is stated of a target: soft borders are divided out, uncertainty included."""

import math
import pickle

import numpy as np
import pytest

import acutance as ac
from acutance.errors import OptionError
from acutance.optics import Gaussian, Jitter, Sensor
from acutance.targets.straight.stated_target import (
    MAX_SOFTNESS_PX,
    NOTHING_STATED,
    StatedTarget,
    with_stated_target,
)

SYSTEMS = ac.simulate.reference_systems()
SHAPE = (40, 40)


def softened(sensor, sigma_px, rng=None, **edge):
    """The image of an edge whose border is painted soft, and the truth about the sensor."""
    image, _ = ac.simulate.edge(
        Sensor([*sensor.blocks, Jitter(sigma_px)]), shape=SHAPE, rng=rng, **edge
    )
    _, truth = ac.simulate.edge(sensor, shape=SHAPE, **(edge | {"snr": None}))
    return image, truth


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("sigma_px", [0.1, 0.3])
def test_true_curves_behind_a_border_are_those_of_the_sensor(name, sigma_px):
    _, blurred = ac.simulate.edge(Sensor([*SYSTEMS[name].blocks, Jitter(sigma_px)]))
    _, truth = ac.simulate.edge(SYSTEMS[name])
    found = with_stated_target(blurred.response, StatedTarget(ac.Estimate(sigma_px)))
    assert found.mtf.value == pytest.approx(truth.mtf.value, abs=1e-4)
    # Zero stays where the blurred edge passes 50 %: a trail moves the sharper one by 0.005 px.
    inside = np.abs(found.esf.distance_px) < 4
    assert found.esf.value[inside] == pytest.approx(truth.esf.value[inside], abs=6e-3)
    assert found.rer.value == pytest.approx(truth.rer.value, abs=2e-3)
    assert found.fwhm_px.value == pytest.approx(truth.fwhm_px.value, rel=0.012)


def test_a_softness_of_nothing_changes_nothing():
    _, truth = ac.simulate.edge(SYSTEMS["diffraction"])
    same = with_stated_target(truth.response, StatedTarget(ac.Estimate(0.0)))
    assert same.esf.value == pytest.approx(truth.esf.value, abs=1e-12)
    assert same.lsf.value == pytest.approx(truth.lsf.value, abs=1e-12)
    assert with_stated_target(truth.response, NOTHING_STATED) is truth.response


def test_the_deviations_are_those_of_the_statements():
    """Of exact curves, nothing but the statements is uncertain; differences give the slopes."""
    _, truth = ac.simulate.edge(SYSTEMS["gaussian"])
    sigma, std, level = 0.2, 0.01, 0.004
    stated = StatedTarget(ac.Estimate(sigma, std), level)
    found = with_stated_target(truth.response, stated)
    low, high = (
        with_stated_target(truth.response, StatedTarget(ac.Estimate(sigma + sign * std)))
        for sign in (-1, 1)
    )
    for name, by_level in (("mtf_nyquist", 1.0), ("rer", 1.0), ("fwhm_px", 0.0)):
        value, below, above = (getattr(one, name).value for one in (found, low, high))
        expected = math.hypot((above - below) / 2, by_level * level * value)
        assert getattr(found, name).std == pytest.approx(expected, rel=0.01), name
    assert found.mtf(0.0).std == 0


def test_intervals_hold_the_sensor_behind_borders_drawn_from_the_statement():
    """Without the term they hold it in less than half of the draws, with it twice in nearly all."""
    rng = np.random.default_rng(29)
    softness = ac.Estimate(0.2, 0.03)
    options = ac.EdgeOptions(target_softness_px=softness)
    names = ("mtf_nyquist", "rer", "fwhm_px")
    errors, alone = [], []
    for i in range(320):
        sensor = list(SYSTEMS.values())[i % len(SYSTEMS)]
        sigma_px = abs(rng.normal(softness.value, softness.std))
        image, truth = softened(
            sensor, sigma_px, rng,
            angle_deg=rng.uniform(4, 20), offset_px=rng.uniform(-0.5, 0.5), snr=300.0,
        )  # fmt: skip
        m = ac.measure_edge(image, options=options)
        errors.append([
            (getattr(m, name).value - getattr(truth, name).value) / getattr(m, name).std
            for name in names
        ])  # fmt: skip
        term = next(term for term in m.budget if term.name == "target_softness")
        alone.append([math.sqrt(1 - term.share[name]) for name in names])
    errors = np.array(errors)
    held = np.mean(np.abs(errors) < 1.96)
    assert 0.93 <= held <= 0.97
    # A term that is dropped, or counted twice, is seen by the same bounds.
    assert np.mean(np.abs(errors / np.array(alone)) < 1.96) < 0.7
    assert np.mean(np.abs(errors / np.sqrt(4 - 3 * np.array(alone) ** 2)) < 1.96) > 0.97


@pytest.mark.parametrize("method", ["spline", "fermi"])
def test_metres_are_those_along_the_normal_and_every_method_takes_them(method):
    image, _ = ac.simulate.edge(SYSTEMS["gaussian"], snr=200, rng=np.random.default_rng(4))
    plain = ac.measure_edge(image, gsd_m=0.5, method=method)
    options = ac.EdgeOptions(target_softness_m=0.1)
    stated = ac.measure_edge(image, gsd_m=0.5, method=method, options=options)
    gain = math.exp(2 * math.pi**2 * 0.25 * 0.2**2)
    assert stated.mtf_nyquist.value == pytest.approx(gain * plain.mtf_nyquist.value)
    assert stated.failed_checks == plain.failed_checks
    options = ac.EdgeOptions(target_softness_px=0.2)
    in_pixels = ac.measure_edge(image, gsd_m=0.5, method=method, options=options)
    assert in_pixels.mtf_nyquist.value == pytest.approx(stated.mtf_nyquist.value)


def test_a_pulse_with_soft_borders_shows_the_sensor():
    sensor, sigma_px = Sensor([Gaussian(0.4), ac.optics.Detector()]), 0.25
    rng = np.random.default_rng(6)
    image, _ = ac.simulate.pulse(
        Sensor([*sensor.blocks, Jitter(sigma_px)]), width_px=4, angle_deg=7, snr=200, rng=rng
    )
    _, truth = ac.simulate.pulse(sensor, width_px=4, angle_deg=7)
    options = ac.PulseOptions(target_softness_px=ac.Estimate(sigma_px, 0.02))
    m = ac.measure_pulse(image, width_px=4, options=options)
    assert abs(m.mtf_nyquist.value - truth.mtf_nyquist.value) < 2 * m.mtf_nyquist.std
    assert (
        abs(ac.measure_pulse(image, width_px=4).mtf_nyquist.value / truth.mtf_nyquist.value) < 0.8
    )


def test_copies_and_light_halves_state_the_same():
    image, _ = ac.simulate.edge(SYSTEMS["halo"], snr=100, rng=np.random.default_rng(8))
    options = ac.EdgeOptions(target_softness_px=ac.Estimate(0.2, 0.05), level_uncertainty=0.01)
    m = ac.measure_edge(image, options=options)
    for copy in (pickle.loads(pickle.dumps(m)), m.without_details()):
        assert copy.stated == m.stated
        assert copy.mtf.value == pytest.approx(m.mtf.value, abs=1e-12)
        assert copy.mtf.std == pytest.approx(m.mtf.std, rel=1e-6)
        assert copy.rer == m.rer


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"target_softness_m": 0.1, "target_softness_px": 0.2}, "give one"),
        ({"target_softness_px": -0.1}, "0 or more"),
        ({"target_softness_px": ac.Estimate(0.1, math.inf)}, "0 or more"),
        ({"level_uncertainty": 0.5}, "between 0 and 0.2"),
        ({"level_uncertainty": -0.01}, "between 0 and 0.2"),
    ],
)
@pytest.mark.parametrize("options", [ac.EdgeOptions, ac.PulseOptions])
def test_statements_out_of_range_are_refused(options, given, complaint):
    with pytest.raises(OptionError, match=complaint):
        options(**given)


def test_a_border_that_hides_the_sensor_and_metres_without_a_gsd_are_refused():
    image, _ = ac.simulate.edge(SYSTEMS["gaussian"])
    options = ac.EdgeOptions(target_softness_px=MAX_SOFTNESS_PX + 0.01)
    with pytest.raises(OptionError, match="hides the sensor"):
        ac.measure_edge(image, options=options)
    with pytest.raises(OptionError, match="needs a GSD"):
        ac.measure_edge(image, options=ac.EdgeOptions(target_softness_m=0.1))


def sharp_edge(angle_deg=6.0):
    """An edge of a clean target behind little more than a full pixel."""
    sensor = Sensor([Gaussian(0.15), ac.optics.Detector()])
    return ac.simulate.edge(
        sensor, angle_deg=angle_deg, snr=100, shape=(60, 60), rng=np.random.default_rng(3)
    )[0]


def check_of(measurement, name):
    return next(check for check in measurement.checks if check.name == name)


def test_a_softness_behind_which_no_sensor_is_possible_makes_the_number_doubtful():
    image = sharp_edge()
    assert "full_pixel" not in {check.name for check in ac.measure_edge(image).failed_checks}
    found = ac.measure_edge(image, options=ac.EdgeOptions(target_softness_px=0.3))
    check = check_of(found, "full_pixel")
    assert not found.trusted
    assert check.severity == "caution"
    assert check.value == pytest.approx(found.mtf_nyquist.value - 2 * found.mtf_nyquist.std)
    assert "the border is sharper than stated" in check.message


def test_a_softness_that_leaves_no_detector_is_a_failure():
    found = ac.measure_edge(sharp_edge(), options=ac.EdgeOptions(target_softness_px=0.39))
    check = check_of(found, "lsf_width_px")
    assert found.verdict.word == "invalid"
    assert check.value == pytest.approx(found.fwhm_px.value)
    assert "the border is sharper than stated" in check.message


def test_a_pulse_with_an_impossible_softness_is_named_too():
    sensor = Sensor([Gaussian(0.15), ac.optics.Detector()])
    image, _ = ac.simulate.pulse(sensor, width_px=4, snr=100, rng=np.random.default_rng(3))
    options = ac.PulseOptions(target_softness_px=0.35)
    found = ac.measure_pulse(image, width_px=4, options=options)
    assert check_of(found, "full_pixel").severity == "caution"
    assert not found.trusted


def test_an_uncertain_statement_is_not_refuted():
    """Its interval reaches what a sensor can be."""
    options = ac.EdgeOptions(target_softness_px=ac.Estimate(0.25, 0.15))
    found = ac.measure_edge(sharp_edge(), options=options)
    assert check_of(found, "full_pixel").passed


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_true_statement_fails_neither_check(name):
    for seed in range(6):
        rng = np.random.default_rng(seed)
        image, _ = softened(SYSTEMS[name], 0.3, rng, angle_deg=8, snr=100)
        found = ac.measure_edge(image, options=ac.EdgeOptions(target_softness_px=0.3))
        assert check_of(found, "full_pixel").passed
        assert check_of(found, "lsf_width_px").passed


def test_an_image_that_is_too_sharp_by_itself_is_not_laid_to_the_statement():
    image = sharp_edge()
    decimated = ac.simulate.edge(SYSTEMS["gaussian"], angle_deg=7, shape=(240, 240))[0][::4, ::4]
    assert image.shape == decimated.shape
    found = ac.measure_edge(decimated, options=ac.EdgeOptions(target_softness_px=0.05))
    check = check_of(found, "full_pixel")
    assert not check.passed
    assert "stated" not in check.message
