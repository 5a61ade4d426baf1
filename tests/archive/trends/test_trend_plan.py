"""Planned watches over a sensor: bounds, what trends state of simulated images, answers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from acutance.archive.trends import Series, TrendPlanOptions, fit_trend, plan_trend
from acutance.errors import OptionError

THEORY = TrendPlanOptions(images_per_year=(12.0, 48.0), years=(4.0, 2.0), draws=0)


def test_the_bound_is_that_of_a_straight_line_through_scattered_images() -> None:
    plan = plan_trend(THEORY)
    rng = np.random.default_rng(1)
    for watch in plan.designs:
        slopes = []
        for _ in range(800):
            years = rng.uniform(0, watch.years, watch.images)
            value = rng.normal(0, math.hypot(THEORY.scatter, THEORY.std), watch.images)
            slopes.append(np.polyfit(years, value, 1)[0])
        assert watch.bound == pytest.approx(np.std(slopes), rel=0.1)


def test_designs_are_paces_with_rising_times_and_four_times_the_images_halve_the_bound() -> None:
    plan = plan_trend(THEORY)
    assert [(one.images_per_year, one.years) for one in plan.designs] == [
        (12, 2), (12, 4), (48, 2), (48, 4),
    ]  # fmt: skip
    few, many = plan.of_pace(12.0)[1], plan.of_pace(48.0)[1]
    assert many.bound == pytest.approx(few.bound / 2)
    assert many.noticed > few.noticed
    assert few.least_drift == pytest.approx(2.8016 * few.bound, rel=1e-4)


def test_images_that_are_there_already_shorten_the_watch() -> None:
    earlier = tuple(np.linspace(0, 3, 36).tolist())
    alone = plan_trend(THEORY).of_pace(12.0)[0]
    after = plan_trend(replace(THEORY, earlier=earlier)).of_pace(12.0)[0]
    assert after.images == alone.images + 36
    # As 5 years of the pace.
    assert after.bound == pytest.approx(alone.bound * (2 / 5) ** 1.5, rel=0.1)


def test_trends_of_simulated_images_state_what_the_plan_says() -> None:
    options = TrendPlanOptions(
        images_per_year=(12.0,), years=(3.0,), scatter=0.02, std=0.01, drift_per_year=-0.05,
        draws=20,
    )  # fmt: skip
    (watch,) = plan_trend(options, workers=1).designs
    # Trends allow for steps and tails, and know a little of the drift beforehand.
    assert 0.9 * watch.bound < watch.std < 1.5 * watch.bound
    assert watch.noticed == 1.0
    few = replace(options, years=(1.0,), draws=10)
    assert plan_trend(few, workers=1).designs == plan_trend(few, workers=1).designs
    steady = replace(options, drift_per_year=1e-6)
    assert plan_trend(steady, workers=1).designs[0].noticed <= 0.15


@pytest.mark.parametrize("drift_per_year", [0.041, -0.041, 0.06])
def test_the_least_drift_agrees_with_how_often_the_planned_one_is_noticed(
    drift_per_year: float,
) -> None:
    """2.8 median deviations were the least before, and noticed in 64 to 74 % of the cases."""
    options = TrendPlanOptions(
        images_per_year=(6.0,), years=(3.0,), drift_per_year=drift_per_year, draws=40
    )
    (watch,) = plan_trend(options, workers=1).designs
    assert (watch.least_drift <= abs(drift_per_year)) is (watch.noticed >= 0.8)
    assert 2.8 * watch.bound < watch.least_drift < 5 * watch.bound


def test_the_time_needed_is_between_the_planned_ones() -> None:
    plan = plan_trend(replace(THEORY, years=(1.0, 2.0, 3.0, 4.0, 5.0)))
    needed = plan.years_needed(48.0)
    first = next(one.years for one in plan.of_pace(48.0) if one.noticed >= 0.8)
    assert first - 1 < needed <= first
    exact = plan_trend(replace(THEORY, images_per_year=(48.0,), years=(needed,)))
    assert exact.designs[0].noticed == pytest.approx(0.8, abs=0.02)
    assert math.isnan(plan.years_needed(12.0))
    assert plan_trend(replace(THEORY, drift_per_year=0.5)).years_needed(12.0) == 2.0
    document = plan.to_dict()
    assert document["years_needed"] == {"12": None, "48": pytest.approx(needed)}
    assert document["designs"][0]["std"] is None


def test_an_archive_tells_scatter_deviation_pace_and_images(
    series_of: Callable[..., Series],
) -> None:
    trend = fit_trend(series_of(images=37, years=3.0, scatter=0.03, std=0.01))
    options = TrendPlanOptions.of_trend(trend, drift_per_year=0.02)
    assert options.drift_per_year == 0.02
    assert options.images_per_year[0] == pytest.approx(12, rel=0.1)
    assert options.scatter == pytest.approx(0.03, rel=0.4)
    assert options.std == pytest.approx(0.01, rel=0.1)
    assert len(options.earlier) == 37
    assert min(options.earlier) == 0


def test_every_image_of_a_joined_trend_counts_in_a_plan(
    series_of: Callable[..., Series],
) -> None:
    """Places counted as an image each: 200 of 2100, with the deviation of a place."""
    series = series_of(images=2100, years=10.0, scatter=0.06, std=0.03)
    options = TrendPlanOptions.of_trend(fit_trend(series), draws=0, years=(2.0,))
    assert len(options.earlier) == 2100
    assert options.scatter == pytest.approx(0.06, rel=0.1)
    assert options.std == pytest.approx(0.03, rel=0.01)
    (watch,) = plan_trend(options).designs
    new = watch.images - 2100
    years = np.append(series.when - series.when.max(), np.linspace(0, 2, new))
    exact = math.hypot(0.06, 0.03) / (np.std(years) * math.sqrt(years.size))
    assert watch.bound == pytest.approx(exact, rel=0.08)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"images_per_year": ()}, "images_per_year is none"),
        ({"years": (0.0,)}, "years is 0: give numbers from 0.1 to 50"),
        ({"scatter": 4.0}, r"scatter is 4: it is a share of the level, 0 to 1 \(2 % is .02\)"),
        ({"scatter": 0.0, "std": 0.0}, "both 0"),
        ({"drift_per_year": 0.0}, "drift_per_year is 0"),
        ({"draws": 3}, "draws is 3: give 10 or more"),
        ({"seed": -1}, "seed is -1"),
        ({"earlier": (-1.0,)}, "earlier is -1"),
        ({"std": math.nan}, "std has to be a number"),
    ],
)
def test_options_that_mean_nothing_are_refused(wrong: dict[str, object], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        replace(THEORY, **wrong)  # type: ignore[arg-type]


def test_too_few_and_too_many_images_are_refused() -> None:
    with pytest.raises(OptionError, match="a pace of 1 a year over 2 years gives 2 images"):
        plan_trend(replace(THEORY, images_per_year=(1.0,)))
    with pytest.raises(OptionError, match="gives 1 image, with 1 that there are already"):
        plan_trend(replace(THEORY, images_per_year=(0.5,), years=(2.0,), earlier=(0.0,)))
    with pytest.raises(OptionError, match="up to 2000 are planned"):
        plan_trend(replace(THEORY, images_per_year=(366.0,), years=(10.0,)))


def test_a_trend_whose_level_may_be_zero_has_no_shares(series_of: Callable[..., Series]) -> None:
    series = series_of()
    trend = fit_trend(replace(series, value=series.value - series.value.mean()))
    with pytest.raises(OptionError, match="may be 0"):
        TrendPlanOptions.of_trend(trend)
