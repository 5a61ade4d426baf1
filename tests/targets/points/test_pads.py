"""Pads under mirrors: seen, measured, and absent where there are none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import acutance as ac
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.simulate import Patch, Point, mirror_columns, render_patches
from acutance.targets.points.pads import pads_image
from acutance.targets.points.stamps import cut_stamps

SENSOR = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector()])


def mirrors_on_pads(contrast, side_px, seed, snr=300.0):
    rng = np.random.default_rng(seed)
    places = mirror_columns((12.0, 12.0)) + rng.uniform(0, 1, (1, 2))
    flux = 4000.0
    mirrors = [Point(row, col, flux) for row, col in places.tolist()]
    alone = render_patches(SENSOR, mirrors, (118, 38))
    peak = float(alone.max())
    pads = [Patch(r, c, side_px, side_px, 0.0, contrast * peak) for r, c in places.tolist()]
    image = 200.0 + (render_patches(SENSOR, [*mirrors, *pads], (118, 38)) if contrast else alone)
    return image + rng.standard_normal(image.shape) * peak / snr, places, peak


def test_the_image_of_a_pad_is_a_square_through_a_pixel_and_the_blur():
    empty = np.zeros((41, 41))
    stamps = cut_stamps(empty, np.array([[20.0, 20.0]]), 10.0)
    found = pads_image(stamps, np.array([[20.0, 20.0]]), GaussianPixel2d(0.36, 0.0, 0.36), 3.0)
    fine = np.zeros((41 * 9, 41 * 9))
    fine[19 * 9 : 22 * 9, 19 * 9 : 22 * 9] = 1.0
    drawn = gaussian_filter(fine, 0.6 * 9).reshape(41, 9, 41, 9).mean(axis=(1, 3))
    rows, cols = stamps.row.astype(int), stamps.col.astype(int)
    np.testing.assert_allclose(found, drawn[rows, cols], atol=2e-3)


@pytest.mark.parametrize("contrast", [0.02, -0.02])
def test_pads_are_seen_and_leave_the_mtf_right(contrast):
    """Without pads in the model the error is .025, six times the deviation or more."""
    true = SENSOR.response(0.0, "across")
    errors, deviations, levels = [], [], []
    for seed in range(3):
        image, places, peak = mirrors_on_pads(contrast, 3.0, seed)
        found = ac.measure_points(image, positions=places)
        errors.append(found.across.mtf_nyquist.value - true.mtf_nyquist.value)
        deviations.append(found.across.mtf_nyquist.std)
        if found.pads is not None:
            assert found.to_dict()["pads"]["side_px"] == found.pads.side_px == 3.0
            level = found.pads.contrast
            assert abs(level.value - contrast * peak) < 3 * level.std < abs(contrast * peak)
            levels.append(level.value)
    assert len(levels) >= 2
    assert np.abs(errors).max() < 0.02
    assert np.abs(np.array(errors) / deviations).max() < 2


def test_without_pads_there_are_none():
    deviations = []
    for seed in range(3):
        image, places, _ = mirrors_on_pads(0.0, 3.0, seed)
        found = ac.measure_points(image, positions=places)
        assert found.pads is None
        assert "pads" not in found.to_dict()
        deviations.append(found.across.mtf_nyquist.std)
    assert np.median(deviations) < 0.004


def test_pads_are_seen_at_a_fourth_of_that_snr_and_not_under_a_sharpened_product():
    image, places, _ = mirrors_on_pads(0.02, 5.0, 0, snr=80.0)
    found = ac.measure_points(image, positions=places)
    assert found.pads is not None
    assert found.pads.side_px == 5.0
    sharpened = ac.Sensor([*SENSOR.blocks, ac.optics.Sharpening.both_axes(0.4)])
    rng = np.random.default_rng(0)
    for _ in range(2):
        image, _ = ac.simulate.points(sensor=sharpened, positions=places, snr=80.0, rng=rng)
        assert ac.measure_points(image, positions=places).pads is None
