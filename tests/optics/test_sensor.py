"""Sensor and its profiles against closed forms and against direct integration."""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf, erfc

from acutance.curves.direction import unit_vector
from acutance.errors import ModelError
from acutance.optics import (
    Butterworth,
    Defocus,
    Detector,
    Diffraction,
    Exponential,
    Gaussian,
    Sensor,
    Sharpening,
    Smear,
    Turbulence,
)

GENERIC = Sensor([Gaussian(0.39), Detector(), Smear(0.25, "along"), Butterworth(1.4)], gsd_m=1.0)

# sigma: M(.25), M(.5), FWHM, slope 40-60, half extent 50-95 of a Gaussian and a unit pixel.
GAUSSIAN_AND_PIXEL = {
    0.2: (0.8570, 0.5226, 1.0062, 0.9836, 0.5690),
    0.3: (0.8057, 0.4083, 1.0716, 0.8968, 0.6822),
    0.4: (0.7390, 0.2891, 1.2084, 0.7810, 0.8108),
    0.5: (0.6614, 0.1854, 1.3857, 0.6757, 0.9497),
    0.6: (0.5774, 0.1077, 1.5837, 0.5891, 1.0954),
    0.7: (0.4919, 0.0567, 1.7933, 0.5194, 1.2457),
}


def normal_cdf(x):
    return 0.5 * (1 + erf(np.asarray(x) / math.sqrt(2)))


def gaussian_and_pixel_esf(s, sigma):
    def integrated(x):
        return x * normal_cdf(x / sigma) + sigma * np.exp(-0.5 * (x / sigma) ** 2) / math.sqrt(
            2 * math.pi
        )

    return integrated(s + 0.5) - integrated(s - 0.5)


@pytest.mark.parametrize("sigma", GAUSSIAN_AND_PIXEL)
def test_metrics_of_a_gaussian_and_a_pixel(sigma):
    r = Sensor([Gaussian(sigma), Detector()]).response()
    found = (r.mtf(0.25), r.mtf_nyquist, r.fwhm_px, r.edge_slope_per_px, r.half_extent_bright_px)
    expected = GAUSSIAN_AND_PIXEL[sigma]
    # Half a unit of the last printed digit, and a little for halves rounded either way.
    assert [n.value for n in found] == pytest.approx(expected, abs=0.6e-4)
    rer = 2 * gaussian_and_pixel_esf(0.5, sigma) - 1
    assert r.rer.value == pytest.approx(rer, abs=1e-7)
    assert r.rer.std == 0


def test_metrics_of_a_pure_gaussian():
    r = Sensor([Gaussian(0.5)]).response()
    assert r.rer.value == pytest.approx(math.erf(1 / (2 * math.sqrt(2) * 0.5)), abs=1e-7)
    assert r.fwhm_px.value == pytest.approx(2 * math.sqrt(2 * math.log(2)) * 0.5, abs=1e-5)


@pytest.mark.parametrize("sigma", [0.2, 0.4, 0.7, 7.0])
def test_esf_is_exact_at_any_distance(sigma):
    s = np.random.default_rng(1).uniform(-40, 40, 5000)
    profile = Sensor([Gaussian(sigma), Detector()]).profile(0.0)
    np.testing.assert_allclose(profile.esf(s), gaussian_and_pixel_esf(s, sigma), atol=1e-7)
    lsf = normal_cdf((s + 0.5) / sigma) - normal_cdf((s - 0.5) / sigma)
    np.testing.assert_allclose(profile.lsf(s), lsf, atol=1e-7)


def test_generic_sensor_model():
    """SDSU 2005: 0.39 m optics, 1 m detector, 0.25 m of motion along track, electronics."""
    assert GENERIC.response(0, "across").mtf_nyquist.value == pytest.approx(0.2665, abs=5e-5)
    assert GENERIC.response(0, "along").mtf_nyquist.value == pytest.approx(0.2597, abs=5e-5)
    fwhm = [GENERIC.response(0, axis).fwhm_m.value for axis in ("across", "along")]
    assert fwhm == pytest.approx([1.240, 1.251], abs=5e-4)


