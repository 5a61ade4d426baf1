"""Kernels of least expected error: optimal under their length, timid where little is known."""

import numpy as np
import pytest

from acutance import optics
from acutance.optics import Sensor
from acutance.restoration.filtered_otf import SensorOtf, kernel_otf
from acutance.restoration.kernel_family import DESIRED, KernelFamily
from acutance.restoration.scene_spectrum import NaturalScene, StiffScene

SENSOR = SensorOtf(Sensor([optics.Gaussian(0.5), optics.Detector()]))
SCENE = NaturalScene(20.0)


class Doubtful:
    """The same sensor, its OTF known to a share of itself."""

    band_cpp = 4.0

    def __init__(self, share):
        self.share = share

    def otf(self, u, v):
        return SENSOR.otf(u, v)

    def factor(self, u, v):
        return (self.share * np.minimum(np.hypot(u, v) / 0.2, 1) * SENSOR.otf(u, v))[:, None]


def expected_error(kernel, scene=SCENE, weight=1.0, orders=(-1, 0, 1)):
    """E(h) by a sum over a fine grid of frequencies, written out."""
    grid = (np.arange(64) + 0.5) / 64 - 0.5
    u, v = (axis.ravel() for axis in np.meshgrid(grid, grid))
    gain = kernel_otf(kernel, u, v)
    total = weight * np.abs(gain) ** 2
    for i in orders:
        for j in orders:
            own = kernel_otf(kernel, u, v) * SENSOR.otf(u + i, v + j)
            total += scene.power(u + i, v + j) * np.abs(own - DESIRED["pixel"](u + i, v + j)) ** 2
    return total.mean()


@pytest.fixture(scope="module")
def family():
    return KernelFamily.of(SENSOR, SCENE, 9)


def test_no_other_kernel_of_the_size_has_a_smaller_expected_error(family):
    best = family.kernel(1.0)
    least = expected_error(best)
    rng = np.random.default_rng(1)
    for _ in range(20):
        move = rng.normal(size=best.shape)
        move -= move.mean()
        move *= 0.05 / np.linalg.norm(move)
        assert expected_error(best + move) > least
        assert expected_error(best - move) > least


def test_it_is_better_than_a_larger_one_cut_off(family):
    cut = KernelFamily.of(SENSOR, SCENE, 21).kernel(0.05)[6:-6, 6:-6]
    own = family.kernel(0.05)
    assert expected_error(own, weight=0.05) < expected_error(cut / cut.sum(), weight=0.05)


def test_a_larger_kernel_is_no_worse(family):
    errors = [
        expected_error(KernelFamily.of(SENSOR, SCENE, size).kernel(0.1), weight=0.1)
        for size in (3, 5, 9, 15)
    ]
    assert errors == sorted(errors, reverse=True)


def test_kernels_sum_to_one_and_their_noise_gain_falls_with_the_weight(family):
    gains = [family.noise_gain(weight) for weight in family.weights]
    assert gains == sorted(gains, reverse=True)
    assert gains[-1] == pytest.approx(1 / 9, rel=1e-3)
    kernel = family.kernel(0.3)
    assert kernel.sum() == pytest.approx(1, abs=1e-12)
    assert np.linalg.norm(kernel) == pytest.approx(family.noise_gain(0.3))
    assert family.noise_gain(family.weight_of_gain(1.7)) == pytest.approx(1.7)


def test_where_the_measurement_is_doubtful_the_kernel_is_timid(family):
    gains = [
        KernelFamily.of(Doubtful(share), SCENE, 9).noise_gain(0.1) for share in (0.0, 0.1, 0.3)
    ]
    assert gains[0] == pytest.approx(family.noise_gain(0.1))
    assert gains[0] > gains[1] > gains[2]


def test_noise_that_is_white_gains_what_was_predicted(family):
    from acutance.numerics.convolution import convolve_inside

    noise = np.random.default_rng(2).normal(size=(500, 500))
    kernel = family.kernel(family.weight_of_gain(2.0))
    assert convolve_inside(noise, kernel).std() / noise.std() == pytest.approx(2.0, rel=0.02)


def test_constrained_least_squares_is_the_wiener_kernel_of_a_stiff_scene():
    u = np.array([0.1, 0.3])
    nothing = np.zeros(2)
    expected = (4 - 2 * np.cos(2 * np.pi * u) - 2) ** -2.0
    assert StiffScene().power(u, nothing) == pytest.approx(expected, rel=1e-3)
    assert KernelFamily.of(SENSOR, StiffScene(), 9).kernel(1.0).sum() == pytest.approx(1)


def test_an_asymmetric_blur_is_made_symmetric():
    trail = optics.Detector()
    kernel = np.zeros((3, 3))
    kernel[1] = (0.0, 0.7, 0.3)
    sensor = SensorOtf(Sensor([optics.Gaussian(0.4), trail, optics.Sharpening(kernel)]))
    freq, nothing = np.array([0.25, 0.4]), np.zeros(2)
    restoring = KernelFamily.of(sensor, SCENE, 11).kernel(0.05)
    before = sensor.otf(freq, nothing)
    after = before * kernel_otf(restoring, freq, nothing)
    assert np.all(np.abs(np.angle(before)) > 0.01)
    assert np.all(np.abs(np.angle(after)) < 0.4 * np.abs(np.angle(before)))


def test_the_natural_scene_has_its_contrast():
    grid = (np.arange(2048) + 0.5) / 2048 - 0.5
    u, v = np.meshgrid(grid, grid)
    for exponent in (2.0, 3.0):
        power = NaturalScene(7.0, exponent).power(u, v)
        assert power.mean() == pytest.approx(49.0, rel=0.02)
        ratio = NaturalScene(7.0, exponent).power(np.array([0.2, 0.4]), np.zeros(2))
        assert ratio[0] / ratio[1] == pytest.approx(2**exponent, rel=1e-3)
