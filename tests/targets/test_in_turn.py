"""Many regions: each as if it were measured alone, in its place, whatever the others are."""

import gc

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.targets import in_turn
from acutance.targets.in_turn import are_many
from acutance.targets.region import read_region

SENSOR = simulate.reference_systems()["gaussian"]
GOOD, SMALL, OUTSIDE, EMPTY = (0, 0, 40, 40), (0, 0, 4, 40), (30, 60, 40, 40), (0, 80, 40, 40)
REGIONS = [GOOD, SMALL, (0, 40, 40, 40), OUTSIDE, EMPTY]


@pytest.fixture(scope="module")
def scene():
    """Two edges side by side, then ground without any."""
    rng = np.random.default_rng(5)
    tiles = [
        simulate.edge(SENSOR, angle_deg=angle, shape=(40, 40), snr=100, rng=rng)[0]
        for angle in (6, 11)
    ]
    return np.hstack([*tiles, rng.normal(200, 10, (40, 40))])


def without_time(record):
    return {key: value for key, value in record.to_dict().items() if key != "measured_at"}


@pytest.mark.parametrize("workers", [1, 2])
def test_every_region_is_measured_as_alone_or_rejected_in_its_place(scene, workers):
    image = ac.Image.from_array(scene, gsd_m=0.5)
    found = ac.measure_edges(image, REGIONS, workers=workers)
    assert [type(one).__name__ for one in found] == [
        "Record", "Rejected", "Record", "Rejected", "Rejected",
    ]  # fmt: skip
    for place in (0, 2):
        alone = ac.measure_edge(image, REGIONS[place])
        assert without_time(found[place]) == without_time(alone.record)
        assert found[place].verdict == alone.verdict
    assert [one.stage for one in found if isinstance(one, ac.Rejected)] == [
        "region", "region", "fit",
    ]  # fmt: skip
    assert found[3].values == {"place": 3, "path": None, "roi": list(OUTSIDE)}


def test_regions_of_several_images_and_of_files(scene, tmp_path):
    path = tmp_path / "scene.npy"
    np.save(path, scene)
    pairs = [(scene, GOOD), (ac.open_image(path), (0, 40, 40, 40)), (scene[:, :40], None)]
    for workers in (1, 2):
        one, other, whole = ac.measure_edges(pairs, workers=workers)
        assert one.image.path is None
        assert other.image.path == str(path)
        assert one.across.mtf_nyquist == whole.across.mtf_nyquist
        assert one.across.mtf_nyquist != other.across.mtf_nyquist


def refilled(scene):
    """Two edges and again, in an array that is filled anew for every pair, and so is the region."""
    buffer, roi = np.empty((40, 40)), np.array(GOOD)
    for col in (0, 40, 0, 40):
        buffer[:] = scene[:, col : col + 40]
        roi[:] = GOOD
        yield buffer, roi
        buffer[:], roi[:] = 0.0, -1


def test_an_array_that_is_filled_anew_for_every_pair_is_measured_as_it_was(scene):
    first, second, *again = ac.each_edge(refilled(scene))
    for one, col in ((first, 0), (second, 40)):
        alone = ac.measure_edge(scene[:, col : col + 40].copy())
        assert without_time(one) == without_time(alone.record)
    assert [one.across.mtf_nyquist for one in again] == [
        one.across.mtf_nyquist for one in (first, second)
    ]


def test_what_waits_for_other_processes_is_as_it_was_and_leaves_no_file(scene, tmp_path):
    waiting = list(in_turn._of_pairs(refilled(scene), 0.5, tmp_path))
    assert len(list(tmp_path.iterdir())) == 4
    for place, one in enumerate(waiting):
        region = one.pixels()
        col = (0, 40)[place % 2]
        np.testing.assert_array_equal(region.pixels, scene[:, col : col + 40])
        assert (region.gsd.row_m, one.where["roi"]) == (0.5, list(GOOD))
    assert not list(tmp_path.iterdir())


def test_a_region_of_a_large_image_takes_its_surroundings_along_and_no_more(tmp_path):
    image = np.random.default_rng(1).normal(size=(500, 500))
    box = (100, 480, 60, 20)
    [one] = in_turn._of_pairs([(image, box)], None, tmp_path)
    assert next(tmp_path.iterdir()).stat().st_size < 100_000
    region = one.pixels()
    assert region.traces == read_region(image, box).traces
    np.testing.assert_array_equal(region.image.read(ac.Box(84, 464, 92, 36)), image[84:176, 464:])
    with pytest.raises(ac.RegionError):
        region.image.read()