@functools.cache
def real_otf(sensor, normal_deg, freq_cpp):
    """Kept, as quadratures for different distances have most frequencies in common."""
    x, y = unit_vector(normal_deg)
    return float(np.real(sensor.otf(freq_cpp * x, freq_cpp * y)))


def direct_esf(sensor, s, normal_deg, cutoff):
    """ESF as an integral over frequency, by adaptive quadrature with the oscillating weight."""

    def even(f):
        return real_otf(sensor, normal_deg, f) / (math.pi * f)

    def rest(f):
        return even(f) - math.exp(-f) / (math.pi * f)

    # integral_0^inf exp(-f) sin(w f) / f df = arctan(w); what is left is smooth at zero.
    w = 2 * math.pi * s
    whole = quad(rest, 1e-9, cutoff, weight="sin", wvar=w, limit=400, epsabs=1e-11)[0]
    beyond = quad(
        lambda f: -math.exp(-f) / (math.pi * f),
        cutoff,
        40,
        weight="sin",
        wvar=w,
        limit=400,
        epsabs=1e-11,
    )[0]
    return 0.5 + math.atan(w) / math.pi + whole + beyond


@pytest.mark.parametrize("distance", [-300.0, -149.9, -20.0, -0.7, 0.3, 5.0, 80.0, 700.0])
@pytest.mark.parametrize(
    ("blocks", "cutoff"),
    [
        ([Diffraction(1.2), Detector()], 1.2),
        ([Diffraction(1.4, 0.3), Detector()], 1.4),
        ([Defocus(0.9, 1.2)], 1.2),
    ],
)
def test_tails_of_an_aperture_are_exact(blocks, cutoff, distance):
    sensor = Sensor(blocks)
    expected = direct_esf(sensor, distance, 6.0, cutoff)
    assert sensor.profile(6.0).esf(distance) == pytest.approx(expected, abs=1e-7)


def test_tail_of_an_aperture_falls_like_one_over_distance():
    sensor = Sensor([Diffraction(1.2)])
    # Slope of the OTF at zero is -4 / (pi cutoff); LSF tail slope / (2 pi^2 s^2).
    expected = 4 / (math.pi * 1.2) / (2 * math.pi**2)
    assert 400 * (1 - sensor.profile(0.0).esf(400.0)) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("normal_deg", [0.0, 180.0])
def test_trail_is_on_the_side_it_points_to(normal_deg):
    length, sigma = 0.5, 0.4
    sensor = Sensor([Gaussian(sigma), Exponential(length, "across")])
    side = 1.0 if normal_deg == 0 else -1.0
    s = np.linspace(-4, 6, 200)
    # Exponentially modified Gaussian.
    argument = (sigma / length - s / sigma) / math.sqrt(2)
    lsf = np.exp(sigma**2 / (2 * length**2) - s / length) * erfc(argument) / (2 * length)
    np.testing.assert_allclose(sensor.profile(normal_deg).lsf(side * s), lsf, atol=1e-7)


def test_polarity_conjugates_the_otf():
    sensor = Sensor([Gaussian(0.3), Exponential(0.4), Detector()])
    towards, away = sensor.response_along(6.0).mtf.otf, sensor.response_along(186.0).mtf.otf
    np.testing.assert_allclose(away, np.conj(towards), atol=1e-12)
    assert np.max(np.abs(towards.imag)) > 0.02


def test_phase_is_relative_to_the_centroid():
    response = Sensor([Gaussian(0.3), Exponential(0.4), Detector()]).response(6.0)
    # Without the centroid's phase it would be -2 pi f * 0.4 cos 6.
    assert abs(response.mtf.phase_rad[1]) < 1e-4
    lsf, x = response.lsf.value, response.lsf.distance_px
    centroid = np.sum(x * lsf) / np.sum(lsf)
    transform = np.exp(-2j * np.pi * np.outer(response.mtf.freq_cpp, x - centroid)) @ lsf * 0.05
    np.testing.assert_allclose(response.mtf.otf, transform, atol=1e-6)


