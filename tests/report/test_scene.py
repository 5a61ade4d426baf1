"""Drawings and tables of a scene: nothing empty, with few edges and many, with details and not."""

import html
import re
from dataclasses import replace

import numpy as np
import pytest
from test_every_kind import scene
from test_figures import outside, overlaps, texts

from acutance.errors import OptionError, RegionError
from acutance.report import draw, page, panels, reasons_text, text
from acutance.report.figures.scene_population import expected_counts, scatter_of
from acutance.report.figures.scene_sensor import EdgesSeen, edges_seen, sensor_along
from acutance.report.paper import new_page, styled
from acutance.report.tables.scene import scene_tables, word_chance
from acutance.report.tables.scene_reasons import reasons_table
from acutance.scan import SceneEdges
from acutance.scan.softness import KINDS, PARTS

PANELS = (
    "Edges of the scene", "By direction", "Sharpness of the edges", "Sharpness over the field",
)  # fmt: skip
RNG = np.random.default_rng(7)


@pytest.fixture(scope="module")
def constant():
    """Of too few edges to ask how sharpness changes."""
    return scene()


@pytest.fixture(scope="module")
def measured(constant):
    root = 1e-3 * np.eye(constant.field.amount.size)[:, :3]
    return replace(constant, field=replace(constant.field, root=root))


def some_edges(edges, which):
    return SceneEdges(**{name: column[which] for name, column in edges.columns().items()})


def panel_axes(measurement, title, **drawn_on):
    (panel,) = [one for one in panels(measurement, **drawn_on) if one.title == title]
    with styled():
        figure = new_page(6.0, panel.height_in)
        panel.draw(figure)
        figure.draw_without_rendering()
    return figure.axes, panel


def test_every_drawing_of_a_scene_holds_something(measured):
    found = panels(measured)
    assert tuple(one.title for one in found[-4:]) == PANELS
    for title in PANELS:
        axes, _ = panel_axes(measured, title)
        assert all(one.has_data() for one in axes if one.get_label() != "<colorbar>")


def test_the_sensor_at_many_places_is_that_of_each(measured):
    edges = edges_seen(measured)
    for i in range(0, edges.mtf.size, 9):
        model = measured.at(edges.row[i], edges.col[i]).otf.model
        angle = np.radians(edges.normal_deg[i])
        otf = model.otf(np.array([0.5 * np.cos(angle)]), np.array([0.5 * np.sin(angle)]))
        assert edges.sensor[i] == pytest.approx(float(np.abs(otf[0])), abs=1e-4)


def test_the_sensor_at_many_places_takes_lists_of_any_shape(measured):
    top, left, height, _ = measured.image.roi
    rows, cols, normal = [top, top + height - 1], [left + 3, left], [0.0, 90.0]
    found = measured.mtf_nyquist_at(rows, cols, normal)
    each = [float(measured.mtf_nyquist_at(*one)) for one in zip(rows, cols, normal, strict=True)]
    assert found == pytest.approx(each, abs=1e-12)
    place = measured.at(rows[0], cols[0])
    assert each[0] == pytest.approx(place.across.mtf_nyquist.value, abs=1e-4)
    # One direction serves all places.
    assert measured.mtf_nyquist_at([rows] * 3, [cols] * 3, 0.0).shape == (3, 2)


@pytest.mark.parametrize(
    ("row", "col", "normal_deg", "error", "words"),
    [
        ([5.0, -3.0], [5.0, 5.0], 0.0, RegionError, "row -3, column 5 lies outside of what was"),
        ([np.nan], [5.0], 0.0, RegionError, "row nan, column 5 lies outside"),
        ([5.0, 6.0], [5.0, 6.0, 7.0], 0.0, OptionError, r"shapes differ, row \(2,\), col \(3,\)"),
        ("a", 5.0, 0.0, OptionError, "row is 'a'"),
        (5.0, 5.0, np.inf, OptionError, "normal_deg holds NaN or infinity"),
    ],
)
def test_places_that_are_none_are_refused_in_words(measured, row, col, normal_deg, error, words):
    for ask in (measured.mtf_nyquist_at, measured.mtf_nyquist_seen):
        with pytest.raises(error, match=words):
            ask(row, col, normal_deg)


def test_the_sensor_along_the_axes_has_its_stated_numbers(measured):
    for name, angle_deg in measured.axes_deg.items():
        mtf, std = sensor_along(measured, np.array([angle_deg]))
        stated = measured.directions[name].mtf_nyquist
        assert mtf[0] == pytest.approx(stated.value, abs=1e-3)
        assert std[0] == pytest.approx(stated.std, rel=0.05)