def test_an_image_that_takes_the_place_of_another_is_not_taken_for_it(tmp_path):
    def pairs():
        for place in range(20):
            yield np.random.default_rng(place).normal(size=(8, 8)), None
            gc.collect(0)

    for place, one in enumerate(in_turn._of_pairs(pairs(), None, tmp_path)):
        expected = np.random.default_rng(place).normal(size=(8, 8))
        np.testing.assert_array_equal(one.pixels().pixels, expected)


def test_one_image_is_copied_once_for_all_its_regions(scene, tmp_path):
    waiting = list(in_turn._of_one(ac.Image.from_array(scene), REGIONS[:3], None, tmp_path))
    assert len(list(tmp_path.iterdir())) == 1
    np.testing.assert_array_equal(waiting[2].pixels().pixels, scene[:, 40:80])


def test_rows_of_numbers_are_regions_and_are_named_when_refused(scene):
    found, outside = ac.measure_edges(scene, np.array([GOOD, OUTSIDE]))
    assert isinstance(found, ac.Record)
    assert outside.values["roi"] == list(OUTSIDE)


def test_an_image_that_cannot_be_read_spoils_no_other(scene, tmp_path):
    path = tmp_path / "gone.npy"
    np.save(path, scene)
    gone = ac.open_image(path)
    path.unlink()
    lost, found = ac.measure_edges([(gone, GOOD), (scene, GOOD)])
    assert lost.stage == "image"
    assert lost.values["path"] == str(path)
    assert isinstance(found, ac.Record)


def test_regions_are_taken_as_they_are_needed(scene):
    taken = []

    def regions():
        for place in range(1000):
            taken.append(place)
            yield GOOD

    results = ac.each_edge(scene, regions())
    first, second = next(results), next(results)
    assert first.across.rer == second.across.rer
    assert len(taken) <= 3


def test_pulses_of_many_regions():
    rng = np.random.default_rng(3)
    tiles = [
        simulate.pulse(SENSOR, angle_deg=7, width_px=3.0, shape=(40, 36), snr=100, rng=rng)[0]
        for _ in range(2)
    ]
    image = np.hstack(tiles)
    regions = [(0, 0, 40, 36), (0, 36, 40, 36), (0, 0, 5, 36)]
    *found, small = ac.measure_pulses(image, regions, width_px=3.05)
    for one, roi in zip(found, regions, strict=False):
        alone = ac.measure_pulse(image, roi, width_px=3.05)
        assert without_time(one) == without_time(alone.record)
    assert small.stage == "region"


def test_nothing_to_measure_is_no_error(scene):
    assert ac.measure_edges(scene, []) == ()
    assert ac.measure_edges([(scene, None)])[0].kind == "edge"


@pytest.mark.parametrize(
    "call",
    [
        lambda image: ac.measure_edges(image, REGIONS, method="spleen"),
        lambda image: ac.measure_pulses(image, REGIONS, method="spleen"),
        lambda image: ac.measure_edges(image, REGIONS, options=ac.PulseOptions()),
        lambda image: ac.measure_edges(image, REGIONS, workers=0),
        lambda image: ac.measure_edges(image, REGIONS, workers="2"),
        lambda image: ac.measure_edges(image, REGIONS, workers=1.5),
        lambda image: ac.measure_edges(image, GOOD, workers=2),
    ],
)
def test_options_that_mean_nothing_are_refused_before_anything_is_measured(scene, call):
    with pytest.raises(ac.OptionError):
        call(scene)


@pytest.mark.parametrize(
    ("roi", "many"),
    [
        (None, False),
        (GOOD, False),
        (list(GOOD), False),
        ((1, 2, 3), False),
        (ac.Box(*GOOD), False),
        ("0,0,4,4", False),
        (np.array(GOOD), False),
        ([GOOD], True),
        ([GOOD, "nowhere"], True),
        ([], True),
        (np.array([GOOD]), True),
        (iter([GOOD]), True),
        ([None, ac.Box(*GOOD)], True),
    ],
)
def test_one_region_is_told_from_many(roi, many):
    assert are_many(np.zeros((50, 50)), roi) is many


def test_nested_lists_are_an_image():
    assert not are_many([[1.0, 2.0], [3.0, 4.0]], None)
