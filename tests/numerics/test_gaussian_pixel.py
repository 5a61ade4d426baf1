"""The plain blur: closed forms, and every derivative against a numerical one."""

import math

import numpy as np
import pytest

from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, GaussianPixel

S = np.linspace(-6, 6, 241)
BLURS = [GaussianPixel(0.4), GaussianPixel(0.9, 0.3), GaussianPixel(0.35, 2.5)]
STEP = 1e-5


@pytest.mark.parametrize("blur", BLURS)
def test_esf_rises_from_zero_to_one_through_a_half(blur):
    ends = blur.esf(np.array([-30.0, 0.0, 30.0]))
    assert ends == pytest.approx([0.0, 0.5, 1.0], abs=1e-12)


def test_narrow_aperture_is_the_gaussian():
    blur = GaussianPixel(0.7, 1e-3)
    expected = np.exp(-0.5 * (S / 0.7) ** 2) / (0.7 * math.sqrt(2 * math.pi))
    assert np.max(np.abs(blur.lsf(S) - expected)) < 1e-6


def test_narrow_gaussian_is_the_box():
    assert GaussianPixel(0.01, 2.0).lsf(np.array([-1.1, 0.0, 0.9])) == pytest.approx([0, 0.5, 0.5])


@pytest.mark.parametrize("blur", BLURS)
def test_lsf_is_the_slope_of_the_esf(blur):
    slope = (blur.esf(S + STEP) - blur.esf(S - STEP)) / (2 * STEP)
    assert np.max(np.abs(slope - blur.lsf(S))) < 1e-8


@pytest.mark.parametrize("blur", BLURS)
def test_both_curves_at_once_are_the_curves(blur):
    esf, lsf = blur.esf_and_lsf(S)
    assert np.array_equal(esf, blur.esf(S))
    assert np.array_equal(lsf, blur.lsf(S))


def numerical_slopes(curve, blur):
    """Derivatives of a curve by sigma and by aperture."""
    sigma, aperture = blur.sigma_px, blur.aperture_px
    by_sigma = curve(GaussianPixel(sigma + STEP, aperture)) - curve(
        GaussianPixel(sigma - STEP, aperture)
    )
    by_aperture = curve(GaussianPixel(sigma, aperture + STEP)) - curve(
        GaussianPixel(sigma, aperture - STEP)
    )
    return by_sigma / (2 * STEP), by_aperture / (2 * STEP)


@pytest.mark.parametrize("blur", BLURS)
def test_slopes_of_the_esf(blur):
    esf, lsf, by_sigma, by_aperture = blur.esf_and_slopes(S)
    sigma, aperture = numerical_slopes(lambda b: b.esf(S), blur)
    assert np.max(np.abs(esf - blur.esf(S))) < 1e-14
    assert np.max(np.abs(lsf - blur.lsf(S))) < 1e-14
    assert np.max(np.abs(by_sigma - sigma)) < 1e-7
    assert np.max(np.abs(by_aperture - aperture)) < 1e-7


@pytest.mark.parametrize("blur", BLURS)
def test_slopes_of_the_lsf(blur):
    lsf, by_place, by_sigma, by_aperture = blur.lsf_slopes(S)
    sigma, aperture = numerical_slopes(lambda b: b.lsf(S), blur)
    assert np.max(np.abs(lsf - blur.lsf(S))) < 1e-14
    place = (blur.lsf(S + STEP) - blur.lsf(S - STEP)) / (2 * STEP)
    assert np.max(np.abs(by_place - place)) < 1e-7
    assert np.max(np.abs(by_sigma - sigma)) < 1e-7
    assert np.max(np.abs(by_aperture - aperture)) < 1e-7


@pytest.mark.parametrize("blur", BLURS)
def test_otf_is_the_fourier_transform_of_the_lsf(blur):
    grid = (np.arange(8000) + 0.5) * 0.0025 - 10
    freq = np.arange(0, 1.01, 0.05)
    numerical = np.cos(2 * np.pi * np.outer(freq, grid)) @ blur.lsf(grid) * 0.0025
    assert np.max(np.abs(blur.otf(freq) - numerical)) < 1e-6


@pytest.mark.parametrize("blur", BLURS)
def test_width_is_that_of_the_gaussian_with_the_same_variance(blur):
    grid = (np.arange(8000) + 0.5) * 0.0025 - 10
    variance = np.sum(grid**2 * blur.lsf(grid)) * 0.0025
    assert blur.width_px == pytest.approx(FWHM_OF_SIGMA * math.sqrt(variance), rel=1e-5)
