"""What a trend answers: dates, bands, limits, documents, sentences."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance.archive.trends import Event, Series, Trend, date_of, decimal_year, fit_trend
from acutance.archive.trends.crossing import Crossing
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.scatter import with_scatter

Make = Callable[..., Series]


@pytest.fixture(scope="module")
def falling() -> Trend:
    rng = np.random.default_rng(4)
    when = np.sort(rng.uniform(2020, 2024, 50))
    value = 0.20 - 0.01 * (when - 2020) + 0.002 * rng.normal(size=50)
    series = Series(
        metric="mtf_nyquist", name="S1", when=when, value=value, std=np.full(50, 0.001),
        image=np.arange(50),
    )  # fmt: skip
    return fit_trend(series, [Event("2022-03-01", "new processor")])


def test_it_goes_through_json_and_processes_unchanged(falling: Trend) -> None:
    text = json.dumps(falling.to_dict(), allow_nan=False)
    back = Trend.from_dict(json.loads(text))
    assert back == falling
    assert back.to_dict() == falling.to_dict()
    assert pickle.loads(pickle.dumps(falling)) == falling
    with pytest.raises(ac.OptionError, match="this is no document acutance/trend/1"):
        Trend.from_dict({"schema": "other"})


def test_the_limit_is_passed_when_the_line_passes_it(falling: Trend) -> None:
    crossing = falling.crosses(0.15)
    early, late = crossing.interval
    assert crossing.falls
    assert crossing.median is not None
    assert early is not None
    assert abs(decimal_year(crossing.median) - 2025.0) < 0.7
    assert early < crossing.median < (late or date_of(2044))
    assert (np.diff(crossing.probability) >= 0).all()
    assert "falls below 0.15 about 202" in crossing.summary()
    assert late is not None
    days = f"about {crossing.median} (95 %: {early} to {late}), if the drift goes on"
    assert crossing.summary() == f"falls below 0.15 {days}"
    json.dumps(crossing.to_dict(), allow_nan=False)


def test_a_limit_that_may_never_be_passed_says_so_beside_the_earliest_day() -> None:
    when = 2024.0 + np.arange(241) / 12
    may = Crossing(0.2, True, when, np.linspace(0.0, 0.6, when.size))
    early, late = may.interval
    assert late is None
    assert may.summary() == (
        f"falls below 0.2 about {may.median} (95 %: {early} or later; perhaps not within 20 "
        "years), if the drift goes on"
    )


def test_a_limit_that_is_passed_or_far_is_told(falling: Trend) -> None:
    assert "falls below 0.17 already" in falling.crosses(0.17).summary()
    assert falling.crosses(0.17).median == falling.last
    upward = falling.crosses(0.3, is_minimum=False)
    assert upward.median is None
    assert "does not rise above 0.3 within 20 years, with a probability of" in upward.summary()
    with pytest.raises(ac.OptionError, match="the limit is nan"):
        falling.crosses(float("nan"))
    for years in (float("inf"), 1e5, 0.0):
        with pytest.raises(ac.OptionError, match="a time above 0 and up to 1000"):
            falling.crosses(0.1, within_years=years)


def test_bands_agree_with_single_dates(falling: Trend) -> None:
    bands = falling.bands(np.array([2021.0, 2023.0]))
    for at, year in enumerate(bands.when):
        low, high = falling.at(date_of(year)).interval()
        assert bands.band95[0][at] == pytest.approx(low, abs=2e-5)
        assert bands.band95[1][at] == pytest.approx(high, abs=2e-5)
        low, high = falling.predict(date_of(year)).interval()
        assert bands.images95[0][at] == pytest.approx(low, abs=1e-4)
    assert (bands.band50[0] > bands.band95[0]).all()
    assert (bands.images95[1] > bands.band95[1]).all()


def test_the_future_is_less_certain(falling: Trend) -> None:
    assert falling.at("2030-01-01").std > 2 * falling.level.std


def test_the_sentence_names_what_was_found(falling: Trend, series_of: Make) -> None:
    assert "It falls by" in falling.summary()
    assert "new processor (2022-03-01)" in falling.summary()
    assert "S1" in repr(falling)
    assert "A step of -" in fit_trend(series_of(step=-0.12)).summary()
    assert "No drift is found" in fit_trend(series_of(3)).summary()


def test_mixtures_have_the_quantiles_of_their_sum() -> None:
    mixture = NormalMixture(np.array([0.3, 0.7]), np.array([0.0, 1.0]), np.array([0.5, 0.2]))
    for level in (0.01, 0.5, 0.9):
        assert mixture.probability_below(mixture.quantile(level)) == pytest.approx(level, abs=1e-9)
    normal = NormalMixture(np.ones(1), np.array([2.0]), np.array([0.3]))
    assert normal.estimate().value == pytest.approx(2.0)
    assert normal.estimate().std == pytest.approx(0.3)
    assert normal.times(-2).estimate().std == pytest.approx(0.6)


def test_scatter_has_the_tails_of_student() -> None:
    sharp = NormalMixture(np.ones(1), np.zeros(1), np.full(1, 1e-9))
    found = with_scatter(sharp, np.ones(1), np.array([3.0]))
    assert found.quantile(0.975) == pytest.approx(3.18, rel=0.05)
    assert found.quantile(0.75) == pytest.approx(0.765, rel=0.05)


@pytest.mark.parametrize(
    ("lacks", "advice"),
    [("value", "has a value: choose another metric; numbers on the ground need the GSD"),
     ("when", "has a date and a value: state when the images were acquired")],
)  # fmt: skip
def test_what_measurements_lack_is_what_is_asked_for(
    series_of: Make, lacks: str, advice: str
) -> None:
    whole = series_of(images=5)
    without = replace(whole, **{lacks: np.full(5, np.nan)})
    with pytest.raises(ac.OptionError, match=f"none of 5 measurements {advice}$"):
        fit_trend(without)
