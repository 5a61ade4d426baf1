"""The Cramér-Rao bounds against closed forms and against fits of simulated images."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from acutance import optics, simulate
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.studies import Design, equivalent_blur, free_bound, shape_bound
from acutance.studies.bound import _numbers

SENSOR = optics.Sensor([optics.Gaussian(0.45), optics.Detector()])
EDGE = Design("edge", 40, 6.0)
PULSE = Design("pulse", 40, 6.0, 3.0)


def test_the_known_values_of_40_rows_at_snr_100():
    assert free_bound(GaussianPixel(0.45), EDGE, 100.0) == pytest.approx(0.0111, abs=5e-5)
    assert shape_bound(GaussianPixel(0.4), EDGE, 100.0).mtf_nyquist == pytest.approx(
        0.0045, abs=3e-4
    )


def test_a_pulse_of_three_pixels_needs_half_the_snr_of_an_edge():
    blur = GaussianPixel(0.45)
    # The fitted width costs a pulse of three pixels next to nothing at Nyquist.
    assert free_bound(blur, PULSE, 50.0) == pytest.approx(free_bound(blur, EDGE, 100.0), rel=0.01)
    assert free_bound(blur, replace(PULSE, width_px=2.0), 100.0) == math.inf


def test_a_fitted_width_costs_where_the_ratio_depends_on_it():
    blur, narrow = GaussianPixel(0.45), replace(PULSE, width_px=1.5)
    free, shape = free_bound(blur, narrow, 50.0), shape_bound(blur, narrow, 50.0)
    by_noise = math.pi * 0.5 / math.sin(0.75 * math.pi) * math.sqrt(10 / 2 / 40.22) / 50
    by_width = blur.otf(np.array([0.5]))[0] * (0.5 * math.pi / math.tan(0.75 * math.pi) - 1 / 1.5)
    assert free == pytest.approx(math.hypot(by_noise, by_width * shape.width_px), rel=1e-3)


@pytest.mark.parametrize("sigma", [0.2, 0.45, 0.9])
@pytest.mark.parametrize("rows", [20, 80])
@pytest.mark.parametrize("width", [math.nan, 0.6, 1.0, 1.5, 2.5, 3.0, 5.0])
def test_a_free_lsf_is_known_no_better_than_one_of_known_shape(sigma, rows, width):
    design = Design("edge" if math.isnan(width) else "pulse", rows, 6.0, width)
    blur = GaussianPixel(sigma)
    assert free_bound(blur, design, 70.0) >= shape_bound(blur, design, 70.0).mtf_nyquist


def test_many_rows_are_the_sum_of_few(monkeypatch):
    whole = shape_bound(GaussianPixel(0.4), PULSE, 50.0)
    monkeypatch.setattr("acutance.studies.bound._PIXELS_AT_ONCE", 130)
    parts = shape_bound(GaussianPixel(0.4), PULSE, 50.0)
    assert vars(parts) == pytest.approx(vars(whole), rel=1e-9)


def test_bounds_scale_with_noise_and_rows():
    one, four = (
        shape_bound(GaussianPixel(0.4), EDGE, 100.0),
        shape_bound(GaussianPixel(0.4), EDGE, 25.0),
    )
    assert four.rer == pytest.approx(4 * one.rer)
    more = shape_bound(GaussianPixel(0.4), replace(EDGE, rows=160, cols=60), 100.0)
    assert more.fwhm_px == pytest.approx(one.fwhm_px / 2, rel=0.03)


def test_the_equivalent_blur_is_the_sensors_own():
    assert equivalent_blur(SENSOR, 0.0).sigma_px == pytest.approx(0.45, abs=1e-3)


def test_a_fit_of_the_bounds_own_model_reaches_them():
    """The plain pulse fitted to 400 images: its scatter is the bound of sigma and width."""
    rng = np.random.default_rng(8)
    bound = shape_bound(GaussianPixel(0.45), PULSE, 50.0)
    sigma, width = [], []
    clean, truth = simulate.pulse(SENSOR, shape=(40, 40), dark=0.0, bright=1.0)
    line = truth.line.moved(-1.5, 0.0)
    rows, cols = (places.ravel().astype(float) for places in np.indices(clean.shape))
    s, t = line.normal_distance(rows, cols), line.tangent_distance(rows, cols)

    def pulse(p):
        dark, height, offset, turn, sigma, width, fall = p
        blur, distance = GaussianPixel(sigma), s - offset + turn * t
        return dark + height * (blur.esf(distance) - fall * blur.esf(distance - width))

    start = np.array([0.0, 1.0, 0.0, 0.0, 0.45, 3.0, 1.0])
    for _ in range(400):
        value = clean.ravel() + rng.normal(scale=1 / 50, size=clean.size)
        found = least_squares(lambda p, value=value: pulse(p) - value, start, method="lm").x
        sigma.append(found[4])
        width.append(found[5])
    slope = (_numbers(GaussianPixel(0.4501)) - _numbers(GaussianPixel(0.4499)))[0] / 0.0002
    # The slice of the pixel at 6 degrees is no plain box, and 400 draws know a std to 3.5 %.
    assert abs(slope) * np.std(sigma) == pytest.approx(bound.mtf_nyquist, rel=0.12)
    assert np.std(width) == pytest.approx(bound.width_px, rel=0.12)
