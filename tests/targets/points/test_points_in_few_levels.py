"""Noise in steps of the image's numbers, where rounding hides the wings of the PSF."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import mirror_columns
from acutance.targets.points.rounding import noise_in_steps

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
LAYOUT = mirror_columns((12.4, 12.2))
STEP = 60.0
IMAGE, _ = ac.simulate.points(SENSOR, positions=LAYOUT)


def rounded(noise_steps, above_step, seed=1):
    """The image in few levels, its background so far above one of them."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, noise_steps * STEP, IMAGE.shape)
    return np.rint((IMAGE - 200.0 + noise) / STEP + above_step)


@pytest.mark.parametrize("above_step", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("noise_steps", [0.3, 0.6])
def test_noise_is_found_wherever_the_background_lies_within_a_step(noise_steps, above_step):
    found = noise_in_steps(rounded(noise_steps, above_step), LAYOUT)
    assert found == pytest.approx(noise_steps, rel=0.2)


@pytest.mark.parametrize("above_step", [0.0, 0.1, 0.4, 0.5])
def test_noise_below_a_tenth_of_a_step_is_never_taken_for_a_quarter(above_step):
    assert noise_in_steps(rounded(0.08, above_step), LAYOUT) < 0.26


def test_noise_of_more_than_a_step_is_enough():
    assert noise_in_steps(rounded(2.0, 0.3), LAYOUT) == np.inf
    assert noise_in_steps(IMAGE + np.random.default_rng(1).normal(0, 5, IMAGE.shape), LAYOUT) == (
        np.inf
    )


def test_few_levels_are_named():
    found = ac.measure_points(rounded(0.12, 0.3))
    assert [one.name for one in found.failed_checks if one.severity == "caution"] == [
        "quantisation"
    ]
    assert found.verdict.word == "doubtful"


def test_the_usual_levels_pass():
    found = ac.measure_points(rounded(0.6, 0.3))
    assert not found.verdict.warns
