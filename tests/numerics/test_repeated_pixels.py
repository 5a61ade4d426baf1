"""Nearest-neighbour resampling is known by pixels that repeat; nothing else looks like it."""

from functools import cache

import numpy as np
import pytest

import acutance as ac
from acutance.numerics.repeated_pixels import repeated_share

SYSTEMS = ac.simulate.reference_systems()
LIMIT = ac.targets.QUESTIONS["repeated_pixels"].limit
LEVELS = {"float": (200.0, 1200.0, 0.0), "8 bits": (50.0, 200.0, 1.0), "11 bits": (400, 1400, 1.0)}


def drawn(seed, levels, shape=(120, 120), snr=100.0):
    """An edge or a pulse, of a system and at an angle that change with the seed."""
    rng = np.random.default_rng(seed)
    system = SYSTEMS[sorted(SYSTEMS)[seed % len(SYSTEMS)]]
    dark, bright, step = LEVELS[levels]
    draw = (ac.simulate.edge, ac.simulate.pulse)[seed % 2]
    image, _ = draw(
        system, angle_deg=rng.uniform(3, 30), shape=shape, dark=dark, bright=bright, snr=snr,
        orientation=("across", "along")[seed // 2 % 2], rng=rng,
    )  # fmt: skip
    return np.rint(image) if step else image


def nearest(image, factor, turn_deg=0.0, shape=(56, 44), shift=(0.0, 0.0)):
    """The image enlarged about its middle and turned, each pixel the nearest old one."""
    rows, cols = np.indices(shape) - 0.5 * np.array(shape)[:, None, None]
    cos, sin = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    row = (cos * rows - sin * cols) / factor + shift[0] + 0.5 * image.shape[0]
    col = (sin * rows + cos * cols) / factor + shift[1] + 0.5 * image.shape[1]
    return image[np.rint(row).astype(int), np.rint(col).astype(int)]


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("factor", [1.05, 1.1, 1.25, 1.5, 2.0, 2.5])
def test_every_enlargement_is_found_and_its_share_with_it(levels, factor):
    shares = [
        repeated_share(nearest(drawn(k, levels, snr=30.0 * 2 ** (k % 3)), factor, shift=(0.1, 0.3)))
        for k in range(8)
    ]
    assert shares == pytest.approx([1 - 1 / factor] * 8, abs=0.04)


@pytest.mark.parametrize("turn_deg", [0.5, 1.0, 3.0, 10.0, 30.0])
@pytest.mark.parametrize("factor", [1.1, 1.3])
def test_a_grid_that_was_turned_repeats_too(turn_deg, factor):
    shares = [repeated_share(nearest(drawn(k, "11 bits"), factor, turn_deg)) for k in range(8)]
    assert min(shares) > LIMIT


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("snr", [None, 2000.0, 300.0, 100.0, 30.0])
def test_images_on_their_own_grid_do_not_repeat(levels, snr):
    """With noise far below a step of the numbers, where most neighbours are equal, and above."""
    assert not any(repeated_share(drawn(k, levels, (64, 48), snr)) for k in range(24))


def test_interpolated_images_do_not_repeat():
    sensor = SYSTEMS["gaussian"]
    for k, kernel in enumerate(("bilinear", "cubic") * 4):
        regrid = ac.simulate.Regrid(0.3, 0.4, (0.8, 1.0)[k % 2], kernel)
        image, _ = ac.simulate.edge(
            sensor, snr=50.0, regrid=regrid, rng=np.random.default_rng(k), shape=(60, 50)
        )
        assert repeated_share(np.rint(image)) == 0.0


def test_equal_rows_that_are_no_copies():
    rng = np.random.default_rng(4)
    noise = rng.normal(100.0, 3.0, (48, 48))
    filled = noise.copy()
    filled[20:22] = 0.0
    road = np.rint(noise)
    road[30:32, 5:40] = 255.0
    bars = np.tile(np.where(np.arange(48) // 3 % 2, 50.0, 200.0), (48, 1))
    bars[:20], bars[34:] = 120.0, 120.0
    aligned = np.tile(np.linspace(0, 100, 48), (48, 1))
    clipped = np.minimum(np.rint(noise), 99.0)
    quiet = np.rint(rng.normal(100.3, 0.25, (48, 48)))
    for image in (filled, road, bars, aligned, clipped, quiet, np.full((48, 48), 7.0)):
        assert repeated_share(image) == 0.0
        assert repeated_share(np.ascontiguousarray(image.T)) == 0.0


@cache
def star_of(name):
    star, _ = ac.simulate.star(SYSTEMS[name], cycles=36, radius_px=32.0, shape=(80, 80))
    return star


@cache
def bars_of(name, angle_deg):
    bars, _ = ac.simulate.bars(SYSTEMS[name], angle_deg=angle_deg)
    return bars


@pytest.mark.parametrize("angle_deg", [0.0, 3.0])
@pytest.mark.parametrize("step", [0.0, 1.0, 20.0])
def test_bars_and_stars_without_noise_do_not_repeat(angle_deg, step):
    """Rows on both sides of the middle of a bar are equal, and those next to them differ."""
    for name in SYSTEMS:
        for image in (star_of(name), bars_of(name, angle_deg)):
            assert repeated_share(np.round(image / step) * step if step else image) == 0.0


def test_one_copied_row_and_missing_pixels():
    image = np.random.default_rng(5).normal(size=(48, 48))
    image[20] = image[19]
    assert repeated_share(image) == pytest.approx(1 / 47, rel=0.1)
    image[:, 10:14] = np.nan
    assert repeated_share(image) > LIMIT
    assert repeated_share(np.full((40, 40), np.nan)) == 0.0
