"""Images interpolated onto a stretched or turned grid are known by the beats of their noise."""

import functools
import math

import numpy as np
import pytest
from test_jpeg_blocks import as_jpeg

from acutance import simulate
from acutance.numerics.periodic_noise import STEADY, periodic_noise

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
SYSTEMS = simulate.reference_systems()
SIDE = 256


@functools.cache
def ground(seed, side=SIDE, snr=60.0, **options):
    """A landscape of a system that changes with the seed."""
    image, _ = simulate.landscape(
        SYSTEMS[sorted(SYSTEMS)[seed % len(SYSTEMS)]], shape=(side, side), snr=snr,
        options=simulate.LandscapeOptions(**options), rng=np.random.default_rng(seed),
    )  # fmt: skip
    return image


def interpolated(image, zoom=1.0, turn_deg=0.0, kernel="cubic"):
    """The middle of an image on a grid that was stretched and turned about it."""
    turn, middle = math.radians(turn_deg), 0.5 * (image.shape[0] - 1)
    at = (np.arange(SIDE) - 0.5 * (SIDE - 1)) / zoom
    rows = math.cos(turn) * at[:, None] + math.sin(turn) * at + middle
    cols = math.cos(turn) * at - math.sin(turn) * at[:, None] + middle
    return simulate.resample(image, rows + 0.3, cols + 0.2, kernel=kernel)


@pytest.mark.parametrize("kernel", ["bilinear", "cubic"])
@pytest.mark.parametrize(
    ("zoom", "turn_deg", "beat_cpp"),
    [
        (0.9, 0.0, (1 / 0.9 - 1, 0.0)),
        (1.1, 0.0, (1 - 1 / 1.1, 0.0)),
        (1.25, 0.0, (0.2, 0.0)),
        (1.0, 5.0, (math.sin(math.radians(5)), 1 - math.cos(math.radians(5)))),
        (1.0, 15.0, (math.sin(math.radians(15)), 1 - math.cos(math.radians(15)))),
    ],
)
def test_the_beats_of_both_grids_are_found(kernel, zoom, turn_deg, beat_cpp):
    for seed, texture in ((0, (0.0, 0.0)), (1, (0.01, 0.04)), (2, (0.05, 0.15))):
        image = np.rint(interpolated(ground(seed, 400, texture=texture), zoom, turn_deg, kernel))
        found = periodic_noise([image])
        assert found.amplitude > 0.1
        first, second = np.array(found.beats_cpp)
        assert sorted(np.abs(first))[::-1] == pytest.approx(beat_cpp, abs=1.5 / SIDE)
        assert first @ second == 0.0
        assert np.linalg.norm(first) == pytest.approx(np.linalg.norm(second))


def test_a_grid_stretched_by_two_factors_has_two_periods():
    image, middle = ground(3, 400), 199.5
    at = np.arange(SIDE) - 0.5 * (SIDE - 1)
    stretched = simulate.resample(image, (at / 1.25 + middle)[:, None], at / 1.07 + middle)
    (down, none), (nothing, right) = periodic_noise([stretched]).beats_cpp
    assert none == nothing == 0.0
    assert (down, right) == pytest.approx((0.2, 1 - 1 / 1.07), abs=1 / SIDE)


@pytest.mark.parametrize("amplitude", [0.2, 0.3])
@pytest.mark.parametrize("cycles", [(0, 9), (0, 51), (18, 40)])
def test_the_amplitude_is_that_of_the_noise(amplitude, cycles):
    found = periodic_noise([varying(amplitude, *cycles)])
    # The variance of a second difference has those of three pixels, 1 : 4 : 1, both ways.
    left = np.prod((4 + 2 * np.cos(2 * np.pi * np.array(cycles) / SIDE)) / 6)
    assert found.amplitude == pytest.approx(amplitude * left, rel=0.15)
    assert sorted(map(abs, found.beats_cpp[0])) == pytest.approx(np.array(cycles) / SIDE)


def varying(amplitude, i, j, seed=4):
    """Noise whose standard deviation has two waves at right angles, so many cycles a side."""
    row, col = 2 * np.pi * np.mgrid[:SIDE, :SIDE] / SIDE
    waves = np.cos(i * row + j * col) + np.cos(j * row - i * col)
    return 500 + np.exp(amplitude * waves) * np.random.default_rng(seed).normal(size=row.shape)


def test_gains_levels_steps_and_missing_pixels_do_not_hide_them():
    image = interpolated(ground(1, 400), 1.1)
    plain = periodic_noise([image])
    scaled = periodic_noise([0.037 * image - 20.0])
    assert scaled.amplitude == pytest.approx(plain.amplitude)
    assert scaled.beats_cpp == plain.beats_cpp
    torn = np.rint(image)
    torn[100:140, 30:90] = np.nan
    assert periodic_noise([torn]).beats_cpp == plain.beats_cpp


@pytest.mark.parametrize("seed", range(12))
def test_landscapes_and_stripes_of_a_detector_have_none(seed):
    rng = np.random.default_rng(seed)
    texture = [(0.0, 0.0), (0.01, 0.04), (0.05, 0.15)][seed % 3]
    image = ground(seed, snr=[30, 100, 300][seed % 3], density_per_mpx=150, texture=texture)
    columns = np.resize(rng.normal(size=rng.integers(2, 30)), SIDE)
    noise = rng.normal(size=image.shape) * np.abs(rng.normal(1.0, 0.4, SIDE))
    assert periodic_noise([image]) == STEADY
    assert periodic_noise([np.rint(image * (1 + 0.01 * columns))]) == STEADY
    assert periodic_noise([image + 10 * np.exp(0.4 * columns) * rng.normal(size=image.shape)]) == (
        STEADY
    )
    assert periodic_noise([image + 10 * noise]) == STEADY


def test_blocks_of_jpeg_are_none():
    for seed, quality in enumerate((60, 75, 85, 90, 95, 98)):
        assert periodic_noise([as_jpeg(0.12 * ground(seed), quality)]) == STEADY


def test_what_one_part_in_four_has_is_of_the_ground():
    plain = [ground(seed) for seed in range(4)]
    beats = [interpolated(ground(seed, 400), 1.1) for seed in range(4)]
    assert periodic_noise([*plain[:3], beats[3]]) == STEADY
    found = periodic_noise([*plain[:1], *beats[1:]])
    assert found.beats_cpp == periodic_noise(beats).beats_cpp
    # Each has a beat of its own: no grid was stretched so.
    apart = [interpolated(ground(k, 400), zoom) for k, zoom in enumerate((1.06, 1.1, 1.2, 1.3))]
    assert periodic_noise(apart) == STEADY


def test_parts_without_noise_or_too_small_show_nothing():
    beats = interpolated(ground(1, 400), 1.1)
    nothing = [np.full((SIDE, SIDE), np.nan), np.full((SIDE, SIDE), 7.0), beats[:100]]
    assert periodic_noise(nothing) == STEADY
    assert periodic_noise([]) == STEADY
    # They do not count among the others.
    assert periodic_noise([*nothing, beats]).amplitude > 0.1
