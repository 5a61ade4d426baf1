"""Sources of different widths: mirrors that are no points widen what is taken for the PSF."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import ndimage

import acutance as ac
from acutance.simulate import mirror_columns, reference_systems

SYSTEMS = reference_systems()
RINGS = 8


def measured(name, diameter_px, seed=1, snr=200.0, textured=False):
    """Twenty mirrors that are discs of all sizes up to a diameter."""
    rng = np.random.default_rng(seed)
    places = mirror_columns((12.5, 12.5)) + rng.uniform(-0.4, 0.4, 2)
    shape = tuple(np.ceil(places.max(axis=0)).astype(int) + 13)
    sizes = diameter_px * rng.uniform(0.0, 1.0, len(places))
    image = np.zeros(shape)
    for k in range(RINGS):
        # So many points spread evenly over a disc.
        away = 0.5 * sizes * math.sqrt((k + 0.5) / RINGS)
        turn = 2.4 * k
        moved = places + away[:, None] * np.array([math.sin(turn), math.cos(turn)])
        image += ac.simulate.points(SYSTEMS[name], positions=moved, shape=shape)[0] / RINGS
    noise = rng.normal(size=shape)
    if textured:
        noise = ndimage.gaussian_filter(noise, 0.75)
    return ac.measure_points(image + 1000.0 / snr * noise / noise.std())


def check_of(found):
    return next(check for check in found.checks if check.name == "equal_widths")


@pytest.mark.parametrize("name", ["gaussian", "halo", "asymmetric", "defocused"])
def test_mirrors_of_different_sizes_are_named(name):
    found = measured(name, 1.2)
    assert not check_of(found).passed
    assert found.verdict.warns


@pytest.mark.parametrize("name", sorted(SYSTEMS))
def test_points_pass(name):
    assert check_of(measured(name, 0.0)).value < 2.5


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_sources_pass(count):
    image, _ = ac.simulate.points(
        SYSTEMS["gaussian"], positions=mirror_columns((12.3, 12.1), count=count, columns=1),
        snr=80.0, rng=np.random.default_rng(count),
    )  # fmt: skip
    assert check_of(ac.measure_points(image)).passed


@pytest.mark.parametrize("seed", [0, 3, 5, 7])
def test_points_on_grass_pass(seed):
    """Its noise is correlated by .6: sizes and residuals scatter more than by white noise."""
    scene = ac.simulate.brookings(ac.optics.preset("generic-2005"), np.random.default_rng(seed))
    found = ac.measure_points(scene.image, roi=(10, 160, 120, 50))
    checks = {check.name: check for check in found.checks}
    assert not checks["correlated_noise"].passed
    assert checks["equal_widths"].value < 3
    assert checks["source_misfit"].passed


def test_mirrors_of_different_sizes_are_named_on_textured_ground():
    found = measured("gaussian", 1.2, textured=True)
    assert not check_of(found).passed
