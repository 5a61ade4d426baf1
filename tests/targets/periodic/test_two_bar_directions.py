"""Two sets of bars at right angles, tilted: how the blur is turned between them stays open."""

from __future__ import annotations

import math
import tracemalloc
from functools import cache

import numpy as np
import pytest

from acutance.curves import Estimate
from acutance.geometry.bar_group import Bars
from acutance.numerics.otf_modes import MeanOtf
from acutance.optics import Detector, Gaussian, Sensor
from acutance.simulate import bars
from acutance.targets.periodic import measure_bars
from acutance.targets.periodic.bars import common_normals
from acutance.targets.periodic.fit_bars import solve_bars
from acutance.targets.periodic.oblique_blur import aligned_or_turned
from acutance.targets.periodic.otf_model import FittedOtf

SENSOR = Sensor([Gaussian(0.4), Detector()])


def two_sets(angle_deg, seed=5):
    """Both sets beside one another."""
    rng = np.random.default_rng(seed)
    parts = [
        bars(
            SENSOR, periods_px=(8, 4, 2.4), angle_deg=angle_deg, orientation=way, snr=100, rng=rng
        )[0]
        for way in ("across", "along")
    ]
    size = max(max(part.shape) for part in parts)
    padded = [
        np.pad(one, [(0, size - n) for n in one.shape], constant_values=np.nan) for one in parts
    ]
    return np.vstack(padded)


@cache
def measured(angle_deg):
    return measure_bars(two_sets(angle_deg))


@pytest.mark.parametrize(("angle_deg", "most"), [(4.0, 0.011), (8.0, 0.021)])
def test_a_tilt_widens_the_curves_across_and_along_by_less_than_any_blur_would(angle_deg, most):
    found = measured(angle_deg)
    assert len(found.directions_deg) == 2
    for name, own in found.directions.items():
        truth = SENSOR.response_along(found.axes_deg[name]).mtf_nyquist.value
        assert own.mtf_nyquist.std < most
        assert abs(own.mtf_nyquist.value - truth) < 1.5 * own.mtf_nyquist.std


@pytest.mark.parametrize("angle_deg", [-8.0, 0.0, 4.0, 8.0])
def test_the_first_direction_is_the_one_nearest_to_across(angle_deg):
    first, second = measured(angle_deg).directions_deg
    assert abs(first) < 10
    assert abs(abs(second) - 90) < 10


def test_across_is_that_of_the_flight():
    groups = [Bars(20, 20, angle, 6.0, 3, 24.0) for angle in (93.0, 4.0, 5.0)]
    assert common_normals(tuple(groups)) == pytest.approx((4.5, 93.0))
    assert common_normals(tuple(groups), "x") == pytest.approx((93.0, 4.5))


def mixture(mean, std, prior_std, share):
    """Mean and deviation of xy, and how likely it is not 0, of both by Bayes' rule."""
    normal = lambda x, s: math.exp(-0.5 * (x / s) ** 2) / s  # noqa: E731
    zero = (1 - share) * normal(mean, std) / normal(0.0, prior_std)
    turned = share / (share + zero)
    both = turned * mean
    return Estimate(both, math.sqrt(turned * std**2 + turned * (1 - turned) * mean**2)), turned


@pytest.mark.parametrize(("mean", "std"), [(0.01, 0.09), (0.05, 0.01), (0.004, 0.003)])
def test_it_is_the_mixture_of_both_by_their_likelihoods(mean, std):
    """Of xy and of what correlates with it."""
    root = np.diag([0.01, 0.02, std, 0.02, 0.01, 0.01, 0.01, 0.01])
    root[1, 2] = 0.5 * std
    beta = np.array([1.0, 0.02, mean, 0.0, 0.0, 0.0, 0.0, 0.0])
    turned = FittedOtf(MeanOtf(0.2, 0.0, 0.2), beta, root)
    found = aligned_or_turned(turned, 0.1)
    wanted, share = mixture(mean, std, 0.1, 0.2)
    assert found.beta[2] == pytest.approx(wanted.value)
    assert np.linalg.norm(found.beta_factor[2]) == pytest.approx(wanted.std)
    # xx keeps what it does not have in common with xy.
    assert found.beta[1] == pytest.approx(0.02 + 0.5 * (wanted.value - mean))
    assert np.linalg.norm(found.beta_factor[1]) == pytest.approx(math.hypot(0.02, 0.5 * wanted.std))
    assert 0 < share < 1


def solved_with_memory(image, groups):
    """The solution of stated groups, and how much memory it takes at most, bytes."""
    tracemalloc.start()
    found = solve_bars(image, groups, contrast=1000.0)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return found, most


def test_groups_of_a_large_image_take_the_memory_of_their_pixels():
    part = np.nan_to_num(two_sets(4.0), nan=200.0)
    image = np.full((1500, 1500), 200.0)
    image[700 : 700 + part.shape[0], 800 : 800 + part.shape[1]] = part
    groups = tuple(one.bars for one in measured(4.0).groups)
    alone, small = solved_with_memory(part, groups)
    found, large = solved_with_memory(image, tuple(one.shifted(700, 800) for one in groups))
    there = np.array([0.5]), np.array([0.0])
    assert found.otf.otf(*there) == pytest.approx(alone.otf.otf(*there), abs=1e-5)
    assert large - small < image.nbytes
