"""Checks under noise whose pixels are alike, and what ringing and strips do to others."""

import numpy as np
import pytest
from scipy import ndimage

import acutance as ac
from acutance import simulate
from acutance.optics import Detector, Gaussian, Sensor, Sharpening

PLAIN = Sensor([Gaussian(0.45), Detector()])
SHARPENED = Sensor(
    [Gaussian(0.6), Detector(), Sharpening(((0, -0.15, 0), (-0.15, 1.6, -0.15), (0, -0.15, 0)))]
)


def grained(shape, grain_px, std, seed):
    """Noise of a standard deviation whose grains are Gaussians."""
    rows, cols = shape
    noise = np.random.default_rng(seed).standard_normal((rows + 20, cols + 20))
    noise = ndimage.gaussian_filter(noise, grain_px)[10:-10, 10:-10]
    return std * noise / noise.std()


def check(found, name):
    (own,) = (one for one in found.checks if one.name == name)
    return own


@pytest.mark.parametrize(("wave_px", "told"), [(0.0, 0), (0.2, 4)])
def test_a_wavy_border_is_told_under_grain_and_a_straight_one_is_not(wave_px, told):
    _, truth = simulate.edge(PLAIN, shape=(100, 60))
    row, col = np.mgrid[:100, :60].astype(float)
    s, t = truth.line.distances(row, col)
    profile = PLAIN.profile(6.0)
    wave = wave_px * np.sqrt(2) * np.sin(2 * np.pi * t / 33)
    image = 200 + 1000 * profile.esf(s - wave + profile.half_px)
    found = [
        check(ac.measure_edge(image + grained(image.shape, 1.0, 20.0, seed)), "straightness_px")
        for seed in range(4)
    ]
    assert sum(one.value > 0 for one in found) == told


def test_the_ground_of_grain_does_not_slope():
    clean, _ = simulate.edge(PLAIN, shape=(60, 60))
    found = [
        check(ac.measure_edge(clean + grained(clean.shape, 1.5, 20.0, seed)), "gradient").passed
        for seed in range(20)
    ]
    assert sum(found) >= 19


@pytest.mark.parametrize("target", ["edge", "pulse"])
def test_ringing_is_as_far_out_on_both_sides_of_a_target(target):
    simulated, measure = getattr(simulate, target), getattr(ac, f"measure_{target}")
    size = {"width_px": 8.0} if target == "pulse" else {}
    clean, _ = simulated(PLAIN, shape=(60, 60), **size)
    echo = 0.5 * (np.roll(clean, 6, axis=1) + np.roll(clean, -6, axis=1)) - clean
    image = (clean - 0.08 * echo)[:, 6:-6]
    image += 3.0 * np.random.default_rng(3).standard_normal(image.shape)
    assert check(measure(image), "mirrored_ground").value > 0.9


def test_ground_that_is_brighter_on_one_side_of_a_pulse_is_not_mirrored():
    clean, truth = simulate.pulse(PLAIN, shape=(60, 60), width_px=4.0)
    row, col = np.mgrid[:60, :60].astype(float)
    far = truth.line.normal_distance(row, col) / 8.0
    image = clean + 40.0 * (far > 1) - 40.0 * (far < -1)
    image += 3.0 * np.random.default_rng(3).standard_normal(image.shape)
    assert check(ac.measure_pulse(image), "mirrored_ground").value < 0.5


def test_a_bright_rim_of_a_sharpened_product_is_told_in_noise():
    profile = SHARPENED.profile(6.0)
    _, truth = simulate.edge(SHARPENED, shape=(30, 40))
    row, col = np.mgrid[:30, :40].astype(float)
    esf = profile.esf(truth.line.normal_distance(row, col) + profile.half_px)
    beyond = profile.esf(truth.line.normal_distance(row, col) - 2 + profile.half_px)
    told = {0.0: 0, 0.1: 0}
    for height in told:
        image = 200 + 1000 * (esf + height * (esf - beyond))
        for seed in range(25):
            noise = 40 * np.random.default_rng(seed).standard_normal(image.shape)
            name = "one_sided_overshoot"
            told[height] += not check(ac.measure_edge(image + noise), name).passed
    assert told[0.0] == 0
    assert told[0.1] >= 8


def test_a_profile_fitted_to_all_pixels_needs_no_upright_edge():
    image, _ = simulate.edge(
        PLAIN, shape=(80, 80), angle_deg=38.0, snr=100, rng=np.random.default_rng(1)
    )
    assert check(ac.measure_edge(image, method="fermi"), "angle_deg").passed
    assert not check(ac.measure_edge(image, method="iso12233"), "angle_deg").passed
