"""Where the range of values of an image was cut off."""

import numpy as np
import pytest

from acutance.numerics.clipping import NOT_CLIPPED, clip_levels


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
