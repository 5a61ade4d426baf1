"""Sources of which some pixels are missing: their light is in the pixels of their neighbours."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
SQUARE = np.array([(20.1 + 5.25 * row, 20.1 + 5.25 * col) for row in range(4) for col in range(4)])


def square_of_mirrors(seed, first_row=20.1):
    """16 mirrors 5.25 px apart, and the truth."""
    positions = SQUARE + np.array([first_row - 20.1, 0.0])
    rng = np.random.default_rng(seed)
    return ac.simulate.points(SENSOR, positions=positions, shape=(60, 56), snr=80, rng=rng)


def largest_error(found, truth):
    """Of the MTF at Nyquist in both directions, beside the larger deviation."""
    pairs = [(found.across, truth.response("across")), (found.along, truth.response("along"))]
    errors = [one.mtf_nyquist.value - true.mtf_nyquist.value for one, true in pairs]
    return np.abs(errors).max(), max(one.mtf_nyquist.std for one, _ in pairs)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_mirror_that_lacks_a_pixel_is_still_a_source(seed):
    image, truth = square_of_mirrors(seed)
    _, whole_std = largest_error(ac.measure_points(image), truth)
    for place in SQUARE[[5, 10]]:
        image[round(place[0]) + 2, round(place[1])] = np.nan
    found = ac.measure_points(image)
    error, std = largest_error(found, truth)
    assert len(found.sources) == 16
    assert error < 0.02
    assert std < 1.15 * whole_std


def test_a_mirror_at_the_border_is_a_source_once_its_core_is_there():
    image, truth = square_of_mirrors(3, first_row=1.7)
    found = ac.measure_points(image)
    assert len(found.sources) == 16
    assert largest_error(found, truth)[0] < 0.02


def test_a_mirror_without_its_core_is_covered():
    image, truth = square_of_mirrors(4)
    for place in SQUARE[[5, 10]]:
        image[round(place[0]) + 1, round(place[1])] = np.nan
    found = ac.measure_points(image)
    error, std = largest_error(found, truth)
    assert {one.reason for one in found.rejected} == {"edge"}
    assert len(found.sources) == 14
    assert error < 0.02
    assert std < 0.02


def test_a_track_at_the_border_is_no_source():
    image, truth = square_of_mirrors(5)
    image[2, 40:44] += 700.0
    found = ac.measure_points(image)
    assert len(found.sources) == 16
    assert {one.reason for one in found.rejected} <= {"edge", "unlike"}
    assert largest_error(found, truth)[0] < 0.02
