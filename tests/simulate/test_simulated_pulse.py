"""Simulated pulses: exact pixels, two plateaus, ends, and the truth."""

import math

import numpy as np
import pytest
from scipy.special import erf

from acutance.errors import ModelError
from acutance.optics import Detector, Exponential, Gaussian, Sensor
from acutance.simulate import Noise, Regrid, edge, pulse, reference_systems, render_pulse

SENSOR = Sensor([Gaussian(0.4), Detector()], gsd_m=2.8)
SKEWED = Sensor([Gaussian(0.3), Exponential(0.4, "across"), Exponential(0.2, "along"), Detector()])


def pixel_integrals(line, shape, width, sigma, length=math.inf):
    """A rectangle blurred by a Gaussian and integrated over every pixel by 2-D quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    rows, cols = np.indices(shape)
    total = np.zeros(shape)

    def blurred(s, size):
        if math.isinf(size):
            return 1.0
        scale = sigma * math.sqrt(2)
        return 0.5 * (erf((s + size / 2) / scale) - erf((s - size / 2) / scale))

    for y, wy in zip(nodes / 2, weights / 2, strict=True):
        for x, wx in zip(nodes / 2, weights / 2, strict=True):
            s = line.normal_distance(rows + y, cols + x)
            t = line.tangent_distance(rows + y, cols + x)
            total += wy * wx * blurred(s, width) * blurred(t, length)
    return total


@pytest.mark.parametrize("orientation", ["across", "along"])
@pytest.mark.parametrize("angle", [6.0, -14.0])
@pytest.mark.parametrize("width", [2.6, 3.68])
def test_pixels_are_integrals_of_the_blurred_strip(orientation, angle, width):
    image, truth = pulse(
        SENSOR, width_px=width, angle_deg=angle, orientation=orientation, offset_px=0.3
    )
    expected = pixel_integrals(truth.line, (60, 40), width, 0.4)
    np.testing.assert_allclose((image - 100) / 1100, expected, atol=2e-7)
    assert truth.orientation == orientation
    assert truth.line.normal_distance(29.5, 19.5) == pytest.approx(-0.3)
    assert truth.width_m == pytest.approx(2.8 * width)


def test_a_tarp_with_ends_is_as_exact():
    image, truth = pulse(SENSOR, length_px=25.0, offset_px=-0.4)
    expected = pixel_integrals(truth.line, (60, 40), 3.0, 0.4, 25.0)
    np.testing.assert_allclose((image - 100) / 1100, expected, atol=2e-6)


@pytest.mark.parametrize("orientation", ["across", "along"])
def test_two_grounds_are_two_edges(orientation):
    image, truth = pulse(SKEWED, orientation=orientation, dark=100.0, right_dark=300.0)
    rise, _ = edge(SKEWED, orientation=orientation, dark=0.0, bright=1.0, offset_px=-1.5)
    fall, _ = edge(SKEWED, orientation=orientation, dark=0.0, bright=1.0, offset_px=1.5)
    np.testing.assert_allclose(image, 100 + 1100 * rise - 900 * fall, atol=1e-9)
    assert (truth.left, truth.level, truth.right) == (100.0, 1200.0, 300.0)


def test_ends_far_away_change_nothing():
    line = pulse(SKEWED)[1].line
    levels = {"width_px": 3.0, "left": 100.0, "level": 1200.0, "right": 300.0}
    endless = render_pulse(SKEWED, line, (60, 40), **levels)
    long = render_pulse(SKEWED, line, (60, 40), length_px=100.0, **levels)
    np.testing.assert_allclose(long, endless, atol=2e-3)


def test_truth_is_that_of_the_sensor():
    image, truth = pulse(SENSOR, angle_deg=14.0)
    expected = SENSOR.response(14.0)
    assert truth.mtf_nyquist == expected.mtf_nyquist
    assert (truth.rer, truth.fwhm_px) == (expected.rer, expected.fwhm_px)
    distance = truth.line.normal_distance(*np.indices(image.shape))
    np.testing.assert_allclose(image, 100 + 1100 * truth.prf(distance), atol=1e-9)


@pytest.mark.parametrize("name", ["gaussian", "asymmetric"])
def test_the_pulse_response_integrates_to_the_width(name):
    _, truth = pulse(reference_systems()[name], width_px=3.3)
    distance = np.arange(-60, 60, 0.01)
    assert np.sum(truth.prf(distance)) * 0.01 == pytest.approx(3.3, abs=1e-5)
    half = 0.5 * truth.prf(np.arange(-4, 4, 0.001)).max()
    above = distance[truth.prf(distance) > half]
    assert truth.prf_fwhm_px == pytest.approx(np.ptp(above), abs=0.02)


def test_a_wide_pulse_is_as_wide_as_it_is():
    """Blur moves both edges' 50 % points by nothing, once the edges do not touch."""
    _, truth = pulse(SENSOR, width_px=9.0)
    assert truth.prf_fwhm_px == pytest.approx(9.0, abs=1e-6)


def test_a_regridded_pulse_is_that_of_the_whole_system():
    regrid = Regrid(shift_row_px=-0.3, shift_col_px=0.37)
    image, truth = pulse(SKEWED, regrid=regrid, right_dark=200.0)
    expected, _ = pulse(regrid.system(SKEWED), right_dark=200.0)
    np.testing.assert_allclose(image, expected, atol=2e-4)
    assert truth.mtf_nyquist.value < SKEWED.response(6.0).mtf_nyquist.value


def test_noise_is_that_asked_for():
    image, truth = pulse(SENSOR, snr=50, shape=(200, 200), rng=np.random.default_rng(2))
    clean, _ = pulse(SENSOR, shape=(200, 200))
    assert truth.noise == Noise(read=22.0)
    assert np.std(image - clean) == pytest.approx(22.0, rel=0.02)


def test_a_dark_pulse_may_lie_on_bright_ground():
    image, _ = pulse(SENSOR, dark=900.0, bright=100.0)
    inverse, _ = pulse(SENSOR, dark=100.0, bright=900.0)
    np.testing.assert_allclose(image, 1000 - inverse, atol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"width_px": 0.0}, "width_px is 0"),
        ({"length_px": -1.0}, "length_px is -1"),
        ({"angle_deg": 50.0}, "other orientation"),
        ({"right_dark": 1300.0}, "above both or below both"),
        ({"snr": 50.0}, "without rng"),
    ],
)
def test_contradictions_are_refused(arguments, words):
    with pytest.raises(ModelError, match=words):
        pulse(SENSOR, **arguments)
