"""A pulse on ground that slopes as a whole: the same numbers and intervals as on level ground."""

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.curves import Estimate
from acutance.optics import Detector, Gaussian, Halo, Sensor

PLAIN = Sensor([Gaussian(0.36), Detector()])
HALO = Sensor([Gaussian(0.36), Detector(), Halo(0.08, 1.5)])


def pulse(sensor, seed, slope, width_px=3.0):
    """On ground that rises by a share of the contrast from pixel to pixel along the normal."""
    image, truth = simulate.pulse(
        sensor, angle_deg=6, width_px=width_px, shape=(52, 52), dark=200, bright=1200, snr=100,
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    rows, cols = np.indices(image.shape)
    line = ac.measure_pulse(image).line
    away = line.normal_distance(rows, cols)
    return image, image + 1000 * slope * away, truth


@pytest.mark.parametrize("sensor", [PLAIN, HALO], ids=["plain", "halo"])
@pytest.mark.parametrize("slope", [0.001, 0.003])
def test_a_slope_changes_neither_numbers_nor_deviations(sensor, slope):
    for seed in range(3):
        level, sloped, _ = pulse(sensor, seed, slope)
        usual, found = ac.measure_pulse(level), ac.measure_pulse(sloped)
        for name in ("mtf_nyquist", "rer", "fwhm_px", "width_px"):
            one, other = getattr(usual, name), getattr(found, name)
            assert abs(other.value - one.value) < 0.35 * one.std, name
            assert other.std == pytest.approx(one.std, rel=0.15), name


def test_intervals_hold_on_sloping_ground():
    """RMS of errors over deviations 1.0 to 1.2; with noise taken from what the first fit leaves,
    2.0 of MTF at Nyquist and FWHM."""
    z = []
    for seed in range(16):
        _, sloped, truth = pulse(PLAIN, 100 + seed, 0.003, width_px=5.0)
        found = ac.measure_pulse(sloped)
        z.append([
            (getattr(found, name).value - getattr(truth, name).value) / getattr(found, name).std
            for name in ("mtf_nyquist", "rer", "fwhm_px")
        ])  # fmt: skip
    assert np.all(np.sqrt(np.mean(np.square(z), axis=0)) < 1.4)


def test_numbers_of_a_pulse_in_metres():
    image, _, _ = pulse(PLAIN, 1, 0.0)
    found = ac.measure_pulse(image, gsd_m=2.0)
    assert found.width_m.value == pytest.approx(2 * found.width_px.value)
    assert found.prf_fwhm_m.std == pytest.approx(2 * found.prf_fwhm_px.std)
    document = found.to_dict()
    for name in ("width_m", "prf_fwhm_m"):
        assert Estimate(**{k: document[name][k] for k in ("value", "std")}).value == pytest.approx(
            getattr(found, name).value, rel=1e-4
        )
    bare = ac.measure_pulse(image)
    assert bare.width_m is None
    assert bare.prf_fwhm_m is None
