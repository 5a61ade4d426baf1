"""More images than steps are sought among: neighbours in time are joined to places."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.archive.trends import Series
from acutance.archive.trends.images import (
    ImageMeans,
    image_means,
    joined_images,
    parts_of_places,
)

PLACES = 200


def places_of(value: np.ndarray, std: float = 0.0) -> ImageMeans:
    """Images of one measurement each, joined."""
    when = np.linspace(2010.0, 2020.0, value.size)
    series = Series(metric="rer", when=when, value=value, std=np.full(value.size, std),
                    image=np.arange(value.size))  # fmt: skip
    return joined_images(image_means(series), PLACES)


def scale_of(places: ImageMeans) -> float:
    """Of single images, by which the deviations of the places are stated."""
    size = np.array([part.size for part in parts_of_places(places.images, PLACES)])
    return float(np.sqrt(np.median(places.variance * size)))


@pytest.mark.parametrize("images", [300, 500, 600, 800, 1000, 2000])
def test_the_scale_of_joined_images_is_that_of_the_images(images: int) -> None:
    """About the median of three one deviation is 0: the scale was .55 of the truth."""
    rng = np.random.default_rng(7)
    joined = [places_of(1 + 0.05 * rng.normal(size=images)) for _ in range(20)]
    assert np.mean([scale_of(one) for one in joined]) == pytest.approx(0.05, rel=0.03)
    off = np.sqrt([np.mean((one.value - 1) ** 2) / np.mean(one.variance) for one in joined])
    assert off.mean() == pytest.approx(1, abs=0.06)


@pytest.mark.parametrize("images", [600, 1000, 2000])
def test_far_images_widen_the_scale_little(images: int) -> None:
    rng = np.random.default_rng(8)
    scales = []
    for _ in range(20):
        value = 1 + 0.05 * rng.normal(size=images)
        value[rng.random(images) < 0.03] += 0.4
        scales.append(scale_of(places_of(value)))
    assert 0.98 < np.mean(scales) / 0.05 < 1.11
