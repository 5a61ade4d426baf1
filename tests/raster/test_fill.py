"""Fill that is not declared is found; what a sensor or a simulation leaves constant is not."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

import acutance.simulate as sim
from acutance.raster import Box, Image, find_fill, open_image, value_far_off

SYSTEMS = sim.reference_systems()


def ground(shape=(90, 110), level=900.0, seed=1):
    """Textured ground: smooth structure of 10 % and noise of 2 %."""
    rng = np.random.default_rng(seed)
    rows, cols = np.indices(shape)
    waves = sum(
        np.sin(rng.uniform(0.05, 0.3) * rows + rng.uniform(0.05, 0.3) * cols + phase)
        for phase in rng.uniform(0, 6, 4)
    )
    return level * (1 + 0.05 * waves + 0.02 * rng.normal(size=shape))


def beyond(shape, angle_deg=20.0, share=0.35):
    """The pixels beyond a straight line: a corner of a warped image."""
    rows, cols = np.indices(shape)
    along = np.cos(np.radians(angle_deg)) * cols + np.sin(np.radians(angle_deg)) * rows
    return along > np.quantile(along, 1 - share)


def found(pixels, box=None):
    image = Image.from_array(pixels)
    box = box or Box.whole(image.shape)
    return find_fill(image, box, image.read(box))


@dataclass(frozen=True)
class CountedPixels:
    """A source of pixels that keeps the boxes it is asked for."""

    array: np.ndarray
    boxes: list[Box] = field(default_factory=list)

    def read(self, box):
        self.boxes.append(box)
        return self.array[box.slices].astype(float)


@pytest.mark.parametrize("value", [0.0, 65535.0, -9999.5])
@pytest.mark.parametrize("angle_deg", [0.0, 7.0, 33.0, 160.0, 271.0])
def test_a_corner_of_one_value_is_fill(angle_deg, value):
    pixels = ground()
    corner = beyond(pixels.shape, angle_deg)
    pixels[corner] = value
    fill = found(pixels)
    assert fill.value == value
    assert np.array_equal(fill.mask, corner)
    assert fill.count == np.count_nonzero(corner)


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "int16"])
def test_fill_of_integer_images_is_found(dtype):
    pixels = ground(level=90.0)
    corner = beyond(pixels.shape)
    pixels[corner] = 0
    fill = found(np.round(pixels).astype(dtype))
    assert np.array_equal(fill.mask, corner)


def test_a_box_far_from_the_border_reads_single_lines_only():
    pixels = ground((600, 700))
    corner = beyond(pixels.shape, 10.0, 0.4)
    pixels[corner] = 0.0
    source = CountedPixels(pixels)
    image = Image(None, 1, 1, pixels.shape, "float64", source)
    row = 300
    box = Box(row - 20, int(np.argmax(corner[row])) - 20, 40, 40)
    fill = find_fill(image, box, image.read(box))
    assert np.array_equal(fill.mask, corner[box.slices])
    frame, *lines = source.boxes[1:]
    assert frame.height * frame.width <= 72 * 72
    assert lines
    assert all(min(line.shape) == 1 for line in lines)


def test_a_constant_island_is_no_fill():
    pixels = ground()
    pixels[30:60, 40:80] = 0.0
    assert found(pixels) is None


def test_a_constant_part_that_ends_outside_the_box_is_no_fill():
    pixels = ground((200, 200))
    pixels[60:140, 60:140] = 0.0
    assert found(pixels, Box(100, 100, 60, 60)) is None


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("dark", [0.0, 20.0])
def test_sides_of_a_noise_free_edge_are_no_fill(system, dark):
    image, _ = sim.edge(SYSTEMS[system], angle_deg=6.0, shape=(60, 60), dark=dark, bright=220.0)
    assert found(image) is None
    assert found(np.round(image).clip(0, 255).astype(np.uint8)) is None


@pytest.mark.parametrize("system", ["gaussian", "defocused", "wide"])
def test_dark_flat_water_of_an_8_bit_image_is_no_fill(system):
    """One side is exactly 3, the other textured and noisy, as coasts are."""
    image, _ = sim.edge(SYSTEMS[system], angle_deg=8.0, shape=(80, 80), dark=3.0, bright=120.0)
    land = (image - 3.0) / 117.0
    rough = image + land * (ground(image.shape, 120.0, seed=4) - 120.0)
    pixels = np.round(rough).astype(np.uint8)
    assert np.mean(pixels == 3) > 0.3
    assert found(pixels) is None


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("system", ["gaussian", "diffraction", "smeared"])
def test_a_clipped_roof_is_no_fill(system, share):
    rng = np.random.default_rng(7)
    image, _ = sim.edge(
        SYSTEMS[system], angle_deg=12.0, shape=(70, 70), dark=200.0, bright=1200.0, snr=60, rng=rng
    )
    clipped = np.minimum(image, 200.0 + 1000.0 * share)
    assert found(clipped) is None
    assert found(np.round(clipped).astype(np.uint16)) is None


def test_clean_and_clipped_edges_are_hardly_ever_taken_for_fill():
    """Of 150 random ones, half of them clipped anywhere: those clipped deeply and sharpened."""
    rng = np.random.default_rng(20)
    wrong = 0
    for _ in range(150):
        name = str(rng.choice(list(SYSTEMS)))
        contrast = float(np.exp(rng.uniform(np.log(10), np.log(8000))))
        image, _ = sim.edge(
            SYSTEMS[name], angle_deg=float(rng.uniform(0, 45)), shape=(40, 40), dark=100.0,
            bright=100.0 + contrast, offset_px=float(rng.uniform(-2, 2)),
        )  # fmt: skip
        image = image + rng.normal(0, rng.choice([0.0, 0.2, 0.02 * contrast]), image.shape)
        if rng.random() < 0.5:
            image = np.minimum(image, 100.0 + rng.uniform(0.05, 0.95) * contrast)
        wrong += found(np.round(image) if rng.random() < 0.5 else image) is not None
    assert wrong <= 2


def test_blended_fill_is_left_out_with_the_pixels_it_was_mixed_with():
    """An image whose zeros were averaged with data, two by two pixels."""
    fine = ground((160, 200), level=8000.0)
    corner = beyond(fine.shape, 25.0)
    fine[corner] = 0.0
    pixels = np.round(fine.reshape(80, 2, 100, 2).mean(axis=(1, 3)))
    touched = corner.reshape(80, 2, 100, 2).any(axis=(1, 3))
    fill = found(pixels)
    assert fill.value == 0
    assert fill.mask[touched].all()
    assert np.count_nonzero(fill.mask & ~touched) < 4 * 80


def test_a_nodata_of_nan_says_that_every_value_is_data(tmp_path):
    pixels = ground()
    pixels[beyond(pixels.shape)] = 0.0
    np.save(tmp_path / "scene.npy", pixels)
    path = tmp_path / "scene.npy"
    whole = Box.whole(pixels.shape)
    assert find_fill(open_image(path), whole, pixels) is not None
    for image in (open_image(path, nodata=np.nan), Image.from_array(pixels, nodata=np.nan)):
        assert find_fill(image, whole, pixels) is None
        assert np.array_equal(image.read(), pixels)


def test_fill_inside_a_polygon_only():
    pixels = ground()
    corner = beyond(pixels.shape)
    pixels[corner] = 0.0
    fill = found(pixels)
    inside = np.zeros_like(corner)
    inside[:, :30] = True
    assert fill.within(inside) is None
    inside[:, :100] = True
    assert fill.within(inside).count == np.count_nonzero(corner & inside)


def test_a_value_far_from_all_others_is_named_wherever_it_lies():
    pixels = ground()
    assert value_far_off(pixels) is None
    pixels[30:36, 40:50] = -9999.0
    assert value_far_off(pixels) == (-9999.0, 60)
    pixels[30:36, 40:50] = 65535.0
    assert value_far_off(pixels) == (65535.0, 60)
    assert value_far_off(np.full((9, 9), 5.0)) is None
    assert value_far_off(np.full((9, 9), np.nan)) is None
    # Neither side of an edge, with noise or without.
    edge, _ = sim.edge(sim.reference_systems()["gaussian"], angle_deg=6.0)
    assert value_far_off(np.asarray(edge, float)) is None
