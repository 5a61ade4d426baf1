"""What processing left in the pixels is named, whatever the target: a scene, a pair, a region."""

from functools import cache

import numpy as np
import pytest
from rasterio.io import MemoryFile

import acutance as ac
from acutance import optics, simulate
from acutance.targets import region
from acutance.targets.kinds import KINDS
from acutance.targets.processing_checks import PROCESSING_CHECKS
from acutance.targets.processing_traces import sample_boxes

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])


def enlarged(image, factor=1.25):
    """Every pixel the nearest one of the old grid."""
    rows, cols = (np.floor(np.arange(int(size * factor)) / factor) for size in image.shape)
    return image[rows.astype(int)[:, None], cols.astype(int)]


def as_jpeg(image, quality=80):
    """The image in 8 bits, compressed."""
    level = np.rint(np.interp(image, (image.min(), image.max()), (20, 230))).astype(np.uint8)
    height, width = image.shape
    with MemoryFile() as memory:
        with memory.open(
            driver="JPEG", height=height, width=width, count=1, dtype="uint8", quality=quality
        ) as written:
            written.write(level, 1)
        with memory.open() as read:
            return read.read(1).astype(float)


def failed(found):
    return {check.name for check in found.failed_checks} & set(PROCESSING_CHECKS)


@cache
def scenes():
    rng = np.random.default_rng(1)
    return {
        "edge": simulate.edge(SENSOR, shape=(64, 64), snr=60, rng=rng)[0],
        "pulse": simulate.pulse(
            SENSOR, width_px=3.3, angle_deg=6.0, shape=(60, 60), snr=60, rng=rng
        )[0],
        "bars": simulate.bars(SENSOR, snr=60, rng=rng)[0],
        "star": simulate.star(
            SENSOR, cycles=36, radius_px=32.0, shape=(80, 80), snr=60, rng=rng
        )[0],
        "points": simulate.points(SENSOR, snr=60, rng=rng)[0],
    }  # fmt: skip


@pytest.mark.parametrize("kind", scenes())
def test_every_kind_of_target_names_them(kind):
    measure, image = KINDS[kind].load(KINDS[kind].measure), scenes()[kind]
    assert not failed(measure(np.rint(image)))
    copied = image.copy()
    for row in range(5, image.shape[0] - 5, 20):
        copied[row] = copied[row + 1]
    found = measure(copied)
    assert failed(found) == {"repeated_pixels"}
    compressed = measure(as_jpeg(image))
    assert failed(compressed) == {"jpeg_blocks"}
    for one in (found, compressed):
        assert one.verdict.warns


@pytest.mark.parametrize("kind", ["edge", "pulse"])
@pytest.mark.parametrize("factor", [1.1, 1.25, 1.5, 2.0])
def test_no_enlarged_edge_or_pulse_passes(kind, factor):
    measure = KINDS[kind].load(KINDS[kind].measure)
    for system in simulate.reference_systems().values():
        draw = {"edge": simulate.edge, "pulse": simulate.pulse}[kind]
        image, _ = draw(
            system, angle_deg=8.0, shape=(56, 48), snr=100, rng=np.random.default_rng(2)
        )
        try:
            assert measure(enlarged(image, factor)).verdict.warns
        except ac.TargetError:
            continue


def test_either_image_of_a_pair_counts():
    sharp = simulate.reference_systems()["gaussian"]
    low, high, _ = simulate.pair(
        SENSOR, sharp, ratio=3.0, shape=(80, 80), snr=100, rng=np.random.default_rng(0)
    )
    assert not failed(ac.measure_biresolution(low, high, ratio=3))
    copied = high.copy()
    copied[1::2] = copied[::2]
    assert failed(ac.measure_biresolution(low, copied, ratio=3)) == {"repeated_pixels"}
    low[40] = low[39]
    assert failed(ac.measure_biresolution(low, high, ratio=3)) == {"repeated_pixels"}


