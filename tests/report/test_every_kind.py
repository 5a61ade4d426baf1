"""Every kind of target, measured on its simulation: all outputs, with details and without."""

import html
import json
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure
from test_figures import outside, overlaps, texts

import acutance as ac
from acutance.report import (
    csv,
    document,
    draw,
    json_text,
    notebook_html,
    page,
    panels,
    tables,
    text,
)
from acutance.report.figure import KIND_PANELS
from acutance.report.figures.points import points_panels
from acutance.report.labels import write_fixed
from acutance.report.paper import new_page, styled
from acutance.report.tables.combined import PARAMETERS
from acutance.report.tables.result import KIND_TABLES
from acutance.targets.combine.sensor_forms import SensorForm
from acutance.targets.combine.sensor_terms import TERMS

SENSOR = ac.Sensor([ac.optics.Gaussian(0.39), ac.optics.Detector()], gsd_m=0.7)


@cache
def points():
    image, truth = ac.simulate.points(SENSOR, snr=80.0, rng=np.random.default_rng(1))
    return ac.measure_points(image, gsd_m=0.7, surveyed=truth.positions)


@cache
def mirrors():
    image, truth = ac.simulate.points(SENSOR, snr=80.0, rng=np.random.default_rng(2))
    return ac.measure_points(image, positions=truth.positions, method="gaussian-2003")


@cache
def bars():
    periods = (8.0, 4.0, 2.5)
    image, _ = ac.simulate.bars(SENSOR, periods_px=periods, snr=80.0, rng=np.random.default_rng(3))
    return ac.measure_bars(image, gsd_m=0.7)


@cache
def star():
    image, _ = ac.simulate.star(
        SENSOR, snr=80.0, shape=(96, 96), radius_px=40.0, rng=np.random.default_rng(4)
    )
    return ac.measure_star(image, gsd_m=0.7)


@cache
def pair():
    rng = np.random.default_rng(5)
    low, high, *_ = ac.simulate.pair(SENSOR, SENSOR, ratio=4, snr=80.0, rng=rng)
    return ac.measure_biresolution(low, high, ratio=4)


@cache
def combined():
    both = []
    for seed, orientation in enumerate(("across", "along")):
        image, _ = ac.simulate.edge(
            SENSOR, angle_deg=6.0, orientation=orientation, snr=80.0,
            rng=np.random.default_rng(seed),
        )  # fmt: skip
        both.append(ac.measure_edge(image, gsd_m=0.7))
    return ac.combine(both, names=["tarp across", "tarp along"])


@cache
def scene():
    options = ac.simulate.LandscapeOptions(soft=0.3, texture=(0.0, 0.0), density_per_mpx=120)
    image, _ = ac.simulate.landscape(
        SENSOR, shape=(420, 480), options=options, snr=80.0, rng=np.random.default_rng(6)
    )
    return ac.scan_scene(image, gsd_m=0.7)


MADE = {
    "points": points, "mirrors": mirrors, "bars": bars, "star": star, "pair": pair,
    "combined": combined, "scene": scene,
}  # fmt: skip


@pytest.fixture(scope="module", params=MADE)
def result(request):
    return MADE[request.param]()


def test_the_figure_keeps_its_labels_apart(result):
    figure = draw(result)
    crossed = [
        pair for pair in overlaps(figure) if not all(re.fullmatch(r"[\d.]+", one) for one in pair)
    ]  # levels of contours may touch
    assert not crossed
    assert not outside(figure)


@pytest.mark.usefixtures("undrawn")
def test_text_and_page_show_the_tables_of_the_kind(result):
    shown, whole = text(result), html.unescape(page(result))
    assert "nan" not in shown
    for table in tables(result):
        assert table.title in whole
        if not table.page_only:
            assert table.title in shown or table.title == "Checks"
    for check in result.checks:
        assert check.name in shown
        assert check.name in whole
    assert " less " not in re.sub(r"data:image[^\"]*", "", whole)


def test_the_page_of_a_pair_is_written_with_its_drawings():
    """Those of the other kinds are written by the demonstration."""
    assert page(pair()).count("data:image/svg+xml;base64,PD94") == len(panels(pair()))


def test_the_document_keeps_to_the_schema(result, schema_validator):
    content = json.loads(json_text(document(result, covariance=True)))
    schema_validator.validate(content)


