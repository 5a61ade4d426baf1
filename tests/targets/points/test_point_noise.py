"""Noise around point sources: which pixels are outliers of it."""

from __future__ import annotations

import numpy as np

from acutance.targets.points.noise import noise_around
from acutance.targets.points.stamps import cut_stamps


def test_outliers_of_bright_pixels_are_those_of_their_own_noise() -> None:
    """Twelve deviations of shot noise are too many, whatever share of the light the model may
    leave: both are in units of the noise there."""
    rng = np.random.default_rng(1)
    stamps = cut_stamps(np.zeros((21, 21)), np.array([[10.0, 10.0]]), 9.0)
    light = 2000 * np.exp(-(np.hypot(stamps.row - 10, stamps.col - 10) ** 2))
    std = np.sqrt(1 + 2 * light)
    residual = std * rng.standard_normal(std.size)
    brightest = int(np.argmax(light))
    residual[brightest] = 12 * std[brightest]
    found = noise_around(stamps, residual, light, 2.0, robust=True)
    assert found.outlier[brightest] < 0.02
    assert np.delete(found.outlier, brightest).min() > 0.5
