"""Whole scenes: the sensor comes out, whatever the objects are; what cannot be told is said."""

import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from bare_ground import bare_ground

import acutance as ac
from acutance import optics, simulate
from acutance.raster import Box
from acutance.scan.all_windows import part_of, scan_windows
from acutance.scan.scene_edges import SceneEdges

SENSOR = simulate.reference_systems()["gaussian"]


def landscape(soft, size=600, seed=3):
    options = bare_ground(soft=soft, softness_px=(0.15, 2.0))
    return simulate.landscape(
        SENSOR, shape=(size, size), snr=100, options=options, rng=np.random.default_rng(seed)
    )


def edges_alone(image, **options):
    """The edges of a scan, without the sensor behind them."""
    image = ac.Image.of(image)
    box, scan_options = Box.whole(image.shape), ac.ScanOptions(**options)
    windows = scan_windows([image], box, None, gsd=None, options=scan_options)
    return SceneEdges.of_rows([row for (window,) in windows for row in window.rows])


@pytest.fixture(scope="module")
def ideal():
    image, truth = landscape(0.0)
    return image, truth, ac.scan_scene(image, gsd_m=2.0)


def test_the_sensor_is_measured(ideal):
    _, _, scene = ideal
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    for direction in (scene.across, scene.along):
        number = direction.mtf_nyquist
        assert abs(number.value - expected) < 3 * number.std
        assert number.std < 0.006
    assert scene.kind == "scene"
    assert scene.objects["ideal"].value > 0.95
    assert scene.verdict.word in ("good", "usable")


def test_nearly_all_edges_are_found_and_used(ideal):
    _, truth, scene = ideal
    long = [edge for edge in truth.edges if edge.length_px >= 20 and edge.snr >= 20]
    found = 0
    for edge in long:
        away = edge.line.normal_distance(scene.edges.row, scene.edges.col)
        along = edge.line.tangent_distance(scene.edges.row, scene.edges.col)
        found += bool(np.any((np.abs(away) < 1.5) & (np.abs(along) < 0.5 * edge.length_px)))
    assert found >= 0.98 * len(long)
    assert scene.edges.used.mean() > 0.9


def test_soft_objects_do_not_pass_for_a_soft_sensor():
    image, _ = landscape(0.6, 1000, seed=4)
    scene = ac.scan_scene(image)
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    median = float(np.median(scene.edges.mtf_nyquist[scene.edges.used]))
    assert median < expected - 0.02
    for direction in (scene.across, scene.along):
        number = direction.mtf_nyquist
        assert abs(number.value - expected) < max(3 * number.std, 0.01)
    share = scene.objects["ideal"]
    assert share.value == pytest.approx(0.37, abs=0.12)
    soft = scene.edges.softness_px[scene.edges.used & (scene.edges.ideal < 0.01)]
    assert np.median(soft) > 0.4


def test_windows_change_little(ideal):
    image, _, scene = ideal
    parts = ac.scan_scene(image, options=ac.ScanOptions(window_px=256))
    assert parts.edges.size >= scene.edges.size
    for name in ("across", "along"):
        one, other = getattr(scene, name).mtf_nyquist, getattr(parts, name).mtf_nyquist
        assert abs(one.value - other.value) < 2 * one.std


def test_edges_are_as_long_as_the_options_say(ideal):
    image, _, scene = ideal
    cut, long = edges_alone(image, max_length_px=30.0), edges_alone(image, min_length_px=40.0)
    assert cut.length_px.max() <= 31.0 < scene.edges.length_px.max()
    assert cut.size > 1.3 * scene.edges.size
    assert long.size < scene.edges.size
    assert np.median(long.length_px) > np.median(scene.edges.length_px)


def test_less_ground_and_only_strong_edges_if_the_options_say_so(ideal):
    image, _, scene = ideal
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    near = ac.scan_scene(image, options=ac.ScanOptions(half_width_px=10.0))
    assert near.across.mtf_nyquist.value != scene.across.mtf_nyquist.value
    assert abs(near.across.mtf_nyquist.value - expected) < 3 * near.across.mtf_nyquist.std
    strong = edges_alone(image, min_gradient_sigmas=100.0)
    assert 8 <= strong.size < scene.edges.size
    assert np.nanmin(strong.snr) > np.nanmin(scene.edges.snr)


