"""Trends against simulated series: what is there is found, with deviations that hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance.archive.trends import Event, Series, date_of, decimal_year, fit_trend
from acutance.archive.trends.words import trend_text

Make = Callable[..., Series]


@pytest.mark.parametrize(("images", "draws"), [(7, 250), (14, 150)])
def test_deviations_of_rate_and_level_are_true_ones(
    series_of: Make, images: int, draws: int
) -> None:
    """A deviation 0.8 or 1.25 times the true one leaves these bounds."""
    rates, levels = [], []
    for seed in range(draws):
        trend = fit_trend(series_of(seed, images=images, drift=0.02, scatter=0.03))
        rate, level = trend.rate_per_year, trend.mean(2022.5, season=False).estimate()
        rates.append((rate.value - 0.16 * 0.02) / rate.std)
        levels.append((level.value - 0.16) / level.std)
    for found in (rates, levels):
        assert 0.84 < np.std(found) < 1.08
        if images > 7:
            assert np.std(found) / 0.8 > 1.08
            assert np.std(found) / 1.25 < 0.84
    assert abs(np.mean(levels)) < 0.2


def test_a_step_is_found_with_its_date_and_size(series_of: Make) -> None:
    trend = fit_trend(series_of(step=-0.12))
    (change,) = trend.changes
    assert abs((change.date - date_of(2022.5)).days) < 60
    assert change.since <= date_of(2022.5) <= change.until
    assert abs(change.size.value + 0.16 * 0.12) < 3 * change.size.std
    assert abs(change.relative_size.value + 0.12) < 3 * change.relative_size.std
    assert change.probability > 0.9
    assert trend.steady_probability < 0.01
    low, high = trend.rate.interval()
    assert low < 0 < high


def test_two_steps_are_two(series_of: Make) -> None:
    made = series_of(images=60)
    bump = (made.when > 2021.8) & (made.when < 2022.9)
    trend = fit_trend(replace(made, value=made.value + 0.025 * bump))
    assert [round(change.size.value, 2) > 0 for change in trend.changes] == [True, False]
    assert abs((trend.changes[0].date - date_of(2021.8)).days) < 60
    assert abs((trend.changes[1].date - date_of(2022.9)).days) < 60


def test_steady_and_drifting_series_have_no_step(series_of: Make) -> None:
    for drift in (0.0, 0.02):
        found = [fit_trend(series_of(seed, drift=drift)).changes for seed in range(6)]
        assert sum(map(len, found)) <= 1


def test_a_step_that_may_go_up_or_down_is_none_to_be_reported(series_of: Make) -> None:
    """Over many years small steps are probable beforehand, and no image excludes them."""
    trends = [fit_trend(series_of(seed, years=45.0, drift=-0.004, scatter=0.03))
              for seed in range(8)]  # fmt: skip
    probable = [trend for trend in trends if trend.step_probability >= 0.3]
    assert len(probable) > 3
    quiet = [trend for trend in probable if not trend.changes]
    assert len(quiet) >= len(probable) - 1
    assert all("cannot tell a drift from a step" in trend.summary() for trend in quiet)


def test_a_stated_event_is_a_step_without_a_search(series_of: Make) -> None:
    made = series_of(step=0.08)
    trend = fit_trend(made, [Event(date_of(2022.5), "refocus")])
    (effect,) = trend.events
    assert effect.name == "refocus"
    assert abs(effect.size.value - 0.16 * 0.08) < 3 * effect.size.std
    assert not trend.changes
    before, after = trend.at(date_of(2022.48)), trend.at(date_of(2022.52))
    assert after.value - before.value == pytest.approx(effect.size.value, abs=0.002)


def test_events_without_an_image_between_them_are_said_to_be_seen_together(
    series_of: Make,
) -> None:
    made = series_of(step=0.08)
    before, after = (made.when[(made.when > 2022.5) == one] for one in (False, True))
    apart = 0.4 * (after.min() - before.max())
    first, second = (Event(date_of(before.max() + apart * part), name)
                     for part, name in ((1.0, "heater"), (1.5, "focus")))  # fmt: skip
    assert first.year > before.max()
    trend = fit_trend(made, [first, second])
    (note,) = trend.notes
    assert note.startswith("No image lies between heater and focus: ")
    assert all(event.size.interval()[0] < 0.0 for event in trend.events)
    assert not fit_trend(made, [first]).notes
    assert not fit_trend(made, [first, Event(date_of(2023.5), "clock")]).notes


def test_an_event_may_change_the_drift(series_of: Make) -> None:
    made = series_of(scatter=0.005)
    turned = made.value - 0.16 * 0.05 * np.maximum(made.when - 2022.5, 0)
    trend = fit_trend(replace(made, value=turned), [Event(date_of(2022.5), "heater", True)])
    change = trend.events[0].drift_change_per_year
    assert change is not None
    assert abs(change.value + 0.16 * 0.05) < 3 * change.std
    assert abs(trend.relative_rate_per_year.value + 0.05) < 3 * trend.relative_rate_per_year.std


def test_a_season_is_found(series_of: Make) -> None:
    trend = fit_trend(series_of(season=0.05))
    assert trend.season_probability > 0.95
    assert abs(trend.season_amplitude.value - 0.16 * 0.05) < 3 * trend.season_amplitude.std
    assert "of which the level is free" in trend_text(trend)
    winter, summer = trend.at(date_of(2022.0)), trend.at(date_of(2022.5))
    assert winter.value - summer.value == pytest.approx(2 * 0.16 * 0.05, rel=0.4)
    assert fit_trend(series_of()).season_probability < 0.3


def test_a_line_off_the_level_by_a_season_that_is_hardly_there_is_explained(
    series_of: Make,
) -> None:
    words = "The level is without a season"
    trends = [fit_trend(series_of(seed, season=0.012)) for seed in range(6)]
    off = [abs(one.at(one.last).value - one.level.value) / one.level.std for one in trends]
    unlikely = [one.season_probability < 0.5 for one in trends]
    said = [words in trend_text(one) for one in trends]
    assert said == [a and b > 0.3 for a, b in zip(unlikely, off, strict=True)]
    assert True in said
    assert False in said


def test_one_bad_day_moves_nothing_and_is_named(series_of: Make) -> None:
    made = series_of(drift=0.02)
    spoiled = made.value.copy()
    spoiled[11] *= 2
    clean, trend = fit_trend(made), fit_trend(replace(made, value=spoiled))
    (day,) = trend.bad_days
    assert day.image == "11.tif"
    assert day.scales > 10
    assert day.date == date_of(made.when[11])
    assert trend.level.value == pytest.approx(clean.level.value, abs=clean.level.std)


def test_measurements_of_one_image_share_its_atmosphere(series_of: Make) -> None:
    one, many = (fit_trend(series_of(each=each, scatter=0.04)) for each in (1, 50))
    assert many.measurements == 50 * one.measurements
    assert many.rate_per_year.std > 0.6 * one.rate_per_year.std


def test_what_measurements_share_does_not_average_out(series_of: Make) -> None:
    made = series_of()
    shared = replace(made, systematic_std=np.full(made.size, 0.01))
    without, with_it = fit_trend(made), fit_trend(shared)
    assert with_it.level.std == pytest.approx(np.hypot(without.level.std, 0.01), rel=0.02)
    assert with_it.rate_per_year == without.rate_per_year
    assert with_it.predict("2024-01-01") == without.predict("2024-01-01")


def test_deviations_that_are_not_stated_are_left_to_the_scatter(series_of: Make) -> None:
    made = series_of(drift=0.02, std=0.001)
    silent = fit_trend(replace(made, std=np.full(made.size, np.nan)))
    stated = fit_trend(made)
    assert silent.rate_per_year.value == pytest.approx(stated.rate_per_year.value, rel=0.02)
    assert silent.rate_per_year.std == pytest.approx(stated.rate_per_year.std, rel=0.05)


def test_many_images_are_joined(series_of: Make) -> None:
    trend = fit_trend(series_of(images=2500, drift=0.02, scatter=0.04))
    assert trend.images.images == 2500
    assert abs(trend.relative_rate_per_year.value - 0.02) < 3 * trend.relative_rate_per_year.std
    assert trend.relative_rate_per_year.std < 0.002
    assert trend.predict("2022-07-01").std == pytest.approx(0.16 * 0.042, rel=0.1)


def test_the_same_data_give_the_same_trend(series_of: Make) -> None:
    made = series_of(drift=0.01)
    order = np.random.default_rng(0).permutation(made.size)
    turned = replace(
        made, when=made.when[order], value=made.value[order], std=made.std[order],
        image=made.image[order],
    )  # fmt: skip
    assert fit_trend(made) == fit_trend(made)
    assert fit_trend(turned).rate_per_year.value == pytest.approx(
        fit_trend(made).rate_per_year.value
    )


def test_few_images_are_answered_widely(series_of: Make) -> None:
    trend = fit_trend(series_of(images=3))
    assert trend.level.std > 0.002
    assert "Steps are sought from 8 images on" in trend.summary()


def test_what_has_no_trend_is_refused(series_of: Make) -> None:
    made = series_of(images=6)
    with pytest.raises(ac.OptionError, match="none of 6 measurements has a date"):
        fit_trend(replace(made, when=np.full(6, np.nan)))
    with pytest.raises(
        ac.OptionError, match=r"all 6 images are of 2022-01-01.*acutance archive table"
    ):
        fit_trend(replace(made, when=np.full(6, 2022.0)))
    with pytest.raises(ac.OptionError, match="2 images have dates, a trend needs 3"):
        fit_trend(made.of(np.arange(6) < 2))
    undated = replace(made, when=np.where(np.arange(6) == 2, np.nan, made.when))
    assert "1 measurement without a date is left out." in fit_trend(undated).notes


def test_a_changed_gsd_is_an_event_in_pixels_and_none_in_metres(series_of: Make) -> None:
    made = series_of(step=-0.1, scatter=0.01)
    gsd_m = np.where(made.when > 2022.5, 0.63, 0.7)
    pixels = replace(made, metric="fwhm_px", gsd_m=gsd_m)
    trend = fit_trend(pixels)
    assert trend.events[0].name == "GSD 0.7 to 0.63 m"
    assert not trend.changes
    assert any("in metres (fwhm_m) there is none" in note for note in trend.notes)
    metres = fit_trend(replace(pixels, metric="fwhm_m", value=1 / made.value))
    assert not metres.events
    assert len(metres.changes) == 1


@pytest.mark.parametrize("days", [0.002, 1.0, 3.0])
def test_a_gsd_changes_between_its_images_however_near_they_are(days: float) -> None:
    """The middle of two images cut to its day lies before the first of them."""
    months = [decimal_year(f"2023-{month:02d}-01T10:00:00Z") for month in range(1, 11)]
    when = np.insert(months, 5, months[4] + days / 365)
    is_new = when > months[4]
    scatter = 0.005 * np.random.default_rng(0).normal(size=when.size)
    trend = fit_trend(Series(
        metric="fwhm_px", when=when, value=np.where(is_new, 1.2, 1.4) + scatter,
        std=np.full(when.size, 0.005), image=np.arange(when.size),
        gsd_m=np.where(is_new, 1.2, 1.0),
    ))  # fmt: skip
    (event,) = trend.events
    assert event.size.value == pytest.approx(-0.2, abs=3 * event.size.std)
    assert event.size.std < 0.01
    assert not trend.changes
    assert not trend.bad_days


def test_decimal_years_and_days_agree() -> None:
    assert decimal_year("2023-01-01") == 2023.0
    assert decimal_year("2023-07-02T12:00:00Z") == pytest.approx(2023.5)
    for day in ("2020-02-29", "2023-12-31", "2024-01-01"):
        assert date_of(decimal_year(day)).isoformat() == day
