"""Fields of the sky: galaxies against their profiles, and what a field holds."""

from __future__ import annotations

import json

import numpy as np
import pytest

from acutance import ModelError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.simulate import Galaxy, SkyField, render_patches, sky

SENSOR = Sensor([Gaussian(0.8), Detector()])


@pytest.mark.parametrize("profile", ["exponential", "de-vaucouleurs"])
def test_half_of_the_light_lies_within_the_half_light_radius(profile):
    """Much wider than the PSF."""
    galaxy = Galaxy(127.3, 128.1, 1000.0, 14.0, profile)
    image = render_patches(SENSOR, [galaxy], (256, 256))
    rows, cols = np.indices(image.shape)
    inside = np.hypot(rows - galaxy.row, cols - galaxy.col) < galaxy.half_light_px
    assert image[inside].sum() / 1000.0 == pytest.approx(0.5, abs=0.015)
    assert image.sum() == pytest.approx(1000.0, rel=0.01)


def test_a_disc_has_the_variance_of_its_profile_along_either_axis():
    """Of exp(-r / h) the variance along an axis is 3 h^2, in the ratio of the axes squared."""
    ratio, scale_px = 0.5, 2.0
    galaxy = Galaxy(96.0, 96.0, 1.0, 1.67835 * scale_px, axis_ratio=ratio, turn_deg=90.0)
    image = render_patches(SENSOR, [galaxy], (193, 193))
    rows, cols = np.indices(image.shape) - 96.0
    blur = 0.8**2 + 1 / 12
    down, across = np.sum(image * rows**2) - blur, np.sum(image * cols**2) - blur
    assert down == pytest.approx(3 * scale_px**2 / ratio, rel=0.01)
    assert across == pytest.approx(3 * scale_px**2 * ratio, rel=0.01)


def test_a_field_holds_what_was_asked_for():
    field = SkyField(stars=7, galaxies=5, doubles=2, cosmic_rays=3, hot_pixels=4, snr=(50.0, 90.0))
    image, truth = sky(SENSOR, field, shape=(160, 150), rng=np.random.default_rng(3))
    assert image.shape == (160, 150)
    assert truth.points.positions.shape == (7, 2)
    assert (len(truth.galaxies), len(truth.doubles)) == (5, 4)
    assert (len(truth.cosmic_rays), len(truth.hot_pixels)) == (3, 4)
    for row, col in np.rint(truth.points.positions).astype(int).tolist():
        assert image[row - 1 : row + 2, col - 1 : col + 2].max() > 1000.0 + 30 * truth.noise.read
    for row, col in truth.hot_pixels.astype(int).tolist():
        assert image[row, col] > 1000.0 + 20 * truth.noise.read
    apart = np.hypot(*(truth.doubles[::2] - truth.doubles[1::2]).T)
    assert np.all((apart >= 0.8) & (apart <= 3.0))
    assert json.dumps(truth.to_dict())


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: SkyField(stars=-1),
        lambda: SkyField(snr=(9.0, 3.0)),
        lambda: Galaxy(0.0, 0.0, 1.0, 0.0),
        lambda: Galaxy(0.0, 0.0, 1.0, 1.0, "sersic"),
    ],
)
def test_fields_that_mean_nothing_are_refused(wrong):
    with pytest.raises(ModelError):
        wrong()