@pytest.mark.parametrize("angle", [0.0, 6.0, -14.0, 45.0])
@pytest.mark.parametrize("orientation", ["across", "along"])
def test_curves_share_their_conventions(angle, orientation):
    sensor = Sensor([Diffraction(1.2, 0.3), Exponential(0.3, "along"), Detector()], gsd_m=0.7)
    r = sensor.response(angle, orientation)
    assert r.esf(0.0).value == pytest.approx(0.5, abs=1e-9)
    assert (r.mtf.freq_cpp.size, r.mtf.freq_cpp[-1]) == (101, 1.0)
    assert r.esf.distance_px[[0, -1]].tolist() == [-16.0, 16.0]
    slope = np.gradient(r.esf.value, 0.05)
    np.testing.assert_allclose(slope[1:-1], r.lsf.value[1:-1], atol=2e-3)
    assert r.fwhm_m.value == pytest.approx(0.7 * r.fwhm_px.value)
    assert sensor.mtf(angle, orientation)(0.3).value == r.mtf(0.3).value
    assert sensor.esf(angle, orientation)(0.3).value == r.esf(0.3).value
    assert sensor.lsf(angle, orientation)(0.3).value == r.lsf(0.3).value


def test_a_slanted_edge_sees_the_slice_of_the_two_dimensional_otf():
    pixel = Sensor([Gaussian(0.4), Detector()])
    gain = pixel.response(14.0).mtf_nyquist.value / pixel.response(0.0).mtf_nyquist.value - 1
    assert gain == pytest.approx(0.0049, abs=5e-5)


def test_bare_detector_is_good_to_the_documented_error():
    s = np.linspace(-3, 3, 1237)
    straight = Sensor([Detector()]).profile(0.0)
    ramp = np.clip(s + 0.5, 0, 1)
    error = np.abs(straight.esf(s) - ramp)
    assert error.max() < 1e-4
    assert error[np.abs(np.abs(s) - 0.5) > 0.01].max() < 1e-6


def test_turbulence_tails_do_not_wrap_round():
    sensor = Sensor([Turbulence(2.0)])
    assert sensor.profile(0.0).esf(0.0) == pytest.approx(0.5, abs=1e-9)
    for distance in (1.0, 30.0, 140.0):
        expected = direct_esf(sensor, distance, 0.0, 12.0)
        assert sensor.profile(0.0).esf(distance) == pytest.approx(expected, abs=1e-6)


def test_psf_is_the_point_response():
    x, psf = Sensor([Gaussian(0.5, 0.8)]).psf(half_width_px=5.0, step_px=0.1)
    assert psf.shape == (101, 101)
    expected = np.exp(-0.5 * (x[None, :] / 0.5) ** 2 - 0.5 * (x[:, None] / 0.8) ** 2)
    np.testing.assert_allclose(psf, expected / (2 * math.pi * 0.4), atol=1e-10)


def test_profiles_are_kept():
    first = Sensor([Gaussian(0.41), Detector()]).profile(6.0)
    assert Sensor((Gaussian(0.41), Detector())).profile(6) is first


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Sensor([]), "at least one block"),
        (lambda: Sensor([Detector()], gsd_m=0.0), "gsd_m is 0"),
        (lambda: Sensor([Sharpening.both_axes(0.2)]).response(), "add the blur"),
        (lambda: Sensor([Detector()]).response(6.0, "vertical"), "'vertical'"),
        (lambda: Sensor([Detector()]).response(math.inf), "angle_deg is inf: give a finite"),
        (lambda: Sensor([Detector()]).mtf("x"), "angle_deg is 'x': give a finite number"),
        (lambda: Sensor([Detector()]).esf(None), "angle_deg is None: give a finite number"),
        (lambda: Sensor([Detector()]).lsf(angle_deg=[6.0]), r"angle_deg is \[6.0\]: give"),
        (lambda: Sensor([Detector()]).response_along("x"), "normal_deg is 'x': give a finite"),
        (lambda: Sensor([Detector()]).profile(math.nan), "normal_deg is nan: give a finite"),
        (lambda: Sensor([Detector()]).psf(step_px=0.7), "step of|steps of 0.7"),
    ],
)
def test_contradictions_are_refused(build, words):
    with pytest.raises(ModelError, match=words):
        build()
