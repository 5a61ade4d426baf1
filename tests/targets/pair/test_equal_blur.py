"""Strong and weak structures: filters that keep edges blur them differently, sensors do not."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from pair_scenes import REFERENCE, SYSTEMS, rendered

import acutance as ac
from acutance.curves.grid import Floats
from acutance.simulate import PairGround
from acutance.targets import Check

FILTERED_SIGMAS = 3.0
REACH_PX = 3


def without_noise(image: Floats, noise: float) -> Floats:
    """The image behind a bilateral filter, which leaves what differs by three deviations."""
    height, width = image.shape
    wide = np.pad(image, REACH_PX, mode="edge")
    total, weights = np.zeros(image.shape), np.zeros(image.shape)
    for i in range(2 * REACH_PX + 1):
        for j in range(2 * REACH_PX + 1):
            near = wide[i : i + height, j : j + width]
            distance = np.hypot(i - REACH_PX, j - REACH_PX) / 1.5
            weight = np.exp(
                -0.5 * (distance**2 + ((near - image) / (FILTERED_SIGMAS * noise)) ** 2)
            )
            total += weight * near
            weights += weight
    return np.asarray(total / weights)


@cache
def asked(system: str, filtered: str, seed: int = 1) -> tuple[ac.BiresolutionMeasurement, Check]:
    low, high, _ = rendered(system, seed=seed)
    if filtered == "low":
        low = without_noise(low, 12.0)
    if filtered == "high":
        high = without_noise(high, 10.0)
    m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
    return m, equal_blur(m)


def equal_blur(m: ac.BiresolutionMeasurement) -> Check:
    return next(check for check in m.checks if check.name == "equal_blur")


@pytest.mark.parametrize("system", ["smeared", "halo", "diffraction"])
def test_filtered_low_image_is_named_and_wrong(system: str) -> None:
    m, check = asked(system, "low")
    true = rendered(system)[2].response().mtf(0.25).value
    found = m.across.mtf(0.25)
    assert abs(found.value - true) > 4 * found.std
    assert not check.passed
    assert m.verdict.warns
    assert "narrower" in check.message


def test_filtered_reference_is_named() -> None:
    _, check = asked("smeared", "high")
    assert not check.passed
    assert "wider" in check.message


def test_undisturbed_pairs_pass_and_scatter_as_stated() -> None:
    cases = [(system, seed) for system in ("smeared", "halo", "sharpened") for seed in (1, 2, 3, 4)]
    sigmas = np.array([asked(system, "none", seed)[1].value for system, seed in cases])
    assert np.all(sigmas < 3.5)
    assert 0.5 < np.sqrt(np.mean(sigmas**2)) < 1.6


def test_blur_of_borders_and_texture_apart() -> None:
    """Borders by a Gaussian of .4, texture by one of .6 px: narrower by .2 low pixels squared.

    Less is found, as the flanks of borders are weak, too.
    """
    parts = [
        ac.simulate.pair(
            SYSTEMS[system], REFERENCE, shape=(96, 96), ground=ground, snr=snr,
            dark=0.0, bright=contrast, rng=np.random.default_rng(5),
        )
        for system, ground, snr, contrast in (
            ("gaussian", PairGround(texture=0.0), 100.0, 1000.0),
            ("wide", PairGround(fields=0, texture=1.0), None, 60.0),
        )
    ]  # fmt: skip
    low, high = (sum(one[k] for one in parts) for k in (0, 1))
    m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
    check = equal_blur(m)
    assert not check.passed
    found = float(check.message.split("variance of ")[1].split(" ")[0])
    assert "narrower" in check.message
    assert 0.04 < found < 0.2


def test_too_few_pixels_are_no_answer() -> None:
    low, high, _ = rendered("smeared", shape=(28, 28), shift=(0.0, 0.0))
    check = equal_blur(ac.measure_biresolution(low, high, reference_mtf=REFERENCE))
    assert check.passed
    assert check.value == 0
    assert "too few" in check.message
