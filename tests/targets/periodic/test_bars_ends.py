"""Light that bars scatter over their ends belongs to the image of every mode."""

from __future__ import annotations

import math

import numpy as np
import pytest
from periodic_scenes import SENSORS
from scipy.special import ndtr

import acutance as ac
from acutance.geometry.bar_group import Bars
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.targets.periodic.bars_ends import end_effects
from acutance.targets.periodic.bars_pixels import GroupPixels, group_columns

SIGMA_PX = 3.0


def _seen_along(along_px, length_px):
    """A line of some length behind a Gaussian and a pixel, 1 well inside."""

    def of_edge(distance):
        x = distance / SIGMA_PX
        return SIGMA_PX * (x * ndtr(x) + np.exp(-0.5 * x**2) / math.sqrt(2 * math.pi))

    ends = (along_px + 0.5 * length_px, along_px - 0.5 * length_px)
    first, last = (of_edge(one + 0.5) - of_edge(one - 0.5) for one in ends)
    return first - last


@pytest.mark.parametrize("length_px", [20.0, 70.0])
@pytest.mark.parametrize("angle_deg", [0.0, 25.0])
def test_a_wide_blur_takes_light_from_bars_that_end(angle_deg, length_px):
    bars = Bars(50.0, 50.0, angle_deg, 9.0, 4, length_px)
    other = Bars(50.0, 50.0, angle_deg + 0.1, 5.0, 3, 30.0)
    mean = MeanOtf(SIGMA_PX**2, 0.0, SIGMA_PX**2)
    states = ProcessModes(mean.width_px)
    pixels = GroupPixels.of(np.zeros((101, 101)), bars, 1)
    effect = end_effects(mean, states, (bars, other), 8.0)[0]
    found = effect.columns(pixels.across, pixels.along)
    endless, _ = group_columns(pixels, mean, states, 1.0)
    wanted = endless[:, 0] * (_seen_along(pixels.along, length_px) - 1)
    assert np.max(np.abs(wanted)) > 0.01
    assert found.shape == endless.shape
    assert found[:, 0] == pytest.approx(wanted, abs=2e-4)


def test_a_narrow_blur_takes_none():
    bars = Bars(40.0, 40.0, 5.0, 6.0, 4, 30.0)
    mean = MeanOtf(0.16, 0.0, 0.16)
    states = ProcessModes(mean.width_px)
    pixels = GroupPixels.of(np.zeros((81, 81)), bars, 1)
    found = end_effects(mean, states, (bars,), 8.0)[0].columns(pixels.across, pixels.along)
    assert np.max(np.abs(found[:, 0])) < 1e-3


@pytest.mark.parametrize("name", ["diffraction", "defocused", "halo"])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_contrast_of_quiet_bars_is_that_before_the_sensor(name, seed):
    """Apertures and halos scatter over the ends of 24 px: taken from the fit before, that made
    the contrast 1 % too large, up to eight deviations."""
    image, truth = ac.simulate.bars(SENSORS[name], snr=600, rng=np.random.default_rng(seed))
    found = ac.measure_bars(image)
    assert abs(found.contrast.value - 1000) < 3 * found.contrast.std < 15
    otf = float(np.abs(truth.sensor.otf(np.array([0.5]), np.array([0.0])))[0])
    seen = found.across.mtf_nyquist
    assert abs(seen.value - otf) < min(3 * seen.std, 0.002)