@pytest.mark.usefixtures("undrawn")
def test_all_outputs_are_made_without_details(result):
    """All drawings are laid out on one figure, and not once more for each output."""
    light = result.without_details()
    assert len(panels(light)) < len(panels(result)) or result.kind in ("combined", "scene")
    (_, verdict, numbers, *_), shown = (text(one).split("\n\n") for one in (result, light))
    assert shown[1] == verdict
    assert shown[2].splitlines()[2][:30] == numbers.splitlines()[2][:30]
    assert csv(light).splitlines()[0] == csv(result).splitlines()[0]
    more = {"star": ["mean"], "bars": ["normal"]}.get(result.kind, [])
    named = [line.split(",")[0] for line in csv(light).splitlines()[1:]]
    assert list(dict.fromkeys(named)) == [*result.measured_directions, *more]
    assert "MTF" in texts(draw(light))
    for output in (page(light), notebook_html(light), notebook_html(light.record)):
        assert "data:image/svg+xml" in output


def test_every_kind_but_the_straight_ones_has_panels_and_tables():
    kinds = {"points", "biresolution", "bars", "star", "combined", "scene"}
    assert set(KIND_PANELS) == set(KIND_TABLES) == kinds


def test_every_parameter_of_a_combined_sensor_has_its_words():
    forms = [SensorForm(("gaussian", name)) for name in TERMS]
    found = [name for form in forms for name in form.numbers(form.mean)]
    assert len(found) >= len(TERMS)
    assert set(found) == set(PARAMETERS)


def drawn_panel(measured, title):
    """One drawing on half of a page."""
    (panel,) = [one for one in panels(measured) if one.title == title]
    with styled():
        figure = new_page(5.6, panel.height_in)
        panel.draw(figure)
        figure.draw_without_rendering()
    return figure


def test_the_title_of_a_narrow_map_of_bars_is_whole():
    narrow = bars()
    narrow = replace(narrow, details=replace(narrow.details, pixels=narrow.details.pixels[:, :12]))
    assert not outside(drawn_panel(narrow, "Groups"))


def test_numbers_of_sources_cover_neither_sources_nor_one_another():
    places = np.array([(10 + 5.25 * i, 10 + 5.25 * j) for i in range(4) for j in range(5)])
    image, _ = ac.simulate.points(SENSOR, positions=places, snr=80.0, rng=np.random.default_rng(1))
    figure = drawn_panel(ac.measure_points(image, positions=places), "Sources")
    (axes,) = figure.axes
    boxes = [one.get_bbox_patch().get_window_extent() for one in axes.texts]
    assert len(boxes) == 20
    assert {one.get_color() for one in axes.texts} == {"white"}
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:i])
        for row, col in places:
            x, y = axes.transData.transform((col, row))
            assert not box.contains(x, y)


def test_a_source_darker_than_its_ground_is_drawn():
    measured = mirrors()
    first = replace(measured.sources[0], peak=-measured.sources[0].peak)
    odd = replace(measured, sources=(first, *measured.sources[1:]))
    draw(odd).draw_without_rendering()


def flown_along_rows(result):
    return replace(result, image=replace(result.image, along_track="x"))


@pytest.mark.usefixtures("undrawn")
def test_aligned_samples_are_named_as_the_image_was_flown():
    found = mirrors().aligned
    sides = {"y": (found.sigma_x_px, found.sigma_y_px), "x": (found.sigma_y_px, found.sigma_x_px)}
    for result in (mirrors(), flown_along_rows(mirrors())):
        (table,) = (one for one in tables(result) if one.title == "Aligned samples")
        across, along = (f"{one:.4f}" for one in sides[result.image.along_track])
        assert table.rows[:2] == (("σ across [px]", across), ("σ along [px]", along))
        (panel,) = (one for one in points_panels(result) if one.title == "Aligned samples")
        figure = Figure()
        panel.draw(figure)
        drawn = {axes.get_ylabel(): axes.lines[1].get_ydata() for axes in figure.axes}
        for name, sigma in zip(("across", "along"), sides[result.image.along_track], strict=True):
            np.testing.assert_allclose(drawn[name][0], np.exp(-0.5 * (2.6 / sigma) ** 2))


def test_the_iterations_of_a_pair_are_named_as_the_image_was_flown():
    turned = flown_along_rows(pair())
    for result, x, y in ((pair(), "across", "along"), (turned, "along", "across")):
        (table,) = (one for one in tables(result) if one.title.startswith("Iterations"))
        last = dict(zip(table.columns, table.rows[-1], strict=True))
        step = result.steps[-1]
        assert last[f"shift {y} [px]"] == write_fixed(step.shift_px[0])
        assert last[f"shift {x} [px]"] == write_fixed(step.shift_px[1])
        assert last[f"variance {y} [px²]"] == write_fixed(step.variance_px2[0])
        assert last[f"variance {x} [px²]"] == write_fixed(step.variance_px2[1])