def test_the_map_has_every_edge_of_a_small_scene_and_some_of_a_large_one(measured):
    axes, panel = panel_axes(measured, PANELS[0])
    left_out, used = axes[0].collections
    count = int(measured.edges.used.sum())
    assert len(used.get_paths()) == count
    assert len(left_out.get_paths()) == measured.edges.size - count
    assert "One in" not in panel.caption
    which = np.tile(np.arange(measured.edges.size), 300)
    large = replace(measured, edges=some_edges(measured.edges, which))
    axes, panel = panel_axes(large, PANELS[0])
    assert 1200 < len(axes[0].collections[1].get_paths()) <= 2500
    assert "One in" in panel.caption
    assert all(one.get_rasterized() for one in axes[0].collections if len(one.get_paths()) > 1000)


def test_a_few_used_edges_are_thicker_and_longer_than_many(measured):
    used = np.zeros(measured.edges.size, bool)
    used[np.flatnonzero(measured.edges.used)[:12]] = True
    edges = replace(measured.edges, used=used, length_px=np.full(used.size, 5.0))
    few = panel_axes(replace(measured, edges=edges), PANELS[0])[0][0].collections[1]
    which = np.tile(np.flatnonzero(measured.edges.used), 20)
    many = replace(measured, edges=some_edges(measured.edges, which))
    thin = panel_axes(many, PANELS[0])[0][0].collections[1]
    assert few.get_linewidth()[0] == pytest.approx(4.8)
    assert few.get_linewidth()[0] > 3 * thin.get_linewidth()[0]
    (start, end) = few.get_segments()[0]
    assert np.hypot(*(end - start)) == pytest.approx(0.032 * 480)
    assert "Short ones are drawn longer" in panel_axes(replace(measured, edges=edges),
                                                       PANELS[0])[1].caption  # fmt: skip


@pytest.mark.usefixtures("undrawn")
def test_a_map_is_drawn_on_a_quick_look(measured):
    assert not panel_axes(measured, PANELS[0])[0][0].images
    quick = RNG.normal(100.0, 5.0, (60, 70))
    quick[:4] = np.nan
    (image,) = panel_axes(measured, PANELS[0], backdrop=quick)[0][0].images
    row, col, height, width = measured.image.roi
    assert image.get_extent() == [col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5]
    empty = np.full((5, 5), np.nan)
    assert not panel_axes(measured, PANELS[0], backdrop=empty)[0][0].images
    assert "data:image" in page(measured, backdrop=quick)


def test_a_quick_look_may_be_a_list_or_have_masked_pixels(measured):
    quick = RNG.normal(100.0, 5.0, (60, 70))
    (image,) = panel_axes(measured, PANELS[0], backdrop=quick.tolist())[0][0].images
    assert np.array_equal(image.get_array(), quick)
    hidden = np.ma.masked_greater(quick, 105.0)
    (image,) = panel_axes(measured, PANELS[0], backdrop=hidden)[0][0].images
    assert np.array_equal(np.ma.getmaskarray(image.get_array()), hidden.mask)


@pytest.mark.parametrize("shape", [(5,), (4, 5, 3), (0, 5)])
def test_what_is_no_image_of_one_band_is_no_quick_look(measured, shape):
    words = re.escape(f"backdrop has shape {shape}: give an image of one band, (rows, columns)")
    for show in (draw, page):
        with pytest.raises(OptionError, match=words):
            show(measured, backdrop=np.zeros(shape))
    with pytest.raises(OptionError, match=r"backdrop is 'quick\.png': it has to hold numbers"):
        draw(measured, backdrop="quick.png")


def test_directions_are_those_of_the_image_and_all_dots_are_inside(measured):
    (axes,), panel = panel_axes(measured, PANELS[1])
    assert axes.name == "polar"
    assert axes.get_theta_direction() == -1
    (line,) = axes.lines
    assert line.get_ydata() == pytest.approx(
        sensor_along(measured, np.degrees(line.get_xdata()))[0]
    )
    dots = np.concatenate([one.get_offsets() for one in axes.collections[:2]])
    assert len(dots) == measured.edges.used.sum()
    assert dots[:, 1].max() <= axes.get_ylim()[1]
    assert "95 % band" in panel.caption


