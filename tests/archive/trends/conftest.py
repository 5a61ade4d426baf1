"""Simulated series whose truth is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from acutance.archive.trends import Series

LEVEL = 0.16
START = 2021.0


@pytest.fixture
def series_of() -> Callable[..., Series]:
    """Makes a series; drift a year, step in the middle, season and scatters over the level."""

    def make(
        seed: int = 1, *, images: int = 40, years: float = 3.0, each: int = 1, drift: float = 0.0,
        step: float = 0.0, season: float = 0.0, scatter: float = 0.02, std: float = 0.01,
    ) -> Series:  # fmt: skip
        rng = np.random.default_rng(seed)
        when = np.sort(rng.uniform(0, years, images))
        truth = 1 + drift * (when - years / 2) + step * (when > years / 2)
        truth += season * np.cos(2 * np.pi * when) + scatter * rng.normal(size=images)
        image = np.repeat(np.arange(images), each)
        value = truth[image] + std * rng.normal(size=image.size)
        return Series(
            metric="mtf_nyquist", name="S1, pan, across", when=START + when[image],
            value=LEVEL * value, std=np.full(image.size, LEVEL * std), image=image,
            image_names={at: f"{at}.tif" for at in range(images)},
        )  # fmt: skip

    return make
