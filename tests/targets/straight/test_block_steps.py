"""Images that were compressed in blocks of 8 x 8 pixels are known by their steps."""

import numpy as np
import pytest
from scipy.fft import dctn, idctn

import acutance as ac
from acutance.targets.straight.block_steps import block_steps

SENSOR = ac.simulate.reference_systems()["gaussian"]


def noisy_edge(seed, shape=(72, 72), snr=100.0):
    image, _ = ac.simulate.edge(
        SENSOR, angle_deg=7.0, shape=shape, dark=50.0, bright=200.0, snr=snr,
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return image


def in_blocks(image, step, first=(3, 6)):
    """Every block's cosine transform rounded, the finer the detail the more, as by JPEG."""
    found = image.copy()
    order = np.add.outer(np.arange(8), np.arange(8))
    for row in range(first[0], image.shape[0] - 7, 8):
        for col in range(first[1], image.shape[1] - 7, 8):
            part = slice(row, row + 8), slice(col, col + 8)
            rounded = step * (1 + order / 2)
            transform = np.rint(dctn(image[part], norm="ortho") / rounded) * rounded
            found[part] = idctn(transform, norm="ortho")
    return np.rint(found)


@pytest.mark.parametrize("seed", range(4))
def test_blocks_are_seen_wherever_they_begin(seed):
    image = noisy_edge(seed)
    first = tuple(np.random.default_rng(seed).integers(0, 8, 2).tolist())
    assert block_steps(image) < 1.3
    assert block_steps(in_blocks(image, 2.0, first)) > 1.5


def test_missing_pixels_and_small_regions():
    image = in_blocks(noisy_edge(1), 2.0)
    torn = image.copy()
    torn[20:30, 40:60] = np.nan
    assert block_steps(torn) == pytest.approx(block_steps(image), rel=0.1)
    dead = noisy_edge(1)
    dead[:, ::8] = np.nan
    assert 1.0 <= block_steps(dead) < 1.3
    assert block_steps(image[:31]) == 1.0
    assert block_steps(np.full((40, 40), np.nan)) == 1.0
    assert block_steps(np.full((40, 40), 7.0)) == 1.0


def test_a_ground_of_rows_as_wide_as_blocks_is_none():
    """Furrows lie along one direction, blocks along two."""
    image = noisy_edge(2, snr=50.0)
    image += np.where(np.arange(72) % 8 < 4, 3.0, -3.0)[:, None]
    assert block_steps(image) < 1.5


def test_an_edge_in_a_compressed_image_is_doubtful():
    image = noisy_edge(3)
    assert ac.measure_edge(image).trusted
    found = ac.measure_edge(in_blocks(image, 3.0))
    assert "block_steps" in [check.name for check in found.failed_checks]
    assert found.verdict.warns
