"""Points among objects of all sizes: stars among galaxies, and galaxies alone."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.targets.points.moments import SpotShape
from acutance.targets.points.population import densest_sharpest, sharpest_population

SENSOR = ac.Sensor([ac.optics.Gaussian(0.8), ac.optics.Detector()])


def shape(narrow, wide, std=0.01):
    return SpotShape(0.0, 0.0, narrow, wide, narrow, wide, std, std)


def galaxies(rng, count):
    size = 0.72 + np.exp(rng.uniform(np.log(0.1), np.log(2.0), count))
    ratio = rng.uniform(1.0, 1.8, count)
    return [shape(*one) for one in np.stack([size, size * ratio], axis=1).tolist()]


def test_points_are_the_sharpest_consistent_ones_and_not_the_majority():
    rng = np.random.default_rng(2)
    stars = [shape(*(0.72 + 0.01 * rng.standard_normal(2))) for _ in range(12)]
    rays = [shape(0.09, 0.2), shape(0.10, 0.6), shape(0.085, 0.19), shape(0.12, 3.0)]
    found = sharpest_population(stars + galaxies(rng, 80) + rays)
    assert found.mixed
    assert found.distinct
    assert found.narrow_px2 == pytest.approx(0.72, abs=0.02)
    assert found.members[:12].all()
    assert found.members[12:].mean() < 0.05


def test_galaxies_alone_have_no_size_that_stands_out():
    found = [sharpest_population(galaxies(np.random.default_rng(i), 150)) for i in range(20)]
    assert all(one.mixed for one in found)
    assert sum(one.distinct for one in found) <= 3


def test_equal_spots_are_no_mixed_field():
    rng = np.random.default_rng(5)
    equal = [shape(*(0.5 + 0.01 * rng.standard_normal(2))) for _ in range(20)]
    found = sharpest_population([*equal, shape(0.5, 1.5)])
    assert not found.mixed
    assert found.members[:20].all()
    assert sharpest_population(equal[:3]) is None


def test_sizes_that_all_differ_have_no_middle():
    sizes = np.array([[1.0], [2.0], [4.0], [8.0], [16.0], [32.0]])
    assert densest_sharpest(sizes, 0.01 * sizes) is None


def test_stars_among_galaxies_are_measured_by_the_default_call():
    field = ac.simulate.SkyField(stars=20, galaxies=120, doubles=3, cosmic_rays=10, hot_pixels=4)
    rng = np.random.default_rng(11)
    image, truth = ac.simulate.sky(SENSOR, field, shape=(340, 340), rng=rng)
    found = ac.measure_points(image)
    places = truth.points.positions
    away = np.hypot(*(found.positions[:, None] - places[None]).transpose(2, 0, 1)).min(axis=1)
    assert len(found.sources) >= 12
    assert np.mean(away < 0.3) >= 0.95
    true = truth.points.response().fwhm_px.value
    assert found.across.fwhm_px.value == pytest.approx(true, rel=0.01)
    assert found.along.fwhm_px.value == pytest.approx(true, rel=0.01)
    reasons = {one.reason for one in found.rejected}
    assert reasons >= {"extended", "blended", "cosmic ray", "hot pixel"}


def test_a_field_of_galaxies_is_refused_in_words():
    field = ac.simulate.SkyField(stars=0, doubles=0, galaxies=100, cosmic_rays=6)
    image, _ = ac.simulate.sky(SENSOR, field, shape=(320, 320), rng=np.random.default_rng(4))
    with pytest.raises(ac.TargetError, match="galaxies"):
        ac.measure_points(image)
