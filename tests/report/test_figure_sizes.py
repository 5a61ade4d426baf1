"""Sizes on figures and pages: no empty halves, equal panels, labels that can be read."""

import numpy as np
import pytest
from test_every_kind import pair, points, scene

import acutance as ac
from acutance import simulate
from acutance.report import draw, page, panel_figure, panels, tables
from acutance.report.paper import styled

SENSOR = simulate.reference_systems()["gaussian"]


def drawn(measurement, title):
    """A panel on a page of its own, laid out."""
    (panel,) = (one for one in panels(measurement) if one.title == title)
    figure = panel_figure(panel)
    with styled():
        figure.draw_without_rendering()
    return figure


@pytest.fixture(scope="module")
def edge():
    pixels, _ = simulate.edge(SENSOR, shape=(60, 60), snr=100, rng=np.random.default_rng(0))
    return ac.measure_edge(ac.Image.from_array(pixels, gsd_m=0.7))


def test_a_long_list_of_checks_stands_below_in_columns(edge):
    figure = draw(edge)
    figure.draw_without_rendering()
    shown = {text.get_text(): text for axes in figure.axes for text in axes.texts}
    places = [shown[check.name].get_window_extent() for check in edge.checks]
    assert len(edge.checks) > 30
    assert len({round(place.x0) for place in places}) == 3
    # The curve above them is no column: its axes are wider than high.
    (esf,) = (one for one in figure.axes if one.get_title(loc="left") == "Edge spread function")
    assert esf.bbox.width > esf.bbox.height
    assert figure.get_size_inches()[1] < 13


def test_the_title_keeps_off_the_axis_in_metres(edge):
    figure = drawn(edge, "Modulation transfer function")
    (axes,) = figure.axes
    (second,) = axes.child_axes
    label = second.xaxis.label.get_window_extent()
    assert axes._left_title.get_window_extent().y0 > label.y1 + 7


def test_zeros_of_a_pulse_can_be_read(pulse):
    figure = drawn(pulse, "Modulation transfer function")
    names = [text for text in figure.axes[0].texts if text.get_text().endswith("/w")]
    assert names
    assert all(text.get_fontsize() >= 9 for text in names)


@pytest.mark.usefixtures("undrawn")
def test_the_mtf_of_a_pulse_is_not_squeezed_by_its_table(pulse, measurement):
    first, second = page(pulse).split("<section>")[1:3]
    assert "<img" not in first
    assert second.count("<img") == 2
    assert "<img" in page(measurement).split("<section>")[1]


def test_maps_of_a_pair_are_equally_large():
    figure = drawn(pair(), "Map of local statistics")
    maps = [one for one in figure.axes if one.get_title(loc="left")]
    assert len(maps) == 4
    for side in ("width", "height", "y0"):
        found = [getattr(one.get_window_extent(), side) for one in maps]
        assert found == pytest.approx([found[0]] * 4, abs=1.0)
    assert all(one.spines["right"].get_visible() for one in maps)


def test_tables_have_real_minus_signs():
    shown = (*tables(pair()), *tables(points()))
    cells = [cell for table in shown for row in table.rows for cell in row]
    assert [cell for cell in cells if cell.startswith("−")]
    assert not [cell for cell in cells if cell.startswith("-")]


def test_radii_stand_above_the_dots_of_a_scene():
    axes = drawn(scene(), "By direction").axes[0]
    above = axes.yaxis.get_zorder()
    assert all(one.get_zorder() < above for one in (*axes.collections, *axes.lines))


@pytest.mark.usefixtures("undrawn")
def test_narrow_pages_say_where_they_are_scrolled(measurement):
    shown = page(measurement)
    assert "scroll sideways" in shown
    # On a narrow screen sentences keep their room.
    assert 'class="l long"' in shown
    assert "td.long { min-width" in shown
