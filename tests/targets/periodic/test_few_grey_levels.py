"""Bars in few grey levels: noise that is less than a step is still noise, and rounding is none."""

import numpy as np
import pytest

import acutance as ac
from acutance import simulate

SENSOR = simulate.reference_systems()["gaussian"]
CONTRAST_STEPS = 40


def bars_in_steps(noise_steps, seed):
    """An image of 8 bits whose bars are 40 steps higher than the ground."""
    rng = np.random.default_rng(seed)
    image, _ = simulate.bars(SENSOR, rng=rng)
    steps = image * (CONTRAST_STEPS / 1000) + rng.uniform()
    return np.rint(steps + noise_steps * rng.standard_normal(image.shape)).astype(np.uint8)


def quantisation_of(found):
    return next(check for check in found.checks if check.name == "quantisation")


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_a_third_of_a_step_is_not_taken_for_outliers(seed):
    """Most residuals are nothing then: the noise was a fifth of what it is, MTF off by .015."""
    noise = 0.33
    found = ac.measure_bars(bars_in_steps(noise, seed))
    whole = np.hypot(noise, 1 / np.sqrt(12))
    assert found.snr == pytest.approx(CONTRAST_STEPS / whole, rel=0.2)
    number = found.across.mtf_nyquist
    assert abs(number.value - 0.28905) < 3 * number.std
    assert quantisation_of(found).passed
    assert quantisation_of(found).value == pytest.approx(noise, abs=0.08)


def test_rounding_without_noise_is_named():
    found = ac.measure_bars(bars_in_steps(0.02, 1))
    check = quantisation_of(found)
    assert not check.passed
    assert found.verdict.word in ("doubtful", "invalid")
    image, _ = simulate.bars(SENSOR, snr=100, rng=np.random.default_rng(1))
    assert quantisation_of(ac.measure_bars(image)).passed
    assert quantisation_of(ac.measure_bars(np.rint(image))).value == pytest.approx(10, rel=0.1)
