"""Regions of a pair: their blur, and how far it scatters."""

from __future__ import annotations

import numpy as np
from pair_scenes import REFERENCE, SYSTEMS

import acutance as ac
from acutance.simulate import Noise


def test_noise_of_the_reference_does_not_blur_regions() -> None:
    """Their blur is the common one: noise makes the slopes of a regression too small."""
    low, high, _ = ac.simulate.pair(
        SYSTEMS["gaussian"], REFERENCE, ratio=3, shape=(64, 64),
        noise_low=Noise(5.0), noise_high=Noise(150.0), rng=np.random.default_rng(3),
    )  # fmt: skip
    options = ac.BiresolutionOptions(noise_high=150.0)
    m = ac.measure_biresolution(low, high, ratio=3, reference_mtf=REFERENCE, options=options)
    blur = np.stack([m.local.variance_down_px2, m.local.variance_across_px2])
    std = float(np.mean(m.local.variance_std_px2)) / np.sqrt(0.5 * blur.size)
    assert np.all(np.abs(blur.mean(axis=(1, 2))) < 3 * std)
