"""Values that are not proportional to light, and sensors that only look so."""

import re

import numpy as np
import pytest

import acutance as ac
from acutance import optics
from acutance.targets.straight.nonlinearity import gamma_of

SYSTEMS = ac.simulate.reference_systems()
FULL_SCALE = 255.0


def edge(sensor, seed, gamma=1.0, snr=100.0, noise=None, dark=None, bright=None):
    """An edge of 40 to 60 px and SNR 100 whose values are the 1 / gamma-th power of light."""
    rng = np.random.default_rng(seed)
    levels = [(50.0, 200.0), (20.0, 220.0), (30.0, 160.0)][seed % 3]
    size = int(rng.integers(40, 61))
    image, _ = ac.simulate.edge(
        sensor, angle_deg=float(rng.uniform(3, 15)), shape=(size, size),
        dark=levels[0] if dark is None else dark, bright=levels[1] if bright is None else bright,
        polarity=("rising", "falling")[seed % 2], orientation=("across", "along")[seed // 2 % 2],
        offset_px=float(rng.uniform(-0.5, 0.5)), snr=snr if noise is None else None, noise=noise,
        rng=rng,
    )  # fmt: skip
    return FULL_SCALE * (np.clip(np.asarray(image), 0, None) / FULL_SCALE) ** (1 / gamma)


def check(measurement):
    return next(one for one in measurement.checks if one.name == "nonlinearity")


def fired(sensor, seeds, **options):
    return np.mean([not check(ac.measure_edge(edge(sensor, s, **options))).passed for s in seeds])


@pytest.mark.parametrize("name", ["gaussian", "wide", "diffraction", "halo", "sharpened"])
def test_a_gamma_of_1_3_is_seen(name):
    assert fired(SYSTEMS[name], range(12), gamma=1.3) >= 9 / 12


def test_a_gamma_of_2_2_is_seen_and_named():
    gammas = []
    for seed in range(6):
        found = ac.measure_edge(edge(SYSTEMS["diffraction"], seed, gamma=2.2))
        assert not check(found).passed
        named = re.search(
            r"above a straight line .* a gamma of (.+) ± (.+) gives", check(found).message
        )
        gammas.append([float(number) for number in named.groups()])
        assert "--gamma" in check(found).message
        assert found.verdict.word == "doubtful"
    value, std = np.array(gammas).T
    assert np.all(np.abs(value - 2.2) < 2 * std)
    assert np.mean(value) == pytest.approx(2.2, abs=0.25)


def softly_saturated(sensor, seed, share, begins, snr=100.0):
    """An edge whose values bend from a share of the contrast on, noise included."""
    light = edge(sensor, seed, noise=ac.simulate.Noise(read=0.0), dark=0.0, bright=1.0)
    light = light + np.random.default_rng((7, seed)).normal(0, 1 / snr, light.shape)
    bent = light - share * np.maximum(light - begins, 0) ** 2 / (1 - begins)
    return 40 + 160 * bent


@pytest.mark.parametrize("begins", [0.55, 0.7, 0.85])
def test_a_soft_shoulder_is_seen_and_named(begins):
    names = ["gaussian", "wide", "diffraction", "halo", "sharpened", "defocused"]
    found = [
        check(ac.measure_edge(softly_saturated(SYSTEMS[names[seed % 6]], seed, 0.25, begins)))
        for seed in range(12)
    ]
    assert np.mean([not one.passed for one in found]) >= 10 / 12
    assert np.mean(["saturates softly" in one.message for one in found]) >= 7 / 12


def test_a_shoulder_before_the_noise_is_warned_of_where_overshoots_bend():
    for seed in range(4):
        light = edge(
            SYSTEMS["sharpened"], seed, noise=ac.simulate.Noise(read=0.0), dark=0.0, bright=1.0
        )
        bent = light - 0.25 * np.maximum(light - 0.7, 0) ** 2 / 0.3
        noise = np.random.default_rng((8, seed)).normal(0, 0.01, light.shape)
        measured = ac.measure_edge(40 + 160 * (bent + noise))
        assert measured.verdict.word in ("doubtful", "invalid")


@pytest.mark.parametrize("snr", [30.0, 500.0])
def test_linear_sensors_pass_at_any_noise(snr):
    alarms = [fired(SYSTEMS[name], range(20, 26), snr=snr) for name in SYSTEMS]
    assert np.mean(alarms) <= 1 / 48


@pytest.mark.parametrize(
    "name",
    ["gaussian", "wide", "diffraction", "halo", "sharpened", "defocused", "smeared", "asymmetric"],
)
def test_linear_sensors_pass(name):
    assert fired(SYSTEMS[name], range(10)) == 0


@pytest.mark.parametrize("trail_px", [0.1, 0.2, 0.6])
def test_a_trail_is_no_curve(trail_px):
    trail = [optics.Exponential(trail_px, "across"), optics.Exponential(trail_px, "along")]
    sensor = ac.Sensor([optics.Gaussian(0.35), *trail, optics.Detector()])
    assert fired(sensor, range(12)) <= 1 / 12


def test_noise_of_photons_is_no_curve():
    noise = ac.simulate.Noise(read=0.5, shot_gain=0.02)
    assert fired(SYSTEMS["diffraction"], range(12), noise=noise) <= 1 / 12


@pytest.mark.parametrize("bright", [False, True])
def test_a_pulse_shows_both_polarities(bright):
    levels = {"dark": 20.0, "bright": 220.0}
    for seed in range(3):
        rng = np.random.default_rng(seed)
        image, _ = ac.simulate.pulse(
            SYSTEMS["sharpened"], width_px=5.0, shape=(60, 60), snr=100, rng=rng, **levels
        )
        light = np.asarray(image) if bright else sum(levels.values()) - np.asarray(image)
        assert check(ac.measure_pulse(light, width_px=5.0)).passed
        values = FULL_SCALE * (np.clip(light, 0, None) / FULL_SCALE) ** (1 / 1.3)
        found = check(ac.measure_pulse(values, width_px=5.0))
        assert not found.passed
        assert "above a straight line" in found.message


def narrow_pulse(seed, gamma=1.0):
    """A pulse of 2.5 to 3.5 px at SNR 150, bright or dark: its top is never flat."""
    rng = np.random.default_rng((11, seed))
    width_px = float(rng.uniform(2.5, 3.5))
    image, _ = ac.simulate.pulse(
        SYSTEMS[("gaussian", "diffraction", "halo", "wide")[seed % 4]], width_px=width_px,
        shape=(60, 40), snr=150, dark=20.0, bright=220.0, rng=rng,
        angle_deg=float(rng.uniform(3, 12)), offset_px=float(rng.uniform(-0.5, 0.5)),
    )  # fmt: skip
    light = np.asarray(image) if seed % 2 else 240.0 - np.asarray(image)
    return FULL_SCALE * (np.clip(light, 0, None) / FULL_SCALE) ** (1 / gamma), width_px


def test_the_noise_of_a_narrow_pulse_shows_a_curve():
    for gamma, allowed in ((1.0, (0, 1)), (1.3, (11, 16))):
        pulses = [narrow_pulse(seed, gamma) for seed in range(16)]
        found = [check(ac.measure_pulse(image, width_px=px)) for image, px in pulses]
        named = sum(not one.passed for one in found)
        assert allowed[0] <= named <= allowed[1]
        assert all("above a straight line" in one.message for one in found if not one.passed)


def test_the_gamma_of_a_curvature():
    for gamma in (0.7, 1.3, 2.2):
        dark, bright = (np.array([20.0, 220.0]) / 255) ** (1 / gamma) * 255
        middle = (120 / 255) ** (1 / gamma) * 255
        bend = 4 * ((middle - dark) / (bright - dark) - 0.5)
        assert gamma_of(bend, 0.05, dark, bright).startswith(f"a gamma of {gamma:.2f} ± 0.")
    assert gamma_of(0.2, 0.05, -5.0, 100.0) == ""


def shaded_pulse(seed, snr=100.0):
    """A bright pulse with a shadow of 5 to 10 % of its height beside it."""
    rng = np.random.default_rng((9, seed))
    width_px, shade_px = float(rng.uniform(3, 8)), float(rng.uniform(2, 8))
    image, truth = ac.simulate.pulse(
        SYSTEMS[("gaussian", "diffraction", "halo", "defocused")[seed % 4]], width_px=width_px,
        shape=(60, 60), noise=ac.simulate.Noise(read=0.0), dark=20.0, bright=220.0,
        angle_deg=float(rng.uniform(4, 15)), rng=rng,
    )  # fmt: skip
    s = truth.line.normal_distance(*np.indices(image.shape)) - width_px
    begins, ends = (
        np.interp(s - place, truth.esf.distance_px, truth.esf.value) for place in (0.0, shade_px)
    )
    image = image - 200 * float(rng.uniform(0.05, 0.1)) * (begins - ends)
    return image + rng.normal(0, 200 / snr, image.shape), width_px


def test_a_shadow_beside_a_pulse_is_no_curve():
    pulses = [shaded_pulse(seed) for seed in range(12)]
    found = [ac.measure_pulse(image, width_px=px) for image, px in pulses]
    assert sum(not check(one).passed for one in found) <= 1
