"""Several bands at once: the same edges in each, and the shift between them."""

from dataclasses import dataclass

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.raster import Box
from acutance.scan.band_pieces import Unseen, band_pieces, in_band
from acutance.scan.edge_points import gradient
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


def two_bands(seed, size=400, density=120):
    """One landscape in two bands, the second displaced, each with noise of its own."""
    options = simulate.LandscapeOptions(density_per_mpx=density, texture=(0.0, 0.0))
    noise = np.random.default_rng(1000 + seed)
    return [
        simulate.landscape(
            sensor, shape=(size, size), options=options, rng=np.random.default_rng(seed)
        )[0]
        + noise.normal(0, NOISE, (size, size))
        for sensor in (SENSOR, MOVED)
    ]


@pytest.fixture(scope="module")
def bands():
    return two_bands(3)


@pytest.fixture(scope="module")
def found(bands):
    return ac.scan_bands(bands)


def test_one_band_is_a_scene(bands):
    scene, several = ac.scan_scene(bands[0]), ac.scan_bands(bands[:1])
    for name, column in scene.edges.columns().items():
        np.testing.assert_array_equal(column, several.scenes["1"].edges.columns()[name])
    assert several.scenes["1"].across.mtf_nyquist == scene.across.mtf_nyquist
    assert several.shifts == {}


def test_all_bands_have_the_same_edges(bands, found):
    first, other = (scene.edges for scene in found.measurements)
    assert first.size == other.size
    both = first.used & other.used
    assert both.sum() > 0.9 * first.used.sum()
    away = np.hypot(first.row - other.row, first.col - other.col)[both]
    assert np.median(away) < 0.5
    alone = ac.scan_scene(bands[0])
    assert both.sum() > 0.9 * alone.edges.used.sum()
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.array([0.0])))[0])
    for scene in found.measurements:
        number = scene.across.mtf_nyquist
        assert abs(number.value - expected) < 3 * number.std


def test_a_band_of_opposite_contrast_is_measured_and_placed_the_same(bands, found):
    turned = ac.scan_bands([bands[0], 3000.0 - bands[1]])
    first, other = (scene.edges for scene in turned.measurements)
    both = first.used & other.used
    turn = np.abs((first.normal_deg - other.normal_deg)[both] % 360 - 180)
    assert turn.max() < 5
    assert both.sum() > 0.9 * first.used.sum()
    one, same = turned.shifts["2"], found.shifts["2"]
    assert abs(one.row_px.value - same.row_px.value) < one.row_px.std
    assert abs(one.col_px.value - same.col_px.value) < one.col_px.std


def test_the_deviation_of_the_shift_is_true():
    off = []
    for seed in range(100, 112):
        shift = ac.scan_bands(two_bands(seed, 300, 150)).shifts["2"]
        assert shift.row_px.std < 0.006
        assert shift.scatter_px < 0.005
        for number, true in zip((shift.row_px, shift.col_px), SHIFT, strict=True):
            off.append((number.value - true) / number.std)
    # Of 24 normal deviates: the chance of being outside is one in a hundred on either side.
    assert 0.66 < np.sqrt(np.mean(np.square(off))) < 1.34
    assert abs(np.mean(off)) < 0.55


def test_a_band_that_shows_an_edge_less_has_no_part_in_it(bands):
    """Half of the second band is empty: its edges are found in the first, and said to be unseen."""
    half = bands[1].copy()
    half[:, 200:] = 100.0 + np.random.default_rng(5).normal(0, NOISE, half[:, 200:].shape)
    several = ac.scan_bands([bands[0], half])
    first, other = (scene.edges for scene in several.measurements)
    far = first.used & (first.col > 215)
    assert far.sum() > 10
    assert not other.used[far].any()
    assert all("differ too little in this band" in reason for reason in other.reason[far])
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


def test_a_band_without_edges_is_rejected_and_the_others_stay(bands):
    empty = np.random.default_rng(1).normal(100, 1, bands[0].shape)
    several = ac.scan_bands(np.array([bands[0], empty]))
    assert list(several.scenes) == ["1"]
    (rejected,) = several.rejected
    assert rejected.values == {"band": "2"}
    assert "at least 8 are needed" in rejected.reason
    with pytest.raises(ac.NoEdgeError, match="none of the 2 bands"):
        ac.scan_bands([empty, empty + 1])


def test_the_table_of_edges_has_a_row_of_every_band(found):
    columns = found.edges.columns()
    size = found.scenes["1"].edges.size
    assert columns["band"].tolist() == ["1"] * size + ["2"] * size
    assert found.edges.to_csv().startswith("band,row,col")
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