@pytest.fixture(scope="module")
def ground():
    """A landscape, larger than what is scanned of it."""
    return simulate.landscape(SENSOR, shape=(470, 470), snr=60, rng=np.random.default_rng(5))[0]


@pytest.fixture(scope="module")
def plain(ground, few_forms):
    """A scan of whole numbers that nothing was done to."""
    with few_forms():
        return ac.scan_scene(np.rint(ground[:400, :400]), workers=1)


def test_scenes_are_asked_once_and_not_by_their_edges(plain, few_forms):
    image, _ = simulate.landscape(SENSOR, shape=(400, 400), snr=60, rng=np.random.default_rng(3))
    written = ac.Image.from_array(as_jpeg(image, 85), gsd_m=0.5)
    with few_forms():
        compressed = ac.scan_scene(written, gsd_m=30.0, workers=1)
    assert not failed(plain)
    assert failed(compressed) == {"jpeg_blocks"}
    assert "stated_gsd" in {check.name for check in compressed.failed_checks}
    assert compressed.verdict.word == "doubtful"
    assert not any("JPEG" in reason for reason in compressed.edges.reason)


def test_an_interpolated_scene_says_by_how_much(ground, plain, few_forms):
    at = np.arange(400) / 1.1 + 50.0
    enlarged_image = simulate.resample(ground, at[:, None], at, kernel="cubic")
    with few_forms():
        found = ac.scan_scene(enlarged_image, workers=1)
    (check,) = (one for one in found.checks if one.name == "periodic_noise")
    assert not check.passed
    assert check.severity == "note"
    assert 0.2 < check.value < 0.5
    assert "periods of 11.1 and 11.1 px" in check.message
    assert "to 1.10 or 0.92 times its size, or turned by 5 degrees" in check.message
    assert found.verdict.word == "usable"
    (check,) = (one for one in plain.checks if one.name == "periodic_noise")
    assert check.passed
    assert check.value == 0.0
    assert "the noise does not vary periodically" in check.message


def test_an_enlarged_scene_without_edges_says_why():
    image, _ = simulate.landscape(SENSOR, shape=(200, 200), snr=60, rng=np.random.default_rng(3))
    with pytest.raises(ac.FewEdgesError, match=r"\d % of the pixels repeat .* the nearest pixel"):
        ac.scan_scene(enlarged(image))


def test_the_pixels_of_a_region_are_looked_at_once_for_all_its_edges(monkeypatch):
    looked, traces = [], region.traces_of_pixels
    monkeypatch.setattr(
        region, "traces_of_pixels", lambda pixels: looked.append(1) or traces(pixels)
    )
    image = simulate.checkerboard(SENSOR, snr=100, rng=np.random.default_rng(4)).image
    edges = ac.measure_edges(image).measurements
    assert not any(failed(edge) for edge in edges)
    assert (len(edges), len(looked)) == (4, 1)


def test_compression_shows_around_a_region_too_small_to_show_it():
    named, alone = [], []
    for seed in range(8):
        image, _ = simulate.edge(
            SENSOR, angle_deg=8, shape=(64, 64), snr=80, rng=np.random.default_rng(seed)
        )
        written, roi = as_jpeg(image, 90), (20, 19, 24, 27)
        named.append(bool(failed(ac.measure_edge(written, roi))))
        cut = written[20:44, 19:46]
        alone.append(bool(failed(ac.measure_edge(cut))))
        assert not failed(ac.measure_edge(np.rint(image), roi))
    assert all(named)
    # Without what surrounds it none of them is.
    assert not any(alone)


def test_large_images_are_sampled_all_over():
    boxes = list(sample_boxes(ac.Box(100, 50, 5000, 300)))
    assert [box.row for box in boxes[::2]] == [891, 2472, 4053]
    assert {(box.height, box.width) for box in boxes} == {(256, 256)}
    assert min(box.col for box in boxes) >= 50
    assert max(box.col + box.width for box in boxes) <= 350
    small = ac.Box(3, 4, 60, 40)
    assert list(sample_boxes(small)) == [small]