def test_the_field_has_numbers_at_its_places_in_the_same_colours(measured):
    axes, panel = panel_axes(measured, PANELS[3])
    across, along = axes[:2]
    assert across.images[0].get_clim() == along.images[0].get_clim()
    assert len(across.texts) == len(along.texts) == 9
    middle = measured.over_field(3, 3)[4]
    shown = float(across.texts[4].get_text().split()[0])
    assert shown == pytest.approx(middle.across.mtf_nyquist.value, abs=1e-3)
    row, col = across.texts[4].get_position()[::-1]
    assert (row, col) == (middle.row, middle.col)
    found = measured.mtf_nyquist_at(np.array([row]), np.array([col]), np.array([0.0]))[0]
    image = across.images[0].get_array()
    near = image[image.shape[0] // 2, image.shape[1] // 2]
    assert near == pytest.approx(found, abs=0.01)
    assert word_chance(measured.field.chance_constant) in panel.caption


def test_chances_are_written_to_be_read():
    assert [word_chance(one) for one in (0.4321, 1.0, 2e-143)] == ["0.43", "1", "below 0.0001"]


def population(share, size=4000):
    """Edges of a known population about a sensor of 0.3."""
    std = RNG.uniform(0.01, 0.03, size)
    soft = RNG.uniform(size=size) > share
    tau = np.where(soft, 0.42 * np.abs(RNG.normal(size=size)), 0.0)
    mtf = np.abs(0.3 * np.exp(-0.5 * (np.pi * tau) ** 2) + std * RNG.normal(size=size))
    nothing = np.zeros(size)
    return EdgesSeen(nothing, nothing, nothing, nothing, mtf, std, nothing, np.full(size, 0.3))


def test_the_expected_counts_are_those_of_a_population_that_is_drawn():
    edges = population(0.6)
    assert scatter_of(edges) == pytest.approx(1.0, abs=0.06)
    share = np.zeros(len(PARTS))
    law = PARTS.index("half-normal 0.42 px")
    share[0], share[law] = 0.6, 0.4
    bins = np.linspace(-0.3, 0.12, 22)
    ideal, every = expected_counts(edges, share, bins)
    counts, _ = np.histogram(edges.off, bins)
    # Of soft objects those within a tenth of a pixel count as ideal, too.
    assert ideal.sum() == pytest.approx((0.6 + 0.4 * KINDS["ideal"][law]) * 4000, rel=0.01)
    assert every.sum() == pytest.approx(counts.sum(), rel=0.01)
    assert np.all(np.abs(counts - every) < 5 * np.sqrt(every + 1))


def test_edges_that_scatter_by_less_than_their_deviations_are_expected_to():
    edges = population(1.0)
    assert scatter_of(edges._replace(std=2 * edges.std)) == pytest.approx(0.5, abs=0.03)
    assert scatter_of(EdgesSeen(*(column[:3] for column in edges))) == 1.0


def test_the_population_is_drawn_over_the_edges_with_details_alone(measured):
    (axes,), panel = panel_axes(measured, PANELS[2])
    labels = [one.get_text() for one in axes.get_legend().get_texts()]
    assert labels == ["edges", "sensor", "expected", "ideal ones"]
    assert "expects" in panel.caption
    (axes,), panel = panel_axes(measured.without_details(), PANELS[2])
    assert [one.get_text() for one in axes.get_legend().get_texts()] == ["edges", "sensor"]
    assert "expects" not in panel.caption


def test_eight_edges_and_columns_without_numbers_are_drawn(measured):
    edges = some_edges(measured.edges, np.flatnonzero(measured.edges.used)[:8])
    edges.mtf_nyquist[2:] = edges.mtf_nyquist_std[2:] = edges.snr[:] = np.nan
    few = replace(measured, edges=edges)
    figure = draw(few)
    assert not outside(figure)
    assert "8 of 8 edges used" in texts(figure)
    assert not re.search(r"\bnan\b", texts(figure) + text(few))
    assert reasons_table(edges).rows == ()
    (axes,), _ = panel_axes(few, PANELS[2])
    assert axes.patches[0].get_data().values.sum() == 2
    edges.mtf_nyquist[:] = np.nan
    draw(replace(few, details=None)).draw_without_rendering()


def test_labels_stay_apart_at_many_edges(measured):
    which = np.tile(np.arange(measured.edges.size), 100)
    figure = draw(replace(measured, edges=some_edges(measured.edges, which)))
    crossed = [
        pair for pair in overlaps(figure) if not all(re.fullmatch(r"[\d.]+", one) for one in pair)
    ]
    assert not crossed


def reasons(pairs):
    rows = [{"row": 0.0, "verdict": verdict, "reason": reason} for verdict, reason in pairs]
    return reasons_table(SceneEdges.of_rows(rows)).rows


def test_reasons_that_differ_in_numbers_are_one_with_their_medians():
    few = (
        "{} px of the target's length have at least 3.7 px of plateau on both sides (at least "
        "8 are needed): choose a region"
    )
    advice = "objects on the target, or a fit that does not hold; choose a cleaner region"
    found = reasons([
        *(("rejected", few.format(n)) for n in (0, 2, 5)),
        *(("doubtful", f"{n} % of the pixels lie far: {advice}") for n in ("2.5", "4")),
        ("invalid", "something else: do this"),
    ])  # fmt: skip
    assert found == (
        (
            "3", "rejected", "–",
            "2 px of the target's length have at least 3.7 px of plateau on both sides (at "
            "least 8 are needed)",
        ),
        ("2", "doubtful", "outliers", "3.25 % of the pixels lie far"),
        ("1", "invalid", "–", "Something else"),
    )  # fmt: skip


def test_sides_are_not_told_apart_and_rare_reasons_are_counted_together():
    rim = "a strip on the {} side has an RER of .5: a rim, gutter or kerb is then taken for the "
    rim += "sensor's; compare other edges"
    kinds = [("rejected", f"{chr(97 + i) * 3} is wrong") for i in range(15)]
    found = reasons([*(("doubtful", rim.format(one)) for one in ("dark", "bright")), *kinds])
    assert found[0][:3] == ("2", "doubtful", "rim")
    assert found[0][3].startswith("A strip on one side")
    assert found[-1] == ("2", "", "", "2 other reasons")
    assert sum(int(row[0]) for row in found) == 17


def test_in_a_terminal_reasons_are_fewer_and_none_is_no_table():
    kinds = [("rejected", f"{chr(97 + i) * 3} is wrong") for i in range(9)]
    rows = [{"row": 0.0, "verdict": verdict, "reason": reason} for verdict, reason in kinds]
    lines = reasons_text(SceneEdges.of_rows(rows)).splitlines()
    assert len(lines) == 2 + 6 + 1
    assert lines[0] == "Edges left out"
    assert "3 other reasons" in lines[-1]
    assert reasons_text(SceneEdges.of_rows([])) == ""


@pytest.mark.usefixtures("undrawn")
def test_the_page_of_a_scene_says_what_its_numbers_are(measured):
    whole = html.unescape(page(measured))
    for words in ("median SNR", f"of {measured.edges.size} edges used", "pale as sharp", *PANELS):
        assert words in whole
    names = [row[0] for row in scene_tables(measured)[1].rows]
    assert names == ["ideal", "soft", "strange"]


def test_the_ideal_objects_of_every_direction_are_a_table(measured):
    (table,) = [one for one in scene_tables(measured) if one.title == "Ideal objects by direction"]
    for row, stated in zip(table.rows, measured.ideal_by_direction, strict=True):
        assert float(row[0]) == pytest.approx(stated.normal_deg, abs=0.05)
        assert int(row[1]) == stated.edges
        value, std = map(float, row[2].split(" ± "))
        assert value == pytest.approx(100 * stated.share.value, abs=0.5)
        assert std == pytest.approx(100 * stated.share.std, abs=0.5)
    assert sum(int(row[1]) for row in table.rows) == measured.edges.used.sum()


def test_the_forms_of_the_sensor_say_whether_the_product_was_interpolated(measured):
    (table,) = [one for one in scene_tables(measured) if one.title == "Forms of the sensor"]
    weights = measured.to_dict()["forms"]
    assert list(weights.values()) == sorted(weights.values(), reverse=True)
    assert sum(weights.values()) == pytest.approx(1.0, abs=1e-4)
    for name, weight, meaning in table.rows:
        assert float(weight) == pytest.approx(weights[name], abs=0.006)
        terms = name.split(" x ")
        is_of_product = not {"interpolation", "resampling", "phase"}.isdisjoint(terms)
        assert is_of_product == ("not the instrument" in meaning)
    words = "gaussian x detector x halo x resampling"
    of_splines = replace(measured, forms={words: 1.0})
    assert "interpolated by splines: the product" in text(of_splines)


@pytest.mark.usefixtures("undrawn")
def test_of_too_few_edges_nothing_is_shown_over_the_field(constant):
    assert not constant.field.is_fitted
    assert tuple(one.title for one in panels(constant)[-3:]) == PANELS[:3]
    whole = html.unescape(page(constant))
    for shown in (whole, text(constant)):
        assert shown.count("too few to show how sharpness changes over the field") == 1
    assert constant.to_dict()["field"]["chance_constant"] is None
    assert np.isnan(constant.field.chance_constant)
    assert repr(constant.field) == "<Field: taken for constant: too few edges to ask>"
