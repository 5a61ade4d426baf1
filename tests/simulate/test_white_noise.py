"""White noise of a plane: the same numbers in every window, and no two places alike."""

import numpy as np

from acutance.raster import Box
from acutance.simulate.white_noise import CELL_PX, generator_at, white_noise


def test_windows_agree_where_they_meet():
    wide = white_noise((1, 2), Box(-100, -30, 300, 250))
    assert wide.shape == (300, 250)
    np.testing.assert_array_equal(
        white_noise((1, 2), Box(-17, 5, 90, 201)), wide[83 : 83 + 90, 35 : 35 + 201]
    )


def test_it_is_white_and_of_unit_variance():
    noise = white_noise((3,), Box(-CELL_PX, 0, 8 * CELL_PX, 8 * CELL_PX))
    error = 1 / np.sqrt(noise.size)
    assert abs(np.mean(noise)) < 4 * error
    assert abs(np.var(noise) - 1) < 4 * np.sqrt(2) * error
    for lag in (1, CELL_PX):
        assert abs(np.mean(noise[lag:] * noise[:-lag])) < 5 * error
        assert abs(np.mean(noise[:, lag:] * noise[:, :-lag])) < 5 * error


def test_seeds_and_places_have_numbers_of_their_own():
    places = [((1,), 0, 0), ((2,), 0, 0), ((1,), 0, 1), ((1,), 1, 0), ((1,), -1, 0), ((1, 7), 0, 0)]
    first = {float(generator_at(*place).standard_normal()) for place in places}
    assert len(first) == len(places)