def test_a_part_of_an_image_is_scanned(ideal, few_forms):
    image, _, _ = ideal
    seen = []
    named = replace(ac.Region.from_box(Box(100, 50, 450, 500)), name="La Crau")
    with few_forms():
        part = ac.scan_scene(image, named, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 1)]
    assert part.edges.row.min() >= 90
    assert part.edges.col.max() <= 560
    assert part.image.roi == (100, 50, 450, 500)
    assert part.image.region == part.to_dict()["image"]["region"] == "La Crau"


def test_a_box_is_a_region_as_its_corners_are():
    """Windows are read with a margin: the numbers of a box changed with what lies beyond it."""
    image = ac.raster.Image.from_array(np.zeros((90, 80)))
    box, region = part_of(image, (20, 10, 40, 30))
    assert region.mask(Box.whole(image.shape)).sum() == 40 * 30
    assert region.mask(box).all()
    for whole in (None, (0, 0, 90, 80)):
        assert part_of(image, whole) == (Box.whole(image.shape), None)


def test_tables_hold_places_of_large_scenes():
    row = {"row": 15234.56784, "col": 20123.45671, "normal_deg": 12.0, "length_px": 40.0}
    edges = SceneEdges.of_rows([row])
    assert edges.to_csv().splitlines()[1].startswith("15234.5678,20123.4567,12.0,40.0,")
    (feature,) = edges.to_geojson()["features"]
    assert (feature["properties"]["row"], feature["properties"]["col"]) == (15234.5678, 20123.4567)


def test_a_polygon_leaves_out_what_lies_beside_it(ideal, few_forms):
    image, _, scene = ideal
    triangle = ac.Region([(0.0, 0.0), (599.0, 0.0), (0.0, 599.0)])
    with few_forms():
        part = ac.scan_scene(image, triangle)
    assert part.edges.size < 0.6 * scene.edges.size
    assert (part.edges.row + part.edges.col).max() < 605


@pytest.mark.usefixtures("undrawn")
def test_documents_tables_and_figures(ideal):
    _, _, scene = ideal
    document = json.loads(json.dumps(scene.to_dict()))
    assert document["edges"]["used"] == int(scene.edges.used.sum())
    assert ac.Record.from_dict(document).across.mtf_nyquist.value == pytest.approx(
        scene.across.mtf_nyquist.value
    )
    lines = scene.edges.to_csv().splitlines()
    assert len(lines) == scene.edges.size + 1
    assert lines[0].startswith("row,col,normal_deg")
    pixels = scene.edges.to_geojson()
    assert pixels["crs"] == "pixel"
    assert "crs" not in scene.edges.to_geojson(lambda row, col: (col / 1e4, row / 1e4))
    features = pixels["features"]
    (x0, y0), (x1, y1) = features[0]["geometry"]["coordinates"]
    assert np.hypot(x1 - x0, y1 - y0) == pytest.approx(scene.edges.length_px[0], rel=1e-6)
    assert "Edges of the scene" in ac.report.text(scene)
    assert "Sharpness over the field" in ac.report.text(scene)
    assert len(ac.report.draw(scene).axes) > 5
    assert "Sharpness of the edges" in ac.report.page(scene)


