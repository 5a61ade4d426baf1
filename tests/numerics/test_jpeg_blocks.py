"""Images that were compressed by JPEG are known by the zeros of their blocks."""

import numpy as np
import pytest
from rasterio.io import MemoryFile
from scipy.fft import dctn

import acutance as ac
from acutance.numerics import jpeg_blocks as module
from acutance.numerics.jpeg_blocks import jpeg_blocks

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
SYSTEMS = ac.simulate.reference_systems()
LIMIT = ac.targets.QUESTIONS["jpeg_blocks"].limit


def noisy(seed, kind="edge", shape=(96, 96), snr=100.0, contrast=150.0):
    """An edge or a pulse in 8 bits, of a system and at an angle that change with the seed."""
    rng = np.random.default_rng(seed)
    system = SYSTEMS[sorted(SYSTEMS)[seed % len(SYSTEMS)]]
    draw = {"edge": ac.simulate.edge, "pulse": ac.simulate.pulse}[kind]
    image, _ = draw(
        system, angle_deg=rng.uniform(2, 40), shape=shape, dark=50.0, bright=50.0 + contrast,
        snr=snr, rng=rng,
    )  # fmt: skip
    return np.clip(np.rint(image), 0, 255)


def as_jpeg(image, quality):
    height, width = image.shape
    with MemoryFile() as memory:
        with memory.open(
            driver="JPEG", height=height, width=width, count=1, dtype="uint8", quality=quality
        ) as written:
            written.write(image.astype(np.uint8), 1)
        with memory.open() as read:
            return read.read(1).astype(float)


def cut(image, seed, side=48):
    """A part from the middle that begins anywhere in a block."""
    row, col = np.random.default_rng(seed).integers(20, 28, 2)
    return np.ascontiguousarray(image[row : row + side, col : col + side])


@pytest.mark.parametrize(
    ("quality", "snr", "least"),
    [(60, 30, 16), (60, 300, 15), (75, 100, 16), (75, 300, 15), (85, 100, 15), (90, 30, 16),
     (90, 100, 14), (90, 300, 11), (95, 30, 14)],
)  # fmt: skip
def test_blocks_are_found_wherever_they_begin(quality, snr, least):
    """Also where the ground is so quiet that most pixels equal their neighbours."""
    found = [
        jpeg_blocks(cut(as_jpeg(noisy(k, ("edge", "pulse")[k % 2], snr=snr), quality), k))
        for k in range(16)
    ]
    assert np.count_nonzero(np.array(found) > LIMIT) >= least


@pytest.mark.parametrize("snr", [None, 2000.0, 300.0, 100.0, 30.0])
@pytest.mark.parametrize("gain", [1.0, 8.0, 200.0])
def test_images_that_were_not_compressed_have_none(snr, gain):
    """Of 8, 11 and 16 bits, with noise far below a step of the numbers and above."""
    found = [
        jpeg_blocks(cut(np.rint(gain * noisy(k, ("edge", "pulse")[k % 2], snr=snr)), k))
        for k in range(20)
    ]
    assert max(found) < LIMIT


def test_levels_and_gains_of_columns_do_not_hide_blocks():
    compressed = as_jpeg(noisy(3, snr=60.0), 85)
    calibrated = compressed * np.random.default_rng(3).normal(1.0, 0.002, compressed.shape[1])
    plain = jpeg_blocks(cut(compressed, 3))
    assert jpeg_blocks(cut(0.037 * compressed - 2.0, 3)) == pytest.approx(plain, rel=1e-3)
    assert jpeg_blocks(cut(np.rint(calibrated), 3)) > LIMIT


def test_details_are_those_of_the_cosine_transform():
    image = np.random.default_rng(1).normal(0.0, 3.0, (19, 23))
    details, blocks = module._details_by_place(image, 1.0, 4.0)
    expected = np.zeros((8, 8))
    for row in range(12):
        for col in range(16):
            found = np.abs(dctn(image[row : row + 8, col : col + 8], norm="ortho"))
            found[0, 0] = 0.0
            expected[row % 8, col % 8] += np.count_nonzero(found >= 1.0) / 63
    assert details == pytest.approx(expected)
    assert blocks.sum() == 12 * 16


def test_missing_pixels_and_images_without_detail():
    image = cut(as_jpeg(noisy(1, snr=50.0), 80), 1)
    torn = image.copy()
    torn[20:24, 38:46] = np.nan
    assert jpeg_blocks(torn) > LIMIT
    assert jpeg_blocks(image[:15]) == 1.0
    assert jpeg_blocks(np.full((40, 40), np.nan)) == 1.0
    assert jpeg_blocks(np.full((40, 40), 7.0)) == 1.0
    assert jpeg_blocks(np.random.default_rng(0).normal(size=(40, 40))) == 1.0


def test_a_ground_of_rows_as_wide_as_blocks_is_none():
    image = cut(noisy(2, snr=50.0), 2)
    image += np.where(np.arange(48) % 8 < 4, 3.0, -3.0)[:, None]
    assert jpeg_blocks(image) < LIMIT
