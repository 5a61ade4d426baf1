"""Waves in parts of a star's rings, fitted all at once, are those of each part alone."""

import numpy as np
import pytest

from acutance.targets.periodic.part_waves import PartWaves

COUNT = 6


@pytest.fixture(scope="module")
def pixels():
    """Part, phase and value of pixels: 40 in most parts, 5 in the fourth, none in the last."""
    rng = np.random.default_rng(3)
    part = np.repeat(np.arange(COUNT), [40, 40, 40, 5, 40, 0])
    turned = rng.uniform(0, 2.5, part.size) + 9 * part
    # The fifth has pixels of one phase alone.
    turned[part == 4] = 1.0
    value = 100 + part + 7 * np.cos(turned - 0.3) + rng.standard_normal(part.size)
    return part, turned, value


def test_each_is_that_of_its_own_least_squares(pixels):
    part, turned, value = pixels
    found = PartWaves.of(part, turned, value, COUNT)
    for one in range(3):
        own = part == one
        design = np.stack([np.ones(own.sum()), np.cos(turned[own]), np.sin(turned[own])], axis=1)
        fit, rest, *_ = np.linalg.lstsq(design, value[own])
        assert found.cosine[one] == pytest.approx(fit[1], rel=1e-5)
        assert found.sine[one] == pytest.approx(fit[2], rel=1e-5)
        assert found.rest[one] == pytest.approx(rest[0], rel=1e-6)
        np.testing.assert_allclose(found.wave[own], design[:, 1:] @ fit[1:], atol=1e-5)


def test_few_pixels_and_one_phase_have_no_wave(pixels):
    found = PartWaves.of(*pixels, COUNT)
    assert found.sizes.tolist() == [40, 40, 40, 5, 40, 0]
    assert found.has_enough.tolist() == [True, True, True, False, True, False]
    assert found.cosine[3] == found.sine[3] == found.cosine[5] == found.sine[5] == 0
    assert np.ptp(found.wave[pixels[0] == 4]) == 0