def test_sharpness_at_a_place(ideal):
    _, _, scene = ideal
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    corner = scene.at(599, 0)
    assert abs(corner.across.mtf_nyquist.value - expected) < 3 * corner.across.mtf_nyquist.std
    assert corner.across.mtf_nyquist.std >= 0.99 * scene.across.mtf_nyquist.std
    assert corner.mtf_at(0.0)(0.5).value == pytest.approx(corner.across.mtf_nyquist.value)
    assert "row 599, column 0" in repr(corner)
    assert scene.field.chance_constant > 0.5
    assert len(scene.over_field(2, 4)) == 8
    with pytest.raises(ac.RegionError, match="rows 0 to 599"):
        scene.at(600, 0)
    for place in ((np.nan, 10), (10, np.nan)):
        with pytest.raises(ac.RegionError, match="rows 0 to 599"):
            scene.at(*place)
    with pytest.raises(ac.RegionError, match="row is 'a': give a number of pixels"):
        scene.at("a", 0)
    for parts in ((0, 3), (3, 2.5)):
        with pytest.raises(ac.OptionError, match="give a whole number of parts, from 1"):
            scene.over_field(*parts)
    places = scene.to_dict()["field"]["places"]
    assert len(places) == 9
    assert places[4]["along"]["rer"]["value"] == pytest.approx(0.68, abs=0.02)
    light = scene.without_details()
    assert light.at(599, 0).across.rer.value == pytest.approx(corner.across.rer.value)


def test_a_field_of_view_that_is_softer_on_one_side():
    shape, added = (700, 1400), (0.0, 0.2)
    rng = np.random.default_rng(5)
    options = bare_ground(soft=0.0)
    seed = int(rng.integers(2**31))
    sharp, soft = (
        simulate.landscape(
            ac.Sensor([*SENSOR.blocks, ac.optics.Gaussian(one)]) if one else SENSOR,
            shape=shape, options=options, rng=np.random.default_rng(seed),
        )[0]
        for one in added
    )  # fmt: skip
    share = np.linspace(0, 1, shape[1])
    image = (1 - share) * sharp + share * soft
    image += rng.normal(0, options.typical_contrast / 100, shape)
    scene = ac.scan_scene(image)
    assert scene.field.chance_constant < 0.01
    for col in (100, 700, 1300):
        blur = np.exp(-2 * (np.pi * 0.5 * added[1]) ** 2)
        true = 0.28905 * (1 + share[col] * (blur - 1))
        number = scene.at(350, col).across.mtf_nyquist
        assert abs(number.value - true) < 3 * number.std
        assert number.std < 0.006
    assert {check.name: check for check in scene.checks}["field_change"].value > 0.03


def test_a_decimated_scene_is_sharper_than_any_pixel(ideal, few_forms):
    fine, _ = simulate.landscape(
        ac.Sensor([ac.optics.Detector(0.5), ac.optics.Gaussian(0.15)]), shape=(500, 500),
        options=bare_ground(soft=0.0), rng=np.random.default_rng(3),
    )  # fmt: skip
    with few_forms():
        scene = ac.scan_scene(fine)
    assert "full_pixel" in {check.name for check in scene.failed_checks}
    assert scene.verdict.word == "doubtful"
    _, _, plain = ideal
    assert "full_pixel" not in {check.name for check in plain.failed_checks}


def share_of(scene):
    return {check.name: check for check in scene.checks}["trusted_share"]


@pytest.mark.parametrize(
    ("share", "sigma_px", "counted"), [(0.1, 2.8, 0.1), (0.28, 2.8, 0.28), (0.28, 1.0, 0.0)]
)
def test_more_light_in_a_halo_than_optics_scatter_is_said(share, sigma_px, counted):
    sensor = ac.Sensor([optics.Gaussian(0.35), optics.Halo(share, sigma_px), optics.Detector()])
    image, _ = simulate.landscape(
        sensor, shape=(500, 500), snr=100, options=bare_ground(soft=0.0),
        rng=np.random.default_rng(6),
    )  # fmt: skip
    check = next(one for one in ac.scan_scene(image).checks if one.name == "halo_share")
    assert check.value == pytest.approx(counted, abs=0.05)
    assert check.passed is (counted <= 0.2)
    assert check.severity == "caution"


