"""Pages of archives: the answer first, the numbers those of the archive, nothing overlaps."""

from __future__ import annotations

import html
import re
import tomllib
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from importlib import import_module
from itertools import pairwise, product

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Archive, Entry, ImageEntry, TargetEntry
from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.published import published_entries
from acutance.archive.specification import Specification
from acutance.archive.trends import Event, Series, date_of, fit_trend
from acutance.errors import NothingSelectedError, OptionError
from acutance.report.archive import sensor_page, trend_figure, trend_page
from acutance.report.archive.sensor_state import SeriesState, states_of
from acutance.report.archive.sensor_tables import (
    images_table,
    rejected_table,
    specification_table,
    state_table,
)
from acutance.report.archive.trend_figure import are_bad
from acutance.report.archive.trend_page import trend_plate, trend_verdict
from acutance.report.archive.wording import percent, signed, with_minus
from acutance.report.labels import MISSING, word_estimate
from acutance.targets import Rejected

BEGIN = datetime(2024, 1, 10, 10, tzinfo=UTC)
REFOCUS = Event("2025-01-01", "refocus")
SPEC = """
[[requirement]]
name = "across track"
metric = "mtf_nyquist"
minimum = 0.2
orientation = "across"

[[requirement]]
name = "sharp"
metric = "mtf_nyquist"
minimum = 0.9
"""


def series_of(count=40, step=-0.05, rate=-0.02, seed=1, outlier=None):
    """A level of 0.3 that drifts, with a step in the middle of three years."""
    rng = np.random.default_rng(seed)
    when = 2023 + np.sort(3 * rng.random(count))
    value = 0.3 * (1 + rate * (when - 2023) + step * (when > 2024.5))
    value += 0.3 * 0.01 * rng.standard_normal(count)
    if outlier is not None:
        value[count // 2] = outlier
    return Series(
        metric="mtf_nyquist", when=when, value=value, std=np.full(count, 0.001),
        image=np.arange(count), name="QB02, pan, across",
    )  # fmt: skip


@pytest.fixture(scope="module")
def edge_record():
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)
    pixels, _ = ac.simulate.edge(
        sensor, angle_deg=6.0, shape=(60, 44), snr=100, rng=np.random.default_rng(3)
    )
    return ac.measure_edge(pixels, gsd_m=0.7).record


