"""Undeclared fill of whole images: its mask in any window, and what is no fill."""

import numpy as np
import pytest

import acutance.simulate as sim
from acutance.raster import Box, Image, find_swath_fill

SHAPE = (700, 600)


def swath(value=0.0, corners=((0.25, 160), (-0.2, 520))):
    """Noisy ground between two slanted borders, and where it ends."""
    rng = np.random.default_rng(5)
    rows, cols = np.indices(SHAPE)
    pixels = np.rint(900 + 60 * np.sin(rows / 19) * np.sin(cols / 23) + rng.normal(0, 15, SHAPE))
    (slope, left), (other, right) = corners
    outside = (cols < left + slope * (rows - 350)) | (cols > right + other * (rows - 350))
    return np.where(outside, value, pixels), outside


@pytest.mark.parametrize("value", [0.0, 65535.0])
def test_the_mask_of_any_window_is_that_of_the_image(value):
    pixels, outside = swath(value)
    fill = find_swath_fill(Image.from_array(pixels))
    assert fill.value == value
    assert np.array_equal(fill.mask(Box.whole(SHAPE)), outside)
    for box in (Box(3, 100, 90, 80), Box(400, 500, 300, 100)):
        assert np.array_equal(fill.mask(box), outside[box.slices])
    beyond = fill.mask(Box(-20, -10, 60, 50))
    assert not beyond[:20].any()
    assert not beyond[:, :10].any()
    assert np.array_equal(beyond[20:, 10:], outside[:40, :40])


def test_constants_within_the_image_are_data():
    pixels, outside = swath()
    pixels[300:340, 250:300] = 0.0
    fill = find_swath_fill(Image.from_array(pixels))
    assert np.array_equal(fill.mask(Box.whole(SHAPE)), outside)


def test_what_is_declared_or_stated_is_not_looked_for():
    pixels, _ = swath()
    assert find_swath_fill(Image.from_array(pixels, nodata=0)) is None
    assert find_swath_fill(Image.from_array(pixels, nodata=np.nan)) is None
    assert find_swath_fill(Image.from_array(np.zeros((80, 80)))) is None


@pytest.mark.parametrize("snr", [np.inf, 100])
def test_the_dark_side_of_a_clipped_edge_is_no_fill(snr):
    system = next(iter(sim.reference_systems().values()))
    pixels, _ = sim.edge(
        system, shape=(400, 400), angle_deg=6, snr=snr, dark=0.0, bright=900.0,
        rng=np.random.default_rng(1),
    )  # fmt: skip
    assert find_swath_fill(Image.from_array(np.clip(np.rint(pixels), 0, 900))) is None