def test_where_nearly_all_edges_contradict_a_sensor_the_scan_is_doubtful(ideal, few_forms):
    """A landscape decimated four times without a filter: of 173 edges 10 pass, by chance."""
    fine, _ = simulate.landscape(
        SENSOR, shape=(1800, 1800), snr=60, rng=np.random.default_rng((0, 8))
    )
    with few_forms():
        scene = ac.scan_scene(fine[::4, ::4])
    check = share_of(scene)
    trusted = np.isin(scene.edges.verdict, ["good", "usable"]).sum()
    faint = np.isin(scene.edges.verdict, ["doubtful", "invalid"]) & (scene.edges.snr < 10)
    assert faint.any()
    measured = ((scene.edges.verdict != "rejected") & ~faint).sum()
    assert check.value == pytest.approx(trusted / measured)
    assert check.value < 0.15
    assert not check.passed
    assert scene.verdict.word == "doubtful"
    assert f"{measured} edges that could be measured" in check.message
    _, _, plain = ideal
    assert share_of(plain).value > 0.9


def test_a_scene_of_bare_samples_is_refused_in_words():
    bare, _ = simulate.landscape(
        ac.Sensor([ac.optics.Detector(0.3)]), shape=(280, 280),
        options=bare_ground(soft=0.0), rng=np.random.default_rng(3),
    )  # fmt: skip
    with pytest.raises(ac.FewEdgesError, match="0 of them can be used") as refused:
        ac.scan_scene(bare)
    # The most frequent reasons are in the message, each with how many edges it left out.
    edges = refused.value.edges
    _, named = str(refused.value).split("of the others ", 1)
    counts = re.findall(r"(\d+) (?:rejected|doubtful|invalid) \((?:[^()]+)\)", named)
    others = re.search(r"(\d+) for other reasons", named)
    assert 1 <= len(counts) <= 3
    assert counts == sorted(counts, key=int, reverse=True)
    assert sum(map(int, counts)) + (int(others[1]) if others else 0) == edges.size


def test_edges_are_written_as_parquet(ideal, tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    _, _, scene = ideal
    scene.edges.to_parquet(tmp_path / "edges.parquet", lambda row, col: (col / 1e4, 50 - row / 1e4))
    table = parquet.read_table(tmp_path / "edges.parquet")
    assert table.num_rows == scene.edges.size
    np.testing.assert_array_equal(table["row"].to_numpy(), scene.edges.row)
    np.testing.assert_array_equal(table["lat_deg"].to_numpy(), 50 - scene.edges.row / 1e4)
    assert table["used"].to_pylist() == scene.edges.used.tolist()
    assert table["reason"].to_pylist() == scene.edges.reason.tolist()
    assert table["softness_px"].null_count == int((~scene.edges.used).sum())
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ac.OptionError, match=r"pip install 'acutance\[parquet\]'"):
        scene.edges.to_parquet(tmp_path / "other.parquet")


def test_a_scene_is_combined_with_a_target(ideal):
    _, _, scene = ideal
    rng = np.random.default_rng(1)
    edge = ac.measure_edge(
        simulate.edge(SENSOR, angle_deg=8, shape=(60, 60), snr=100, rng=rng)[0], gsd_m=2.0
    )
    both = ac.combine([scene, edge])
    assert abs(both.across.mtf_nyquist.value - scene.across.mtf_nyquist.value) < 0.01


def test_objects_that_are_all_soft_by_different_amounts_open_the_interval():
    sensor = simulate.reference_systems()["diffraction"]
    options = simulate.LandscapeOptions(
        soft=1.0, softness_px=(0.0, 0.4), roofs=0.0, roads=0.0, discs=0.0, density_per_mpx=70
    )
    rng = np.random.default_rng(1)
    image, _ = simulate.landscape(sensor, shape=(700, 700), snr=60, options=options, rng=rng)
    scene = ac.scan_scene(image)
    terms = {(term.direction, term.name): term.share["mtf_nyquist"] for term in scene.budget}
    for name, u, v in (("across", 0.5, 0.0), ("along", 0.0, 0.5)):
        truth = abs(sensor.otf(np.array([u]), np.array([v]))[0])
        number = getattr(scene, name).mtf_nyquist
        assert abs(number.value - truth) < 2.5 * number.std
        assert number.std > 0.03 * truth
    assert max(terms[name, "shared_softness"] for name in ("across", "along")) > 0.1


