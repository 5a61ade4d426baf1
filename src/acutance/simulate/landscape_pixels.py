"""The pixels of a landscape, tile by tile.

Every pixel is a sum in one order, of objects and of random numbers that belong to its place: how
much of a landscape is drawn changes none of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.curves.grid import Floats
from acutance.optics.sensor import Sensor
from acutance.raster import Box
from acutance.simulate.landscape_layout import LandscapeLayout
from acutance.simulate.noise import Noise
from acutance.simulate.parcel import Parcel
from acutance.simulate.parcel_image import (
    fine_samples,
    reach_of_light,
    render_parcels,
    window_of_light,
)
from acutance.simulate.scene import grain_transfer, stamp
from acutance.simulate.sensor_field import SensorField, sensor_at
from acutance.simulate.white_noise import CELL_PX, generator_at, white_noise

__all__ = ["TILE_PX", "Canvas", "draw_tiles"]

TILE_PX = 1024
"""Side of the tiles; a multiple of the blocks of a GeoTIFF."""

_GRAIN_SIGMAS, _LIGHT_PX = 4.0, 32
"""A texture is filtered with so much ground around: its grain, and what the sensor scatters."""

_GROUND, _INSIDE, _NOISE = range(3)
"""Random planes: texture of the ground, texture of parcels, noise."""

Canvas = NDArray[np.float32]


def draw_tiles(
    layout: LandscapeLayout,
    sensor: Sensor | SensorField,
    noise: Noise | None,
) -> Iterator[tuple[Box, Canvas]]:
    """Tiles of the image from left to right, row after row.

    An object is drawn once, when the first tile needs it, and dropped after the last one: memory
    grows with the width of the image, not with its height.

    Parameters
    ----------
    layout : LandscapeLayout
    sensor : Sensor or SensorField
    noise : Noise or None

    Yields
    ------
    box : Box
    pixels : (height, width) array
        Of single precision.
    """
    tiles = list(_tiles(layout.shape))
    middle = sensor_at(sensor, *_middle(layout.shape))
    reach, subpixels = _grid(sensor, layout.shape)
    windows = [window_of_light(one, reach) for one in layout.objects]
    touching = _touching(tiles, windows)
    last = {i: number for number, objects in enumerate(touching) for i in objects}
    held: dict[int, Canvas] = {}
    for number, (box, objects) in enumerate(zip(tiles, touching, strict=True)):
        canvas = np.zeros((3, *box.shape), np.float32)
        for i in objects:
            if i not in held:
                held[i] = _light(sensor, layout.objects[i], windows[i], subpixels)
            for whole, part in zip(canvas, held[i], strict=True):
                stamp(whole, part, windows[i].row - box.row, windows[i].col - box.col)
        held = {i: light for i, light in held.items() if last[i] > number}
        yield box, _pixels(canvas, layout, middle, noise, box)


def _middle(shape: tuple[int, int]) -> tuple[float, float]:
    return 0.5 * (shape[0] - 1), 0.5 * (shape[1] - 1)


def _tiles(shape: tuple[int, int]) -> Iterator[Box]:
    """Tiles of an image; the last ones of its rows and columns are smaller."""
    for row in range(0, shape[0], TILE_PX):
        for col in range(0, shape[1], TILE_PX):
            yield Box(row, col, min(TILE_PX, shape[0] - row), min(TILE_PX, shape[1] - col))


def _grid(sensor: Sensor | SensorField, shape: tuple[int, int]) -> tuple[int, int]:
    """How far light is followed in pixels, and fine samples in a pixel, for the whole image."""
    places = [(0.0, 0.0), _middle(shape), (shape[0] - 1.0, shape[1] - 1.0)]
    typical = {sensor_at(sensor, *place) for place in places}
    return max(reach_of_light(one) for one in typical), max(fine_samples(one) for one in typical)


def _touching(tiles: Sequence[Box], windows: Sequence[Box]) -> list[list[int]]:
    """The objects that are seen in each tile, in the order in which they are summed."""
    top, left, rows, cols = np.array([one.as_tuple() for one in windows]).T
    return [
        np.flatnonzero(
            (top < box.row + box.height)
            & (top + rows > box.row)
            & (left < box.col + box.width)
            & (left + cols > box.col)
        ).tolist()
        for box in tiles
    ]


def _light(
    sensor: Sensor | SensorField, parcels: tuple[Parcel, ...], window: Box, subpixels: int
) -> Canvas:
    """One object on ground of level 0, its cover of each pixel, and that times texture."""
    moved = [one.moved(-window.row, -window.col) for one in parcels]
    at = sensor_at(sensor, parcels[0].row, parcels[0].col)
    image, covers = render_parcels(at, moved, window.shape, subpixels=subpixels)
    return np.concatenate([image[np.newaxis], covers]).astype(np.float32)


def _pixels(
    canvas: Canvas, layout: LandscapeLayout, sensor: Sensor, noise: Noise | None, box: Box
) -> Canvas:
    """Objects, ground, textures and noise."""
    image, cover, inside = canvas
    rows, cols = (np.arange(at.start, at.stop) for at in box.slices)
    image = image + layout.ground.at(rows[:, None], cols[None, :])
    grain = layout.options.texture_grain_px
    if layout.options.texture[1] > 0:
        texture = _texture(sensor, box, grain, (*layout.seed, _GROUND))
        image += layout.ground_texture * (1 - cover) * texture
        image += inside * _texture(sensor, box, grain, (*layout.seed, _INSIDE))
    if noise is not None:
        image = noise.added_to(image, generator_at((*layout.seed, _NOISE), box.row, box.col))
    return np.asarray(image, np.float32)


def _texture(sensor: Sensor, box: Box, grain_px: float, seed: Sequence[int]) -> Floats:
    """Random ground of unit variance with Gaussian grain, seen through the sensor."""
    cells = math.ceil((_GRAIN_SIGMAS * grain_px + _LIGHT_PX) / CELL_PX)
    room = cells * CELL_PX
    rows, cols = (-(-size // CELL_PX) * CELL_PX + 2 * room for size in box.shape)
    white = white_noise(seed, Box(box.row - room, box.col - room, rows, cols))
    transfer, gain = grain_transfer(sensor, (rows, cols), grain_px)
    # What the transform wraps around its ends stays in the room.
    seen = fft.irfft2(fft.rfft2(white, overwrite_x=True) * transfer, (rows, cols))
    return np.asarray(gain * seen[room : room + box.height, room : room + box.width])
