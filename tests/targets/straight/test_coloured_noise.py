"""Noise that correlates: its spectrum, and edges on textured ground."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import acutance as ac
from acutance.curves.grid import Floats
from acutance.numerics.noise_spectrum import NoiseSpectrum, lag_waves
from acutance.simulate import LandscapeOptions, landscape
from acutance.targets.straight.coloured_noise import ColouredNoise

SIZE = 80
ROWS, COLS = (one.ravel() for one in np.indices((SIZE, SIZE)))
PLAIN = {
    "soft": 0.0, "curved": 0.0, "rims": 0.0, "gutters": 0.0, "shadows": 0.0, "side_roads": 0.0,
    "neighbours": 0.0, "roads": 0.0, "discs": 0.0,
}  # fmt: skip


def grains(seed: int, grain_px: float = 1.5) -> Floats:
    """Texture of unit variance."""
    noise = np.random.default_rng(seed).standard_normal((SIZE, SIZE))
    return gaussian_filter(noise, grain_px, mode="wrap") * 2 * np.sqrt(np.pi) * grain_px


def test_white_noise_has_the_same_power_everywhere():
    noise = np.random.default_rng(3).standard_normal(SIZE**2)
    freq_cpp = np.linspace(0.0, 1.0, 41)
    power = NoiseSpectrum.of(noise, ROWS, COLS).along(lag_waves((0.8, 0.6), freq_cpp))
    assert power == pytest.approx(1.0, abs=0.25)
    assert np.mean(power) == pytest.approx(1.0, abs=0.05)


def test_the_power_of_grains_is_that_of_their_filter():
    freq_cpp = np.array([0.0, 0.1, 0.5])
    true = 4 * np.pi * 1.5**2 * np.exp(-((2 * np.pi * 1.5 * freq_cpp) ** 2))
    found = np.mean(
        [
            NoiseSpectrum.of(grains(seed).ravel(), ROWS, COLS).along(
                lag_waves((0.6, 0.8), freq_cpp)
            )
            for seed in range(20)
        ],
        axis=0,
    )
    # The window over the lags smears a power that falls so steeply.
    assert 0.5 * true[0] < found[0] < 0.8 * true[0]
    assert found[1] == pytest.approx(true[1], rel=0.2)
    assert found[2] < 0.02 * found[0]


def test_pixels_are_a_lattice_whose_power_comes_again():
    spectrum = NoiseSpectrum.of(grains(4).ravel(), ROWS, COLS)
    near, again = spectrum.along(lag_waves((1.0, 0.0), np.array([0.1, 0.9])))
    assert again == pytest.approx(near, rel=1e-6)


def test_few_pixels_of_any_shape_have_no_negative_power():
    rng = np.random.default_rng(5)
    some = rng.permutation(SIZE**2)[:60]
    spectrum = NoiseSpectrum.of(grains(6).ravel()[some], ROWS[some], COLS[some])
    assert np.all(spectrum.along(lag_waves((1.0, 0.0), np.linspace(0.0, 2.0, 101))) > 0)
    assert np.all(spectrum.plane((96, 96)) > 0)


def noise_of(field: Floats) -> ColouredNoise:
    """Of a field beside an edge along its middle column."""
    response = (COLS >= SIZE // 2).astype(float)
    return ColouredNoise.of(field.ravel(), (ROWS, COLS), response, (1.0, 0.0))


def test_smooth_regressors_are_disturbed_more_than_rough_ones():
    noise = noise_of(grains(7) + 0.3 * np.random.default_rng(8).standard_normal((SIZE, SIZE)))
    waves = np.cos(2 * np.pi * np.array([[0.02], [0.45]]) * COLS)
    smooth, rough = noise.disturbing(waves, np.ones(2))
    assert smooth > 10.0
    assert rough < 0.3


def test_a_border_that_is_rougher_than_the_ground_is_told():
    field = grains(9) + 0.3 * np.random.default_rng(10).standard_normal((SIZE, SIZE))
    field /= field.std()
    s, t = COLS - 0.5 * SIZE, ROWS - 0.5 * SIZE
    assert not noise_of(field).scatter_along(field.ravel(), [s], t, 1.5).is_more
    wiggle = gaussian_filter(np.random.default_rng(11).standard_normal(SIZE), 2.0) * 5.0
    rough = field.ravel() + wiggle[ROWS] * np.exp(-(s**2))
    assert noise_of(field).scatter_along(rough, [s], t, 1.5).is_more


@cache
def standard_errors(system: str) -> tuple[Floats, Floats, Floats]:
    """Errors in deviations at Nyquist and of RER, and deviations at Nyquist, of textured edges."""
    sensor = ac.simulate.reference_systems()[system]
    found = []
    for seed in (1, 2):
        image, truth = landscape(
            sensor, shape=(420, 420), rng=np.random.default_rng(seed), snr=100.0,
            options=LandscapeOptions(density_per_mpx=200.0, clear_px=12.0, **PLAIN),
        )  # fmt: skip
        for edge in truth.edges:
            if abs((edge.line.normal_deg + 22.5) % 45 - 22.5) < 2.0:
                continue
            m, true = ac.measure_edge(image, ac.Region(edge.region(14.0))), edge.response
            found.append((
                (m.mtf_nyquist.value - true.mtf_nyquist.value) / m.mtf_nyquist.std,
                (m.rer.value - true.rer.value) / m.rer.std,
                m.mtf_nyquist.std,
            ))  # fmt: skip
    at_nyquist, of_rer, std = np.array(found).T
    return at_nyquist, of_rer, std


SYSTEMS = ("gaussian", "diffraction", "halo")


@pytest.mark.parametrize("system", SYSTEMS)
def test_intervals_on_textured_ground_are_true(system: str):
    at_nyquist, of_rer, _ = standard_errors(system)
    assert at_nyquist.size > 50
    for errors in (at_nyquist, of_rer):
        assert np.mean(np.abs(errors) < 1.96) > 0.87
        assert np.sqrt(np.mean(errors**2)) < 1.3


def test_intervals_on_textured_ground_are_not_twice_too_wide():
    at_nyquist, of_rer, _ = map(np.concatenate, zip(*map(standard_errors, SYSTEMS), strict=True))
    for errors in (at_nyquist, of_rer):
        assert np.sqrt(np.mean(errors**2)) > 0.5


def test_texture_hardly_disturbs_high_frequencies():
    """Taken for white noise of all its power, these edges had deviations of .05."""
    *_, std = standard_errors("gaussian")
    assert np.median(std) < 0.025


@cache
def pulse_errors() -> tuple[Floats, Floats]:
    """Errors and deviations at Nyquist, of RER and FWHM of clean tarps on ground of 3 % texture."""
    systems, found = ac.simulate.reference_systems(), []
    for number in range(80):
        rng = np.random.default_rng([12, number])
        sensor = list(systems.values())[number % len(systems)]
        width_px = float(rng.uniform(2.6, 6.0))
        image, truth = ac.simulate.pulse(
            sensor, width_px=width_px, angle_deg=float(rng.uniform(3.0, 14.0)), shape=(60, 50),
            dark=100.0, bright=1200.0, snr=200.0, offset_px=float(rng.uniform(-1.0, 1.0)), rng=rng,
        )  # fmt: skip
        ground = 1 - np.clip((image - 100.0) / 1100.0, 0.0, 1.0)
        image += ground * ac.simulate.texture(sensor, image.shape, 33.0, 1.5, rng)
        m = ac.measure_pulse(image, width_px=width_px)
        found.append([
            (one.value - true.value, one.std)
            for one, true in (
                (m.mtf_nyquist, truth.mtf_nyquist), (m.rer, truth.rer), (m.fwhm_px, truth.fwhm_px)
            )
        ])  # fmt: skip
    error, std = np.moveaxis(np.array(found), -1, 0)
    return error, std


def test_intervals_of_tarps_on_textured_ground_hold():
    error, std = pulse_errors()
    assert np.all(np.mean(np.abs(error) < 1.96 * std, axis=0) > 0.93)


def test_tarps_on_textured_ground_are_hardly_less_exact():
    """Taken for white noise of all its power: deviations of .017, .017 and .053."""
    error, std = pulse_errors()
    assert np.all(np.median(std, axis=0) < [0.011, 0.017, 0.035])
    assert np.all(np.sqrt(np.mean(error**2, axis=0)) < [0.009, 0.016, 0.03])