def test_softness_of_one_direction_is_none_of_the_sensor():
    sensor = simulate.reference_systems()["diffraction"]
    options = simulate.LandscapeOptions(
        soft=1.0, softness_px=(0.0, 0.5), soft_normal_deg=(67.5, 112.5), density_per_mpx=70,
        roofs=0.0, roads=0.0, discs=0.0,
    )  # fmt: skip
    rng = np.random.default_rng(5)
    image, _ = simulate.landscape(sensor, shape=(700, 700), snr=80, options=options, rng=rng)
    scene = ac.scan_scene(image)
    truth = abs(sensor.otf(np.array([0.5]), np.array([0.0]))[0])
    for number in (scene.across.mtf_nyquist, scene.along.mtf_nyquist):
        assert abs(number.value - truth) < 2.5 * number.std
        assert number.std < 0.08 * truth
    edges = scene.edges
    along = np.abs(np.abs(edges.normal_deg[edges.used]) - 90) < 22.5
    assert edges.ideal[edges.used][~along].mean() > 0.9
    assert edges.ideal[edges.used][along].mean() < 0.6
    by_direction = {one.normal_deg: one for one in scene.ideal_by_direction}
    assert sum(one.edges for one in by_direction.values()) == edges.used.sum()
    assert by_direction[0.0].share.value > 0.9
    assert by_direction[90.0].share.value + by_direction[90.0].share.std < 0.8
    written = scene.to_dict()["ideal_by_direction"]
    assert [one["normal_deg"] for one in written] == list(by_direction)


def test_the_sensor_is_that_of_the_last_turn_where_its_form_has_several_optima():
    """Defocus and a kernel of five taps: the next optimum has .013 more at a fourth of a cycle."""
    taps = np.array([-0.1257, -0.1133, 1.4780, -0.1133, -0.1257])
    sensor = ac.Sensor([
        optics.Defocus(0.313, 1.09, 0.362), optics.Gaussian(0.144), optics.Detector(0.929),
        optics.Sharpening(tuple(map(tuple, np.outer(taps, taps)))),
    ])  # fmt: skip
    options = bare_ground(soft=0.0, density_per_mpx=110)
    image, _ = simulate.landscape(
        sensor, shape=(400, 400), snr=100, options=options, rng=np.random.default_rng(0)
    )
    scene = ac.scan_scene(image)
    for number, u, v in ((scene.across, 0.25, 0.0), (scene.along, 0.0, 0.25)):
        truth = abs(sensor.otf(np.array([u]), np.array([v]))[0])
        found = number.mtf(0.25)
        # Of this scene .004 and .010, the next optimum some .02.
        assert abs(found.value - truth) < 0.012
        assert abs(found.value - truth) < 3 * found.std
        assert found.std < 0.004


def test_no_edge_and_too_few_are_errors_that_say_what_was_found():
    rng = np.random.default_rng(0)
    with pytest.raises(ac.NoEdgeError, match="no straight edge stands out"):
        ac.scan_scene(rng.normal(100, 1, (200, 200)))
    one, _ = simulate.edge(SENSOR, angle_deg=8, shape=(200, 200), snr=100, rng=rng)
    with pytest.raises(ac.NoEdgeError, match="at least 8 are needed"):
        ac.scan_scene(one)


@pytest.mark.parametrize(
    "call",
    [
        lambda image: ac.scan_scene(image, workers=0),
        lambda image: ac.ScanOptions(min_length_px=1.0),
        lambda image: ac.ScanOptions(min_length_px=60.0, max_length_px=64.0),
        lambda image: ac.ScanOptions(limits={"unknown": 1.0}),
        lambda image: ac.ScanOptions(places=(0, 3)),
        lambda image: ac.scan_scene(image, options=ac.EdgeOptions()),
    ],
)
def test_options_that_mean_nothing_are_refused(call):
    with pytest.raises(ac.OptionError):
        call(np.zeros((50, 50)))
