"""A small picture of a large image."""

import numpy as np

from acutance.raster import Box, Image
from acutance.raster.quick_look import quick_look


def test_a_small_image_is_its_own_quick_look():
    pixels = np.random.default_rng(0).normal(size=(40, 30))
    found = quick_look(Image.of(pixels), Box(5, 3, 20, 10))
    np.testing.assert_array_equal(found, pixels[5:25, 3:13])


def test_of_a_large_image_every_so_many_rows_and_columns_are_taken():
    pixels = np.add.outer(np.arange(2500.0) * 1e4, np.arange(1201.0))
    found = quick_look(Image.of(pixels), Box(0, 1, 2500, 1200))
    assert max(found.shape) <= 1000
    np.testing.assert_array_equal(found, pixels[1::3, 2:1201:2])


def test_of_a_long_strip_all_columns_or_rows_are_taken():
    pixels = np.random.default_rng(0).normal(size=(20000, 8))
    long, wide = (quick_look(Image.of(one), Box.whole(one.shape)) for one in (pixels, pixels.T))
    np.testing.assert_array_equal(long, pixels[10::20])
    np.testing.assert_array_equal(wide, long.T)
