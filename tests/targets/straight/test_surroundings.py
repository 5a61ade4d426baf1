"""Loops over the pixels around a target, against plain counts of small regions."""

import numpy as np
import pytest
from scipy import ndimage

from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets.straight.step_profile import pulse_profile
from acutance.targets.straight.surroundings import (
    best_rows,
    bounded_residual,
    line_distances,
    local_mean,
    pixels_along,
    reach_before_structure,
    reach_of_rows,
    values_beside,
)

LINE = Line(row=10.0, col=12.0, normal_deg=8.0)
SHAPE = (20, 26)
S, T = line_distances(SHAPE, LINE)
ROWS, COLS = (places.astype(float) for places in np.indices(SHAPE))


def holed(seed=3):
    rng = np.random.default_rng(seed)
    image = rng.standard_normal(SHAPE)
    image[rng.random(SHAPE) < 0.1] = np.nan
    return image


def test_distances_are_those_of_the_line():
    assert np.array_equal(S, LINE.normal_distance(ROWS, COLS))
    assert np.array_equal(T, LINE.tangent_distance(ROWS, COLS))


def test_pixels_along_are_the_usable_ones_near_the_stretch():
    image = holed()
    row, col, value, s = pixels_along(image, S, T, -6.0, 5.0, 3.0)
    near = (np.abs(S) < 3) & (T > -6) & (T < 5) & np.isfinite(image)
    assert np.array_equal(row, ROWS[near])
    assert np.array_equal(col, COLS[near])
    assert np.array_equal(value, image[near])
    assert np.array_equal(s, S[near])


def test_local_mean_is_that_of_the_usable_pixels():
    image = holed()
    usable = np.isfinite(image)
    nine = np.ones((3, 3))
    total = ndimage.convolve(np.where(usable, image, 0), nine, mode="constant")
    known = ndimage.convolve(usable.astype(float), nine, mode="constant")
    mean = local_mean(image)
    assert np.array_equal(np.isfinite(mean), usable)
    assert mean[usable] == pytest.approx((total / np.maximum(known, 1))[usable], abs=1e-12)


def test_residual_of_a_pulse_is_its_noise_and_bounded():
    profile, blur = pulse_profile(4.0, 0.9), GaussianPixel(0.5, 1.2)
    noise = 0.01 * holed()
    image = 30 + 200 * (profile.mean(blur, S) + noise)
    image[0, 0], image[1, 1] = 1e6, -1e6
    found = bounded_residual(image, S, 30.0, 200.0, profile.steps, 0.5, 1.2)
    assert (found[0, 0], found[1, 1]) == (1.0, -1.0)
    expected = np.clip(noise, -1, 1)
    expected[0, 0], expected[1, 1] = 1.0, -1.0
    assert np.allclose(found, expected, atol=1e-10, equal_nan=True)


def test_values_beside_lie_between_two_distances_from_the_ends():
    values = holed()
    outside = np.maximum(-S, S - 2.5)
    chosen = (outside > 1) & (outside < 4) & (np.abs(T) < 7) & np.isfinite(values)
    assert np.array_equal(values_beside(values, S, T, 2.5, 1.0, 4.0, 7.0), values[chosen])


def test_rows_reach_their_last_pixel_and_their_first_structure():
    mean = np.zeros(SHAPE)
    # Four pixels behind the target's last step, in one row of the line.
    place = np.unravel_index(np.argmin(np.hypot(S - 6.5, T - 0.5)), SHAPE)
    mean[place] = 0.5
    first, last, stop, structure = reach_of_rows(mean, S, T, 2.5, 41.0, 0.1, 1.5, 0.2)
    assert structure
    rows = np.floor(T - first).astype(int)
    for row in range(last.shape[1]):
        own = rows == row
        assert last[0, row] == pytest.approx(max((-S[own]).max(initial=0), 0))
        assert last[1, row] == pytest.approx(max((S[own] - 2.5).max(initial=0), 0))
    spoiled = rows[place]
    assert stop[1, spoiled] == pytest.approx(S[place] - 2.5 - 1)
    assert np.isinf(stop[0]).all()
    assert np.isinf(np.delete(stop[1], spoiled)).all()


def test_structure_near_the_target_needs_more_and_structure_within_spoils_both_sides():
    mean = np.zeros(SHAPE)
    mean[10, 14] = 0.15
    *_, structure = reach_of_rows(mean, S, T, 2.5, 41.0, 0.1, 1.5, 0.2)
    assert not structure
    mean[10, 14] = 0.25
    _, _, stop, structure = reach_of_rows(mean, S, T, 2.5, 41.0, 0.1, 1.5, 0.2)
    assert structure
    assert (stop.min(axis=1) == 0).all()


def test_structure_ends_the_rows_beside_it_and_a_blur_before_it_the_wider_ones():
    stop = np.full((1, 11), np.inf)
    stop[0, 5] = 8.0
    reach = reach_before_structure(stop, 2.5, 5.0)[0]
    assert reach[[1, 9]] == pytest.approx([np.inf, np.inf])
    assert reach[[2, 3, 4, 5, 6, 7, 8]] == pytest.approx(np.full(7, 5.5))
    stop[0, 5] = 4.0
    reach = reach_before_structure(stop, 2.5, 5.0)[0]
    assert reach[[4, 5, 6]] == pytest.approx([4.0, 4.0, 4.0])
    assert reach[[2, 3, 7, 8]] == pytest.approx(np.full(4, 5.0))


@pytest.mark.parametrize(
    ("reach", "expected"),
    [
        ([1.0, 1, 1], []),
        ([3.0] * 5 + [1.0] + [3.0] * 4, [0, 1, 2, 3, 4]),
        ([3.0] * 5 + [1.0] + [3.0] * 5, [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]),
        ([3.0] * 2 + [7.0] * 7, [2, 3, 4, 5, 6, 7, 8]),
        ([3.0] * 9 + [7.0] * 4, list(range(13))),
        ([7.0] * 5 + [1.0] + [7.0] * 5 + [3.0], [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]),
    ],
)
def test_best_rows_are_many_or_have_wide_plateaus(reach, expected):
    assert np.flatnonzero(best_rows(np.array(reach), 3.0)).tolist() == expected
