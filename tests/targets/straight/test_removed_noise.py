"""Filters that take noise from plateaus and keep edges are named; rough borders are not."""

import numpy as np
import pytest
from scipy.ndimage import median_filter, shift, uniform_filter

import acutance as ac

SYSTEMS = ac.simulate.reference_systems()
NOISE = 10.0
"""Of a contrast of 1000."""


def edge(seed, **changed):
    """An edge of one of the reference systems."""
    rng = np.random.default_rng(seed)
    name = sorted(SYSTEMS)[seed % len(SYSTEMS)]
    image, _ = ac.simulate.edge(
        SYSTEMS[name], angle_deg=rng.uniform(4, 20), shape=(56, 52), dark=200.0, bright=1200.0,
        rng=rng, **{"snr": 1000 / NOISE} | changed,
    )  # fmt: skip
    return image


def neighbourhood(image, reach):
    """The image moved by every step up to a reach, (k, rows, cols), and the steps."""
    padded = np.pad(image, reach, mode="reflect")
    rows, cols = image.shape
    steps = [(i, j) for i in range(2 * reach + 1) for j in range(2 * reach + 1)]
    return np.array([padded[i : i + rows, j : j + cols] for i, j in steps])


def bilateral(image):
    """Means of pixels that differ by no more than the noise explains."""
    around = neighbourhood(image, 2)
    weight = np.exp(-((around - image) ** 2) / (2 * (3 * NOISE) ** 2))
    return np.sum(weight * around, axis=0) / np.sum(weight, axis=0)


def non_local_means(image):
    """Means of pixels in surroundings that are alike."""
    around = neighbourhood(image, 3)
    apart = np.array([uniform_filter((one - image) ** 2, 3) for one in around])
    weight = np.exp(-np.maximum(apart - 2 * NOISE**2, 0) / (1.5 * NOISE) ** 2)
    return np.sum(weight * around, axis=0) / np.sum(weight, axis=0)


def median(image):
    return median_filter(image, 3)


def check_of(found):
    return next(check for check in found.checks if check.name == "removed_noise")


@pytest.mark.parametrize("filtered", [bilateral, non_local_means, median])
def test_filters_that_keep_edges_are_named(filtered):
    checks = [check_of(ac.measure_edge(filtered(edge(seed)))) for seed in range(8)]
    named = [check for check in checks if not check.passed]
    assert len(named) >= 6
    assert all(check.severity == "caution" and "times as much" in check.message for check in named)


@pytest.mark.parametrize("snr", [20.0, 100.0, 500.0, None])
@pytest.mark.parametrize("noise", ["white", "interpolated"])
def test_noise_that_no_filter_took_is_not_named(snr, noise):
    regrid = ac.simulate.Regrid(0.3, -0.2) if noise == "interpolated" else None
    for seed in range(8):
        assert check_of(ac.measure_edge(edge(seed, snr=snr, regrid=regrid))).passed


def test_rough_borders_are_not_named():
    rng = np.random.default_rng(0)
    for seed in range(8):
        # Half of the noise is smooth, as of ground, and rows move to and fro by .08 px.
        image = edge(seed, orientation="across")
        rough = [shift(row, 0.08 * rng.normal(), order=3, mode="nearest") for row in image]
        ground = 2 * NOISE * uniform_filter(rng.normal(size=image.shape), 3)
        found = ac.measure_edge(np.array(rough) + ground)
        assert check_of(found).passed


def test_a_pulse_is_asked_too():
    rng = np.random.default_rng(5)
    image, _ = ac.simulate.pulse(
        SYSTEMS["gaussian"], angle_deg=8.0, shape=(70, 60), dark=200.0, bright=1200.0, snr=100.0,
        rng=rng,
    )  # fmt: skip
    assert check_of(ac.measure_pulse(image)).passed
    assert not check_of(ac.measure_pulse(bilateral(image))).passed
