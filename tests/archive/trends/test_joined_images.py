"""More images than steps are sought among: neighbours in time are joined to places."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

from acutance.archive.specification import Requirement
from acutance.archive.specification_check import check_requirement
from acutance.archive.trends import Series, Trend, date_of, fit_trend
from acutance.archive.trends.images import (
    ImageMeans,
    image_means,
    joined_images,
    parts_of_places,
)

Make = Callable[..., Series]
PLACES = 200
LEVEL = 0.16


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


@pytest.mark.parametrize("images", [400, 1000])
def test_joined_images_scatter_beyond_what_is_stated_of_them(images: int) -> None:
    rng = np.random.default_rng(9)
    many = [places_of(1 + np.hypot(0.04, 0.03) * rng.normal(size=images), 0.03) for _ in range(20)]
    assert np.mean([one.scatter for one in many]) == pytest.approx(0.04, rel=0.05)
    # Deviations that are stated too large leave no scatter.
    assert places_of(1 + 0.02 * rng.normal(size=images), 0.03).scatter == 0


def test_joined_images_are_from_the_first_to_the_last_of_them(series_of: Make) -> None:
    """Places lie in the middle of theirs: a trend ended some days before its last image."""
    series = series_of(images=1000, years=10.0)
    trend = fit_trend(series)
    assert trend.images.are_joined
    assert trend.images.when[-1] < series.when.max() - 2 / 365
    days = date_of(series.when.min()), date_of(series.when.max())
    assert (trend.first, trend.last) == days
    assert f"{days[0]} to {days[1]})" in trend.summary()
    assert trend.at(trend.last).value == pytest.approx(trend.level.value, rel=1e-3)
    assert trend.crosses(0.1 * LEVEL).when[0] == series.when.max()
    document = json.loads(json.dumps(trend.to_dict()))
    ends = [document["bands"]["when"][at] for at in (0, -1)]
    assert ends == [series.when.min(), series.when.max()]
    kept = Trend.from_dict(document)
    assert (kept.first, kept.last) == days
    # Documents of earlier versions do not tell.
    del document["images"]["ends"]
    assert Trend.from_dict(document).last == date_of(float(trend.images.when[-1]))


def test_a_stated_deviation_counts_once_in_what_another_image_gives(series_of: Make) -> None:
    """Twice, the scatter between images was .072, and one more image 1 ± .094."""
    series = series_of(images=1000, scatter=0.04, std=0.06)
    trend = fit_trend(series)
    one = float(np.hypot(0.04, 0.06))
    assert trend.relative_scatter == pytest.approx(0.04, rel=0.2)
    assert trend.predict("2022-07-01").std / LEVEL == pytest.approx(one, rel=0.06)
    bands = trend.bands()
    low, high = (np.interp(series.when, bands.when, end) for end in bands.images95)
    assert 0.935 < np.mean((low < series.value) & (series.value < high)) < 0.97


def test_as_many_more_images_are_asked_for_as_their_whole_deviation_needs(series_of: Make) -> None:
    """The stated deviation counted twice: 1.7 times as many."""
    series = series_of(images=1000, scatter=0.04, std=0.06)
    limit = 0.9988 * LEVEL
    answer = check_requirement(Requirement(metric="mtf_nyquist", minimum=limit), series)
    assert answer.mean is not None
    wanted = (answer.mean.value - limit) / 1.645
    more = (LEVEL * np.hypot(0.04, 0.06)) ** 2 * (1 / wanted**2 - 1 / answer.mean.std**2)
    assert answer.more_images == pytest.approx(more, rel=0.15)
