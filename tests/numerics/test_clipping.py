"""Where the range of values of an image was cut off."""

import numpy as np
import pytest

from acutance.numerics.clipping import NOT_CLIPPED, clip_levels, piled_up_share


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def test_noise_ends_by_chance(rng):
    assert clip_levels(np.rint(rng.normal(200.0, 3.0, 40_000))) == NOT_CLIPPED
    assert clip_levels(rng.normal(200.0, 3.0, 40_000)) == NOT_CLIPPED
    water, land = rng.normal(20.0, 0.6, 20_000), rng.normal(200.0, 30.0, 20_000)
    assert clip_levels(np.rint(np.concatenate([water, land]))) == NOT_CLIPPED


@pytest.mark.parametrize("step", [1.0, 0.0])
def test_either_end_is_found(rng, step):
    values = rng.normal(200.0, 30.0, 40_000)
    values = np.rint(values) if step else values
    assert clip_levels(np.maximum(values, 150.0)) == (150.0, None)
    assert clip_levels(np.minimum(values, 260.0)) == (None, 260.0)
    assert clip_levels(np.clip(values, 150.0, 260.0)) == (150.0, 260.0)


def test_levels_without_noise_are_not_clipped(rng):
    drawn = rng.choice([0.0, 30.0, 70.0, 90.0, 120.0, 180.0, 210.0, 240.0, 255.0], 40_000)
    assert clip_levels(drawn) == NOT_CLIPPED
    assert clip_levels(rng.choice([0.0, 255.0], 40_000)) == NOT_CLIPPED


@pytest.mark.parametrize("std", [2.0, 4.0, 10.0])
def test_a_few_equal_pixels_at_the_end_of_a_clean_side_are_chance(std):
    """Of sides of 300 whole numbers one in 600 has five at its end and one at the next value."""
    rng = np.random.default_rng(1)
    sides = [np.round(rng.normal(rng.random(), std, 300)) for _ in range(4000)]
    assert not any(piled_up_share(side) for side in sides)


def test_a_tenth_of_a_side_that_is_cut_off_is_no_chance(rng):
    sides = [np.minimum(np.round(rng.normal(0.0, 10.0, 300)), 13.0) for _ in range(500)]
    found = [piled_up_share(side) for side in sides]
    assert np.mean(np.array(found) > 0.05) > 0.9
