"""Several bands at once: the same edges in each, and the shift between them."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.raster import Box
from acutance.report.bands import bands_document, bands_page, bands_text
from acutance.scan.all_windows import scan_windows
from acutance.scan.band_pieces import Unseen, band_pieces, in_band
from acutance.scan.band_shift import band_shift
from acutance.scan.edge_points import gradient
from acutance.scan.scene import edges_seen
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.sensor_fit import fit_sensor
from acutance.scan.windows import Window

SENSOR = simulate.reference_systems()["gaussian"]
SHIFT = (0.3, -0.17)
NOISE = 8.0


@dataclass(frozen=True)
class Displaced:
    """A block that displaces the image, in pixels."""

    row_px: float
    col_px: float

    def otf(self, u, v):
        return np.exp(-2j * np.pi * (u * self.col_px + v * self.row_px))


MOVED = ac.Sensor([*SENSOR.blocks, Displaced(*SHIFT)])


@cache
def noise_free(seed, size, density):
    """One landscape in two bands, the second displaced."""
    options = simulate.LandscapeOptions(density_per_mpx=density, texture=(0.0, 0.0))
    return [
        simulate.landscape(
            sensor, shape=(size, size), options=options, rng=np.random.default_rng(seed)
        )[0]
        for sensor in (SENSOR, MOVED)
    ]


def two_bands(seed, size=400, density=120, noise_seed=0):
    """Both bands, each with noise of its own."""
    noise = np.random.default_rng(1000 + seed + noise_seed)
    bands = noise_free(seed, size, density)
    return [one + noise.normal(0, NOISE, (size, size)) for one in bands]


@pytest.fixture(scope="module")
def bands():
    return two_bands(3)


@pytest.fixture(scope="module")
def found(bands):
    return ac.scan_bands(bands, workers=2)


@pytest.fixture(scope="module")
def alone(bands, few_forms):
    """The first band as a scene."""
    with few_forms():
        return ac.scan_scene(bands[0])


def test_one_band_is_a_scene(bands, alone, few_forms):
    with few_forms():
        whole = ac.Region.from_box(ac.Box.whole(bands[0].shape))
        several = ac.scan_bands(bands[:1], roi=replace(whole, name="La Crau"))
    assert several.scenes["1"].image.region == "La Crau"
    for name, column in alone.edges.columns().items():
        np.testing.assert_array_equal(column, several.scenes["1"].edges.columns()[name])
    assert several.scenes["1"].across.mtf_nyquist == alone.across.mtf_nyquist
    assert several.shifts == {}


def test_all_bands_have_the_same_edges(found, alone):
    first, other = (scene.edges for scene in found.measurements)
    assert first.size == other.size
    both = first.used & other.used
    assert both.sum() > 0.9 * first.used.sum()
    away = np.hypot(first.row - other.row, first.col - other.col)[both]
    assert np.median(away) < 0.5
    assert both.sum() > 0.9 * alone.edges.used.sum()
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    for scene in found.measurements:
        number = scene.across.mtf_nyquist
        assert abs(number.value - expected) < 3 * number.std


def test_a_band_whose_sensor_another_process_fits_is_the_same(bands, found):
    images, options = [ac.Image.of(one) for one in bands], ac.ScanOptions()
    box = Box.whole(images[1].shape)
    windows = scan_windows(images, box, None, gsd=None, options=options)
    edges, seen = edges_seen(images[1], box, options, [both[1] for both in windows])
    here, there = fit_sensor(seen), found.scenes["2"].details
    np.testing.assert_array_equal(edges.row, found.scenes["2"].edges.row)
    assert [one.parameters.tolist() for one in here.combined.forms] == [
        one.parameters.tolist() for one in there.combined.forms
    ]
    np.testing.assert_array_equal(here.member.mean_px, there.member.mean_px)


def test_a_band_of_opposite_contrast_is_measured_and_placed_the_same(bands, found, few_forms):
    with few_forms():
        turned = ac.scan_bands([bands[0], 3000.0 - bands[1]])
    first, other = (scene.edges for scene in turned.measurements)
    both = first.used & other.used
    turn = np.abs((first.normal_deg - other.normal_deg)[both] % 360 - 180)
    assert turn.max() < 5
    assert both.sum() > 0.9 * first.used.sum()
    one, same = turned.shifts["2"], found.shifts["2"]
    assert abs(one.row_px.value - same.row_px.value) < one.row_px.std
    assert abs(one.col_px.value - same.col_px.value) < one.col_px.std


def shift_of(bands):
    """The shift alone, without the sensors of the bands."""
    images = [ac.Image.of(one) for one in bands]
    box = Box.whole(images[0].shape)
    found = scan_windows(images, box, None, gsd=None, options=ac.ScanOptions())
    first, other = (
        SceneEdges.of_rows([row for window in found for row in window[band].rows])
        for band in range(2)
    )
    return band_shift(first, other)


def test_the_deviation_of_the_shift_is_true():
    off = []
    for number in range(12):
        # Drawing takes as long as measuring: four draws of the noise over each of three scenes.
        shift = shift_of(two_bands(200 + number % 3, 300, 150, number))
        assert max(shift.row_px.std, shift.col_px.std) < 0.01
        assert shift.scatter_px < 0.02
        for found, true in zip((shift.row_px, shift.col_px), SHIFT, strict=True):
            off.append((found.value - true) / found.std)
    # Of 24 normal deviates: the chance of being outside is one in a hundred on either side.
    assert 0.66 < np.sqrt(np.mean(np.square(off))) < 1.34
    assert abs(np.mean(off)) < 0.5


def test_equal_bands_have_no_shift():
    shift = shift_of([two_bands(3, 300, 150)[0]] * 2)
    assert (shift.row_px.value, shift.col_px.value, shift.correlation) == (0.0, 0.0, 0.0)


def test_objects_that_differ_between_bands_widen_the_shift():
    """Places of drawn edges: half of them scatter, and a tenth are far away."""
    rng = np.random.default_rng(4)
    off = []
    for _ in range(200):
        count = 60
        angle = rng.uniform(-180, 180, count)
        away = rng.normal(0, 0.01, count) + np.where(rng.random(count) < 0.5, 0.05, 0.0) * (
            rng.normal(0, 1, count)
        )
        away[:6] += 1.0
        normal = np.radians(angle)
        rows = [
            {"normal_deg": one, "place_std_px": 0.007, "used": True} for one in angle
        ]  # fmt: skip
        first = SceneEdges.of_rows([row | {"row": 0.0, "col": 0.0} for row in rows])
        moved = away + SHIFT[0] * np.sin(normal) + SHIFT[1] * np.cos(normal)
        other = SceneEdges.of_rows([
            row | {"row": here * np.sin(one), "col": here * np.cos(one)}
            for row, here, one in zip(rows, moved, normal, strict=True)
        ])  # fmt: skip
        shift = band_shift(first, other)
        assert 0.005 < shift.scatter_px < 0.08
        off.append((shift.row_px.value - SHIFT[0]) / shift.row_px.std)
    assert 0.85 < np.std(off) < 1.18
    assert abs(np.mean(off)) < 0.25


def test_edges_of_one_direction_or_too_few_show_no_shift():
    rows = [
        {"normal_deg": 5.0, "place_std_px": 0.01, "used": True, "row": 0.0, "col": float(i)}
        for i in range(20)
    ]
    edges = SceneEdges.of_rows(rows)
    with pytest.raises(ac.NoEdgeError, match="the 20 edges that both bands use have nearly one"):
        band_shift(edges, edges)
    few = SceneEdges.of_rows([row | {"normal_deg": 50.0 * i} for i, row in enumerate(rows[:7])])
    with pytest.raises(ac.NoEdgeError, match="share 7 edges that both use, and a shift needs 8"):
        band_shift(few, few)


def test_a_band_that_shows_an_edge_less_has_no_part_in_it(bands, few_forms):
    """Half of the second band is empty: edges there are found in the first, and are unseen."""
    half = bands[1].copy()
    half[:, 200:] = 100.0 + np.random.default_rng(5).normal(0, NOISE, half[:, 200:].shape)
    with few_forms():
        several = ac.scan_bands([bands[0], half])
    first, other = (scene.edges for scene in several.measurements)
    far = first.used & (first.col > 215)
    assert far.sum() > 10
    assert not other.used[far].any()
    unseen = ["differ too little in this band" in reason for reason in other.reason[far]]
    assert np.mean(unseen) > 0.9
    near = first.used & (first.col < 180)
    assert other.used[near].mean() > 0.9


def test_an_edge_of_one_band_alone_is_found_once_and_cut_where_another_has_it():
    rng = np.random.default_rng(1)
    image, _ = simulate.edge(SENSOR, angle_deg=8, shape=(160, 160), snr=50, rng=rng)
    half = image.copy()
    half[80:] = image[:80].mean()
    both = [gradient(image), gradient(0.5 * half)]
    box = Box(0, 0, 160, 160)
    pieces = band_pieces(both, Window(box, box), ac.ScanOptions())
    assert {piece.band for piece in pieces} >= {0}
    length = sum(one.segment.stop_px - one.segment.start_px for one in pieces if one.band == 0)
    assert length == pytest.approx(160 / np.cos(np.radians(8)), abs=15)
    upright = [one for one in pieces if one.band == 1 and abs(one.segment.line.angle_deg - 8) < 4]
    assert upright == []
    seen = list(in_band(pieces, 1, both[1], ac.ScanOptions()))
    assert any(isinstance(one, Unseen) for one in seen)


def test_a_band_without_a_shift_has_the_reason_in_every_output(bands, few_forms, undrawn):
    """Each half of the scene is seen by one of the bands."""
    left, right = (band.copy() for band in bands)
    left[:, 200:] = 100.0 + np.random.default_rng(5).normal(0, NOISE, left[:, 200:].shape)
    right[:, :200] = 100.0 + np.random.default_rng(6).normal(0, NOISE, right[:, :200].shape)
    with few_forms():
        several = ac.scan_bands([left, right])
    assert several.shifts == {}
    (reason,) = several.unshifted
    assert reason.values == {"band": "2"}
    assert "that both use, and a shift needs 8" in reason.reason
    assert f"band 2: no shift: {reason.reason}" in bands_text(several)
    assert f"Band 2 – No shift: {reason.reason}" in bands_page(several)
    assert bands_document(several)["unshifted"][0]["reason"] == reason.reason


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_band_without_edges_is_rejected_and_the_others_stay(bands, noise, few_forms, undrawn):
    empty = np.random.default_rng(1).normal(100, noise, bands[0].shape)
    seen = []
    with few_forms():
        several = ac.scan_bands(
            np.array([bands[0], empty]), progress=lambda *numbers: seen.append(numbers)
        )
    # One window, and then each band, whose fit takes most of the time.
    assert seen == [(1, 3), (2, 3), (3, 3)]
    assert list(several.scenes) == ["1"]
    (rejected,) = several.rejected
    assert rejected.values == {"band": "2"}
    assert "at least 8 are needed" in rejected.reason
    assert f"none of the {several.scenes['1'].edges.size} straight edges" in rejected.reason
    assert bands_text(several).startswith("scene in 1 of 2 bands\n")
    assert "<title>Scene in 1 of 2 bands" in bands_page(several)
    with pytest.raises(ac.NoEdgeError, match="none of the 2 bands"):
        ac.scan_bands([empty, empty + 1])


def test_the_table_of_edges_has_a_row_of_every_band(found):
    columns = found.edges.columns()
    size = found.scenes["1"].edges.size
    assert columns["band"].tolist() == ["1"] * size + ["2"] * size
    assert len(found.edges) == found.edges.to_pandas().shape[0] == 2 * size
    assert found.edges.to_csv().startswith("band,row,col")
    with pytest.raises(ac.OptionError, match=r"lonlat is 'x\.csv': .*write_text\(edges\.to_csv"):
        found.edges.to_csv("x.csv")
    with pytest.raises(ac.OptionError, match="give a function"):
        found.edges.to_geojson("x.geojson")
    assert len(found.edges.to_geojson()["features"]) == 2 * size


@pytest.mark.parametrize(
    ("images", "bands", "message"),
    [
        ([np.zeros((50, 50)), np.zeros((50, 60))], None, "differ in shape"),
        ([np.zeros((50, 50))], [2], "band 2 was requested of 1"),
        ([np.zeros((50, 50))], [], "band none was requested"),
        (ac.Image.from_array(np.zeros((50, 50))), None, "the image is one band"),
    ],
)
def test_bands_that_do_not_go_together_are_refused(images, bands, message):
    with pytest.raises(ac.ImageError, match=message):
        ac.scan_bands(images, bands)


def test_every_band_answers_what_is_required(found, undrawn):
    required = ["along.mtf_nyquist >= 0.9"]
    text, page = bands_text(found, required=required), bands_page(found, required=required)
    document = bands_document(found, required=required)
    for name, one in zip(found.scenes, document["results"], strict=True):
        (answer,) = one["requirements"]
        assert answer["word"] == "not met"
        assert f"Band {name}: required\n  {answer['summary']}" in text
        assert f"Band {name} – Required along: mtf_nyquist &gt;= 0.9 is not met" in page