@pytest.fixture(scope="module")
def archive(tmp_path_factory, edge_record):
    """Twelve images of two targets that lose 10 % a year, and a cloud."""
    place = tmp_path_factory.mktemp("archive") / "campaign.db"
    rng = np.random.default_rng(1)
    with Archive(place) as made:
        for at in range(24):
            day = BEGIN + timedelta(days=30 * (at // 2))
            value = 0.3 * (1 - 0.1 * (at // 2) / 12) + 0.002 * rng.standard_normal()
            number = {**edge_record.document["mtf_nyquist"], "value": value, "std": 0.002}
            image = ImageEntry(path=f"{at // 2:02d}.tif", sensor="QB02", acquired=day)
            target = TargetEntry(name=f"tarp {at % 2}", kind="edge")
            record = ac.Record({**edge_record.document, "mtf_nyquist": number})
            made.add_entries([Entry(record=record, image=image, target=target, band="pan")])
        cloud = Rejected("find", "a cloud <b> lies on it", {})
        made.add_entries([Entry(rejected=cloud, image=image, target=target, band="pan")])
        yield made


def words_of(page):
    return html.unescape(page)


def test_the_page_of_a_trend_begins_with_what_has_changed():
    page = words_of(trend_page(fit_trend(series_of()), limit=0.2))
    assert page.index("changed by −5") < page.index("Numbers") < page.index("<h2>Images")
    assert "falls by" in page
    assert "<b>limit</b>" in page
    still = words_of(trend_page(fit_trend(series_of(step=0.0, rate=0.0))))
    assert "no change is found" in still
    assert '<div class="verdict good">' in still


@pytest.mark.usefixtures("undrawn")
@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("count", "sought"), [(5, "drift"), (12, "change")])
def test_no_change_is_no_good_news_where_little_could_be_found(count, sought):
    series = series_of(count=count, rate=0.0, step=0.0)
    # Seven weeks show no drift of a few per cent a year.
    short = replace(series, when=2024 + (series.when - 2023) / 22)
    trend = fit_trend(short)
    found = trend_verdict(trend)
    assert found.word == "usable"
    assert f"no {sought} is found" in found.text
    page = words_of(trend_page(trend))
    unsought = f"not sought ({count} images; from 8 on)"
    assert (unsought in page) == (("steps", f"{unsought}.") in found.details) == (count < 8)
    assert ("probability of no step" in page) == trend.steps_are_sought == (count >= 8)


@pytest.mark.usefixtures("undrawn")
def test_steps_that_are_not_sought_have_no_probability_in_the_state(edge_record, tmp_path):
    with Archive(tmp_path / "few.db") as few:
        for at in range(4):
            image = ImageEntry(
                path=f"{at}.tif", sensor="QB02", acquired=BEGIN + timedelta(days=16 * at)
            )
            few.add_entries([Entry(record=edge_record, image=image)])
        page = words_of(sensor_page(few, "QB02"))
    assert "not sought (4 images; from 8 on)" in page
    assert "none found" not in page


@pytest.mark.usefixtures("undrawn")
def test_a_level_without_its_season_says_so():
    series = series_of(rate=0.0, step=0.0)
    seasonal = replace(series, value=series.value + 0.02 * np.cos(2 * np.pi * series.when))
    details = trend_verdict(fit_trend(seasonal)).details
    assert any("of which the level is free" in text for _, text in details)
    assert all("season" not in name for name, _ in trend_verdict(fit_trend(series)).details)


def test_a_bad_day_is_marked_and_does_not_flatten_the_drawing():
    trend = fit_trend(series_of(outlier=3.0))
    axes = trend_figure(trend).axes[0]
    low, high = axes.get_ylim()
    assert 0.2 < low < high < 0.4
    assert [one for one in axes.get_lines() if one.get_marker() == "^"]
    assert '<tr class="alert">' in trend_page(trend)


@pytest.mark.usefixtures("undrawn")
def test_an_image_with_the_value_of_a_bad_day_on_another_day_is_not_marked():
    series = series_of(count=60, rate=-0.04, step=0.0)
    value = np.round(series.value, 2)
    value[8] = value[-1]
    trend = fit_trend(replace(series, value=value))
    assert [day.date for day in trend.bad_days] == [date_of(series.when[8])]
    assert np.flatnonzero(are_bad(trend)).tolist() == [8]
    assert trend_page(trend).count('<tr class="alert">') == 1


def test_steps_events_and_limits_are_drawn_where_they_are():
    trend = fit_trend(series_of(), [REFOCUS])
    axes = trend_figure(trend, limit=0.25).axes[0]
    texts = [one.get_text().strip() for one in axes.texts]
    assert "refocus" in texts
    assert "limit 0.25" in texts
    assert any(text.startswith(("step -5", "step −5")) for text in texts)
    levels = [one.get_ydata()[0] for one in axes.get_lines() if one.get_linestyle() == "--"]
    assert 0.25 in levels


@pytest.mark.parametrize(("years", "beside"), [(3.0, ""), (0.5, "2023"), (0.01, "2023-Mar")])
def test_a_drawing_has_the_year_of_its_images(years, beside):
    """From spring to autumn no tick is a January, which has the year."""
    series = series_of()
    short = replace(series, when=2023.17 + years * (series.when - 2023) / 3)
    figure = trend_figure(fit_trend(short))
    figure.draw_without_rendering()
    axis = figure.axes[0].xaxis
    assert axis.get_offset_text().get_text() == beside
    assert axis.get_offset_text().get_window_extent().y0 >= 0


def test_names_of_events_stay_in_the_drawing_and_apart():
    long = "cold restart of the focal plane, its heaters and everything else that was on that day"
    events = [Event("2023-09-01", long), Event("2024-05-01", "heater"),
              Event("2024-05-04", "focus"), Event("2024-05-08", "clock")]  # fmt: skip
    figure = trend_figure(fit_trend(series_of(), events))
    figure.draw_without_rendering()
    axes = figure.axes[0]
    labels = [one for one in axes.texts if one.get_rotation() == 90]
    assert [one.get_text().strip()[:12] for one in labels] == ["cold restart", "heater, focu"]
    boxes = [one.get_window_extent() for one in labels]
    assert boxes[0].x1 < boxes[1].x0
    assert all(axes.bbox.y0 < box.y0 < box.y1 < axes.bbox.y1 for box in boxes)
    # Two of them lie between the same two images.
    assert len([one for one in axes.get_lines() if one.get_linestyle() == "-."]) == len(events)


def test_an_event_without_images_on_both_sides_is_a_note_and_nothing_drawn():
    """Far from the axis its name left no room for the drawing."""
    events = [Event("1990-01-01", "launch"), Event("2060-01-01", "end", changes_drift=True)]
    trend = fit_trend(series_of(), [*events, REFOCUS])
    assert [event.name for event in trend.events] == ["refocus"]
    assert "No image shows what launch, end did" in trend.summary()
    assert "launch (1990-01-01)" not in trend.summary()
    axes = trend_figure(trend).axes[0]
    assert [one.get_text().strip() for one in axes.texts if one.get_rotation() == 90] == ["refocus"]


def test_limits_are_labelled_beside_the_axes_and_far_ones_do_not_stretch_them():
    trend = fit_trend(series_of())
    own = trend_figure(trend).axes[0].get_ylim()
    figure = trend_figure(trend, limit=(0.27, 0.09, 0.271, 0.8, 0.27))
    figure.draw_without_rendering()
    axes = figure.axes[0]
    assert axes.get_ylim() == own
    levels = [one.get_ydata()[0] for one in axes.get_lines() if one.get_linestyle() == "--"]
    assert levels == [0.27, 0.271]
    labels = [one for one in axes.texts if "limit" in one.get_text()]
    assert [one.get_text().strip() for one in labels] == [
        "↓ limit 0.09", "limit 0.27", "limit 0.271", "↑ limit 0.8",
    ]  # fmt: skip
    boxes = [one.get_window_extent() for one in labels]
    assert all(low.y1 <= high.y0 for low, high in pairwise(boxes))
    legend = axes.get_legend().get_window_extent()
    for box in boxes:
        assert axes.bbox.x1 <= box.x0
        assert box.x1 < legend.x0
    assert axes.bbox.y0 - 10 < boxes[0].y0 < boxes[-1].y1 < axes.bbox.y1 + 10


def test_many_limits_at_the_upper_end_come_down_without_touching():
    trend = fit_trend(series_of())
    figure = trend_figure(trend, limit=(0.7, 0.8, 0.9))
    figure.draw_without_rendering()
    boxes = [one.get_window_extent() for one in figure.axes[0].texts if "↑" in one.get_text()]
    assert len(boxes) == 3
    assert all(low.y1 <= high.y0 for low, high in pairwise(boxes))


@pytest.mark.usefixtures("undrawn")
def test_the_page_of_a_sensor_has_its_state_changes_and_images(archive):
    seen: list[tuple[int, int]] = []
    page = words_of(sensor_page(archive, "QB02", progress=lambda *done: seen.append(done)))
    assert seen == [(0, 1)]
    trend = archive.trend("mtf_nyquist", sensor="QB02", verdict="usable")
    assert f"{trend.level.value:.4f}" in page
    assert "falls by" in page
    assert page.index("falls by") < page.index("Through time")
    assert page.count(".tif</td>") == 12
    assert "a cloud <b> lies on it" in page
    assert "a cloud <b> lies" not in sensor_page(archive, "QB02")
    assert "tarp 0" in page
    assert "By target, across" in page


@pytest.mark.usefixtures("undrawn")
def test_all_limits_of_the_metric_that_apply_to_the_sensor_are_drawn(
    archive, tmp_path, monkeypatch
):
    place = tmp_path / "two.toml"
    other = '[[requirement]]\nmetric = "rer"\nminimum = 0.5\n'
    place.write_text(SPEC + other, encoding="utf-8")
    drawn = []

    def plate(trend, limit):
        drawn.append((trend.metric, limit))
        return trend_plate(trend, limit)

    # The package's own name for the module is that of its function.
    module = import_module("acutance.report.archive.sensor_page")
    monkeypatch.setattr(module, "trend_plate", plate)
    sensor_page(archive, "QB02", specification=place)
    assert drawn == [("mtf_nyquist", [0.2, 0.9])]


@pytest.mark.usefixtures("undrawn")
def test_every_number_of_the_state_has_its_own_drift(archive):
    """Drift and changes of a width stood beside the MTF alone."""
    rows = archive.measurements(sensor="QB02", verdict="usable")
    states = states_of(rows, "QB02", "fwhm_m", [REFOCUS])
    table = state_table(states)
    assert table.columns[4:6] == ("FWHM on the ground [m]", "MTF at Nyquist")
    assert table.columns[-1] == "Changes of FWHM on the ground"
    (row,) = table.rows
    for at, metric in ((4, "fwhm_m"), (5, "mtf_nyquist")):
        level, drift = row[at].splitlines()
        trend = archive.trend(
            metric, sensor="QB02", orientation="across", verdict="usable", events=[REFOCUS]
        )
        assert level == word_estimate(trend.level).value_and_std
        assert drift == f"{percent(trend.relative_rate_per_year)} a year"
    assert row[-1].splitlines() == ["none found (1.00)", "2025-01-01 refocus: no image shows it"]
    page = words_of(sensor_page(archive, "QB02", metric="fwhm_m"))
    assert "below it the drift of that number" in page


@pytest.mark.usefixtures("undrawn")
def test_across_and_along_are_compared_at_the_top(tmp_path, edge_record):
    rng = np.random.default_rng(2)
    with Archive(tmp_path / "both.db") as made:
        for at in range(24):
            number = dict(edge_record.document["mtf_nyquist"])
            number["value"] = 0.3 + 0.03 * (at % 2) + 0.001 * rng.standard_normal()
            direction = "across" if at % 2 else "along"
            shown = {"orientation": direction, "measured_directions": [direction], "budget": []}
            document = {**edge_record.document, "mtf_nyquist": number, **shown}
            day = BEGIN + timedelta(days=30 * (at // 2))
            image = ImageEntry(path=f"{at // 2:02d}.tif", sensor="QB02", acquired=day)
            target = TargetEntry(name=direction, kind="edge")
            made.add_entries([Entry(record=ac.Record(document), image=image, target=target)])
        page = words_of(sensor_page(made, "QB02"))
        answer = made.compare("mtf_nyquist").differences[0]
    assert answer.sentence.removeprefix("QB02: ") in page
    assert "across is sharper than along by 9." in page
    assert page.index("across is sharper") < page.index("Through time")
    assert "across − along" in page
    assert "One target of each group" in page
    assert "First minus second" in page


@pytest.mark.usefixtures("undrawn")
def test_sentences_and_tables_have_one_sign(tmp_path, edge_record):
    """The larger one came first in the sentence, the first one in the table."""
    with Archive(tmp_path / "both.db") as made:
        for at in range(24):
            number = {**edge_record.document["mtf_nyquist"], "value": 0.3 + 0.001 * (at % 5)}
            direction = "along" if at % 2 else "across"
            number["value"] += 0.001 * (at % 2)
            shown = {"orientation": direction, "measured_directions": [direction], "budget": []}
            document = {**edge_record.document, "mtf_nyquist": number, **shown}
            day = BEGIN + timedelta(days=30 * (at // 2))
            image = ImageEntry(path=f"{at // 2:02d}.tif", sensor="QB02", acquired=day)
            made.add_entries([Entry(record=ac.Record(document), image=image, key=str(at))])
        page = words_of(sensor_page(made, "QB02"))
        relative = made.compare("mtf_nyquist").differences[0].relative
    assert relative.value < 0
    assert f">{percent(relative)}<" in page
    low, high = (f"{100 * end:+.1f}".replace("-", "−") for end in relative.interval())
    assert f"across minus along, 95 %: {low} to {high} %" in page


@pytest.mark.usefixtures("undrawn")
def test_requirements_come_first(archive, tmp_path):
    spec = tmp_path / "spec.toml"
    spec.write_text(SPEC, encoding="utf-8")
    page = words_of(sensor_page(archive, "QB02", specification=spec))
    assert page.index("across track: ") < page.index("falls by")
    assert '<div class="verdict good"><p>across track' in page
    assert '<div class="verdict invalid"><p>sharp' in page
    assert "More images: how many would tell" in page


@pytest.mark.usefixtures("undrawn")
def test_notes_of_a_state_are_not_repeated_by_the_answers_above_it(archive, tmp_path):
    spec = tmp_path / "spec.toml"
    spec.write_text(SPEC, encoding="utf-8")
    checked = archive.check(Specification.of(tomllib.loads(SPEC)))
    page = words_of(sensor_page(archive, "QB02", specification=spec))
    (note,) = checked.answers[0].notes
    assert note.startswith("The images show 2 targets")
    assert page.count("The images show 2 targets") == 1


def test_the_table_of_a_specification_has_the_words_of_its_sentences(archive):
    told = {"metric": "mtf_nyquist", "orientation": "across"}
    spec = Specification.of({"requirement": [{**told, "minimum": 0.9}, {**told, "maximum": 0.9}]})
    check = archive.check(spec)
    table = specification_table(check)
    assert [row[table.columns.index("Probability")] for row in table.rows] == ["< 0.001", "> 0.999"]
    assert table.columns[0] == "Of"
    assert len(table.align) == len(table.columns) == len(table.rows[0])
    assert "More images: how many would tell" in table.notes[0]
    named = Specification.of(
        {"requirement": [{**told, "minimum": 0.9, "name": "sharp"}, {**told, "maximum": 0.9}]}
    )
    table = specification_table(archive.check(named))
    assert [row[0] for row in table.rows] == ["sharp", MISSING]
    assert [row[2] for row in table.rows] == ["mtf_nyquist >= 0.9", "mtf_nyquist <= 0.9"]


@pytest.mark.usefixtures("undrawn")
def test_curves_of_bands_are_drawn_apart(tmp_path, edge_record):
    with Archive(tmp_path / "bands.db") as made:
        for at, band in enumerate(("red", "blue", "red")):
            day = BEGIN + timedelta(days=30 * at)
            image = ImageEntry(path=f"{at}.tif", sensor="QB02", acquired=day)
            made.add_entries([Entry(record=edge_record, image=image, band=band)])
        page = words_of(sensor_page(made, "QB02"))
    assert "red: the latest 2 measurements across, and their median" in page
    assert "blue: the latest 1 measurement across." in page


@pytest.mark.usefixtures("undrawn")
def test_comparisons_of_many_bands_are_counted_where_they_are_not_all_said(tmp_path, edge_record):
    """Six bands of eight stood there as if they were all."""
    rng = np.random.default_rng(3)
    with Archive(tmp_path / "bands.db") as made:
        for at, band, direction in product(range(3), range(1, 9), ("across", "along")):
            number = {**edge_record.document["mtf_nyquist"], "value": 0.3 + 0.01 * rng.random()}
            shown = {"orientation": direction, "measured_directions": [direction], "budget": []}
            record = ac.Record({**edge_record.document, "mtf_nyquist": number, **shown})
            image = ImageEntry(path=f"{at}.tif", sensor="S1")
            target = TargetEntry(name=direction, kind="edge")
            made.add_entries([Entry(record=record, image=image, target=target, band=f"B{band}")])
        page = words_of(sensor_page(made, "S1"))
    assert "2 more comparisons in the tables below." in page
    assert page.count("across − along") == 8


def test_of_very_many_images_the_latest_are_listed(tmp_path, edge_record):
    days = [BEGIN + timedelta(days=at) for at in range(403)]
    with Archive(tmp_path / "many.db") as made:
        made.add_entries(
            Entry(record=edge_record, image=ImageEntry(path=f"{at}.tif", acquired=day))
            for at, day in enumerate([*days, None, None])
        )
        table = images_table(made.measurements(), made.rejected())
    assert table.notes == ("The latest 400; 5 more are not listed.",)
    assert [row[1] for row in table.rows[:1] + table.rows[-2:]] == ["5.tif", "403.tif", "404.tif"]


def test_images_without_dates_are_in_the_order_of_their_numbers(tmp_path, edge_record):
    with Archive(tmp_path / "undated.db") as made:
        for at in (10, 9, 100):
            image = ImageEntry(path=f"K3_{at}.tif", sensor="S1")
            made.add_entries([Entry(record=edge_record, image=image)])
        table = images_table(made.measurements(), made.rejected())
    assert [row[1] for row in table.rows] == ["K3_9.tif", "K3_10.tif", "K3_100.tif"]


@pytest.mark.usefixtures("undrawn")
def test_undated_images_of_bands_that_are_not_named(tmp_path, edge_record):
    """One row an image, and bands of different GSDs apart, everywhere on the page."""
    document = edge_record.document
    with Archive(tmp_path / "undated.db") as made:
        for at in range(6):
            gsd_m = 10.0 if at < 4 else 20.0
            image = ImageEntry(path=f"{at // 2}.tif", content=f"{at // 2:064x}", sensor="S2")
            record = ac.Record({**document, "gsd_m": gsd_m})
            target = TargetEntry(name=f"field {at % 2}", kind="edge")
            made.add_entries([Entry(record=record, image=image, target=target, key=str(at))])
        page = sensor_page(made, "S2")
    images = page[page.index("<h2>Images</h2>") :]
    assert [images.count(f"{at}.tif<") for at in range(3)] == [1, 1, 1]
    assert '<td class="r">2</td><td class="l">2 good</td>' in images
    for size in ("10", "20"):
        assert f"GSD {size} m: the latest" in page
        assert f'<td class="l">GSD {size} m</td><td class="l">field 0</td>' in page
    assert "GSD 20 m, across: MTF at Nyquist" in page
    assert "of one image, which shows no trend" in page


@pytest.mark.usefixtures("undrawn")
def test_a_sensor_without_a_name_has_a_title_and_the_note_of_the_check(tmp_path, edge_record):
    with Archive(tmp_path / "unnamed.db") as made:
        for at in range(6):
            record = ac.Record({**edge_record.document, "gsd_m": 10.0 if at < 4 else 20.0})
            image = ImageEntry(path=f"B{at}.tif", content=f"{at:064x}")
            made.add_entries([Entry(record=record, image=image, key=str(at))])
        page = words_of(sensor_page(made, ""))
        told = {"metric": "mtf_nyquist", "minimum": 0.1, "orientation": "across"}
        answers = made.check(Specification.of({"requirement": [told]})).answers
        with pytest.raises(OptionError, match=r"sensors are '' \(not named\): name another"):
            sensor_page(made, "QB02")
    assert "<title>Sensor not named</title>" in page
    for answer, images in zip(answers, (4, 2), strict=True):
        note = f"No sensor and no band is named: {images} images are taken to be of one."
        assert note in answer.reason
        assert answer.summary.startswith("images without a sensor, GSD ")
        assert f"<b>note</b>: {note}" in page
    # The page is of them, and does not say it again of every number.
    assert "images without a sensor, " not in page


@pytest.mark.usefixtures("undrawn")
def test_bands_are_in_the_order_of_their_numbers(tmp_path, edge_record):
    with Archive(tmp_path / "bands.db") as made:
        for band in ("B11", "B8A", "B2"):
            image = ImageEntry(path=f"{band}.tif", sensor="S2", acquired=BEGIN)
            made.add_entries([Entry(record=edge_record, image=image, band=band)])
        page = sensor_page(made, "S2")
    for before in ('<td class="l">', "<figcaption>"):
        places = [page.index(f"{before}{band}") for band in ("B2", "B8A", "B11")]
        assert places == sorted(places)
    assert f'<td class="r">{BEGIN:%Y-%m-%d}</td>' in page


@pytest.mark.usefixtures("undrawn")
def test_numbers_of_a_table_have_the_digits_of_their_deviations(archive):
    assert signed(-0.04) == "0.0"
    assert signed(-1.26) == "−1.3"
    assert with_minus("2026-01-04: -31.4 to -.5 %") == "2026-01-04: −31.4 to −.5 %"
    trend = archive.trend("mtf_nyquist", sensor="QB02", orientation="across")
    page = trend_page(trend)
    images = page[page.index("<h2>Images</h2>") :]
    shown = re.findall(r">(0\.\d+) ± (0\.\d+)<", images)
    assert shown
    assert all(len(value) == len(std) for value, std in shown)


@pytest.mark.usefixtures("undrawn")
def test_an_image_dated_to_the_day_has_no_time(tmp_path, edge_record):
    with Archive(tmp_path / "days.db") as days:
        for number, day in enumerate(("2026-01-05", "2026-01-06T10:20Z", None)):
            days.add(edge_record, sensor="S", acquired=day, key=f"key {number}")
        rows = days.measurements()
        shown = [row[0] for row in images_table(rows, days.rejected()).rows]
    assert shown == ["2026-01-05", "2026-01-06 10:20", MISSING]


@pytest.mark.usefixtures("undrawn")
def test_targets_that_an_image_does_not_show_are_named_and_not_called_rejected(
    tmp_path, edge_record
):
    image = ImageEntry(path="brazil.tif", sensor="S")
    rejected = [
        Entry(
            rejected=Rejected("region", f"outside: row {-348936 - at}", {"why": "outside"}),
            image=image, target=TargetEntry(name=f"quay {at % 2}", kind="edge"), key=str(at),
        )
        for at in range(4)
    ]  # fmt: skip
    with Archive(tmp_path / "far.db") as far:
        far.add(edge_record, image=image)
        far.add_entries(rejected)
        page = words_of(sensor_page(far, "S"))
        (row,) = rejected_table(far.rejected()).rows
        (listed,) = images_table(far.measurements(), far.rejected()).rows
    assert row == ("4", "region", "outside the image: quay 0, quay 1")
    assert listed[-1] == "0"
    assert "348936" not in page
    assert "not in their images" in page


def test_a_sensor_that_is_not_there_is_named(archive):
    with pytest.raises(OptionError, match=r"0 measurements of 'QB03'.* sensors are QB02:"):
        sensor_page(archive, "QB03")
    with pytest.raises(OptionError, match="no metric 'mtf', only mtf_nyquist"):
        sensor_page(archive, "QB02", metric="mtf")


def test_a_sensor_without_one_of_the_main_numbers_has_its_page(tmp_path):
    """The QuickBird tables print no RER."""
    with Archive(tmp_path / "kept.db") as archive:
        archive.add_entries(published_entries("quickbird-2003"))
        page = sensor_page(archive, "QB02")
        assert "FWHM [px]" in page
        assert "nan" not in re.sub('<svg.*?</svg>|data:[^"]*', "", page, flags=re.DOTALL)
        with pytest.raises(NothingSelectedError, match="rer: choose mtf_nyquist or fwhm_px"):
            sensor_page(archive, "QB02", metric="rer")
        with pytest.raises(OptionError, match="no measurement has a value of rer"):
            archive.mean("rer", sensor="QB02", band="pan", level="CC", orientation="across")
        path = tmp_path / "spec.toml"
        path.write_text('[[requirement]]\nmetric = "rer"\nminimum = 0.3\n')
        answers = archive.check(path, band="pan", orientation="across").answers
        assert all("no image with a value of rer" in one.summary for one in answers)


def test_a_number_that_some_directions_lack_is_missing_there():
    """What the first direction lacks is in the table where another has it."""
    state = SeriesState("across", "rer", {"rer": mean_of_images(series_of())}, 40, 40)
    other = replace(state, name="along", found={"fwhm_px": state.found["rer"], **state.found})
    table = state_table([state, other])
    at = next(at for at, name in enumerate(table.columns) if name.startswith("FWHM"))
    assert table.rows[0][at] == MISSING
    assert table.rows[1][at] != MISSING
