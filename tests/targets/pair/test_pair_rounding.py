"""Pairs in few grey levels."""

import math

import numpy as np
import pytest
from pair_scenes import REFERENCE, SMALL, rendered

import acutance as ac
from acutance.targets.pair.rounding import detail_in_steps


def _check(step):
    low, high, _ = rendered("gaussian", 2.0, shape=SMALL)
    rounded = [np.round(image / step).astype(np.int32) for image in (low, high)]
    found = ac.measure_biresolution(*rounded, ratio=2.0, reference_mtf=REFERENCE)
    (check,) = (one for one in found.checks if one.name == "quantisation")
    return check, found


def test_few_grey_levels_are_named():
    check, found = _check(170.0)
    assert not check.passed
    assert "of its numbers, rounding taken off" in check.message
    assert found.verdict.word == "doubtful"


def test_enough_grey_levels_pass():
    assert _check(60.0)[0].passed


def test_numbers_finer_than_the_noise_pass():
    assert _check(1.0)[0].value == 999.0


@pytest.mark.parametrize("size", [0.3, 0.5, 0.8])
def test_rounding_is_taken_off(size):
    rng = np.random.default_rng(2)
    noise = size * rng.standard_normal((200, 200)) + np.linspace(0, 40, 200)
    found = detail_in_steps([np.round(noise)])
    assert found == pytest.approx(size * math.sqrt(1.25), rel=0.05)


def test_a_uniform_image_and_one_without_data_have_no_steps():
    assert detail_in_steps([np.full((30, 30), 7.0)]) == math.inf
    assert detail_in_steps([np.full((30, 30), np.nan)]) == math.inf
