"""Contrast that differs from group to group of bars, or from side to side of a star."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from periodic_scenes import (
    CYCLES,
    SENSORS,
    STATED,
    STATED_BARS,
    bars_scene,
    measured_bars,
    measured_star,
    star_scene,
)

from acutance.simulate import add_patches
from acutance.targets.periodic import measure_bars, measure_star


@cache
def bars_of(name, excess, seed=1):
    """Three groups of bars, one of which has more contrast by a share."""
    image, truth = bars_scene(name, seed)
    add_patches(image, SENSORS[name], truth.groups[1].patches(excess * 1000.0))
    return measure_bars(image, options=STATED_BARS)


@cache
def star_of(name, *, haze=0.0, light=0.0, seed=1):
    """A star behind haze of a dozen pixels at its right, or in light that rises to the right."""
    image, truth = star_scene(name, seed)
    rows, cols = np.indices(image.shape)
    x, y = cols - truth.star.col, rows - truth.star.row
    thick = haze * np.exp(-0.5 * ((x - 18.0) ** 2 + y**2) / 12.0**2)
    image = image * (1 - thick) + 1500.0 * thick
    return measure_star(image * (1 + light * x / 32.0), cycles=CYCLES, options=STATED)


def check_of(found):
    return next(check for check in found.checks if check.name == "contrast_uniformity")


@pytest.mark.parametrize("name", ["gaussian", "diffraction", "sharpened"])
def test_a_group_of_other_paint_is_named(name):
    check = check_of(bars_of(name, 0.06))
    assert not check.passed
    assert 0.02 < check.value < 0.09
    assert "group" in check.message


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "asymmetric", "long kernel"])
def test_even_bars_pass(name):
    assert check_of(measured_bars(name)[0]).passed


@pytest.mark.parametrize("name", ["gaussian", "diffraction"])
def test_haze_on_one_side_is_named(name):
    found = star_of(name, haze=0.1)
    assert not check_of(found).passed
    assert found.verdict.warns


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "asymmetric", "long kernel"])
def test_even_stars_pass(name):
    assert check_of(measured_star(name)[0]).passed


def test_light_that_rises_to_one_side_is_no_haze():
    assert check_of(star_of("gaussian", light=0.1)).passed
