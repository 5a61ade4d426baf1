"""Where the objects of a landscape lie, and the ground between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from acutance.arguments import require_floats, require_types
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.simulate.landscape_objects import draw_object
from acutance.simulate.landscape_options import LandscapeOptions
from acutance.simulate.parcel import Parcel

__all__ = ["LandscapeLayout", "Waves", "draw_layout"]

_CELL_PX = 2
"""Occupied ground is kept in squares of this side."""

_ATTEMPTS = 80
"""Places tried for an object before it is left out."""

_WAVES, _WAVE_PX = 5, (250.0, 900.0)
"""The ground is a sum of so many waves; no sensor changes waves of these lengths."""

_SEED_WORDS = 4
"""Of 32 bits each."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Waves:
    """Ground that rises and falls slowly: a mean level and long waves of any direction.

    Parameters
    ----------
    level : float
        Mean, in image units.
    waves : tuple of (float, float, float, float)
        Of each wave: amplitude, frequency along the columns and along the rows in cycles per
        pixel, phase in radians.
    """

    level: float
    waves: tuple[tuple[float, float, float, float], ...]

    def __post_init__(self) -> None:
        require_types(self)

    def at(self, rows: ArrayLike, cols: ArrayLike) -> Floats:
        """Level at places, which broadcast against each other."""
        down, right = require_floats("rows", rows), require_floats("cols", cols)
        found = np.full(np.broadcast_shapes(down.shape, right.shape), self.level)
        for amplitude, u, v, phase in self.waves:
            # The product of two short vectors, for rows and columns of an image.
            turning = np.exp(2j * math.pi * v * down + 1j * phase) * amplitude
            found += (turning * np.exp(2j * math.pi * u * right)).real
        return found


@dataclass(frozen=True, eq=False)
class LandscapeLayout:
    """All that is drawn at random of a landscape, but for its pixels.

    Parameters
    ----------
    shape : (rows, cols)
    options : LandscapeOptions
    objects : tuple of tuple of Parcel
        The parcels of each object.
    ground : Waves
    ground_texture : float
        Standard deviation of the ground's texture in the image.
    seed : tuple of int
        Of the random numbers of single pixels: textures and noise.
    """

    shape: tuple[int, int]
    options: LandscapeOptions
    objects: tuple[tuple[Parcel, ...], ...]
    ground: Waves
    ground_texture: float
    seed: tuple[int, ...]


def draw_layout(
    shape: tuple[int, int], options: LandscapeOptions, rng: np.random.Generator
) -> LandscapeLayout:
    """A landscape without its pixels.

    Raises
    ------
    ModelError
        If no object finds room.
    """
    ground = _draw_waves(options, rng)
    ground_texture = options.typical_contrast * rng.uniform(*options.texture)
    objects = _place_objects(shape, options, rng)
    if not objects:
        raise ModelError(
            f"none of the objects finds room in an image of {shape[0]} by {shape[1]} px: use a "
            "larger image, or smaller objects (LandscapeOptions)"
        )
    seed = tuple(int(word) for word in rng.integers(0, 2**32, _SEED_WORDS))
    return LandscapeLayout(shape, options, tuple(objects), ground, ground_texture, seed)


def _draw_waves(options: LandscapeOptions, rng: np.random.Generator) -> Waves:
    """Ground of the wanted root mean square slope."""
    slope = options.slope_per_px * options.typical_contrast / math.sqrt(_WAVES)
    waves = []
    for _ in range(_WAVES):
        x, y = unit_vector(rng.uniform(0.0, 360.0))
        length = rng.uniform(*_WAVE_PX)
        amplitude = slope * math.sqrt(2) * length / (2 * math.pi)
        waves.append((amplitude, x / length, y / length, rng.uniform(0.0, 2 * math.pi)))
    return Waves(options.ground, tuple(waves))


def _place_objects(
    shape: tuple[int, int], options: LandscapeOptions, rng: np.random.Generator
) -> list[tuple[Parcel, ...]]:
    """Objects at random places, none nearer to another than asked for, all whole in the image."""
    count = max(1, round(options.density_per_mpx * shape[0] * shape[1] / 1e6))
    drawn = [draw_object(options, rng) for _ in range(count)]
    masks = [_mask(one, 0.5 * options.clear_px) for one in drawn]
    taken = np.zeros([size // _CELL_PX for size in shape], bool)
    placed: list[tuple[Parcel, ...]] = []
    outlines: list[Floats] = []
    extents = np.empty((count, 2, 2))
    # The large ones first: the small ones still find room between them.
    for i in sorted(range(count), key=lambda i: -masks[i][0].size):
        mask, first_row, first_col = masks[i]
        for spot in _free_places(taken, mask, rng):
            down, right = (_CELL_PX * (at + rng.uniform(0.0, 1.0)) for at in spot)
            there = tuple(one.moved(down - first_row, right - first_col) for one in drawn[i])
            outline = _outline(there)
            # Within their cells two objects may have come nearer to one another.
            if not _are_clear(outline, outlines, extents[: len(placed)], options.clear_px):
                continue
            taken[spot[0] : spot[0] + mask.shape[0], spot[1] : spot[1] + mask.shape[1]] |= mask
            extents[len(placed)] = outline.min(axis=0), outline.max(axis=0)
            outlines.append(outline)
            placed.append(there)
            break
    return placed


def _outline(parcels: tuple[Parcel, ...]) -> Floats:
    """Points on the borders of an object, and on the outer ones of strips outside of them."""
    outer = [
        one.borders[strip.border].points(strip.near_px)
        for one in parcels
        for strip in one.strips
        if strip.near_px < 0
    ]
    return np.concatenate([*(one.outline() for one in parcels), *outer])


def _are_clear(outline: Floats, others: Sequence[Floats], extents: Floats, clear_px: float) -> bool:
    """Whether so much ground lies between an object and the others, whose extents are known."""
    low, high = outline.min(axis=0) - clear_px, outline.max(axis=0) + clear_px
    near = np.flatnonzero(np.all((extents[:, 0] < high) & (extents[:, 1] > low), axis=1))
    if near.size == 0:
        return True
    own = cKDTree(outline)
    apart = (own.query(others[k], distance_upper_bound=clear_px)[0] for k in near.tolist())
    # Beyond the bound no distance is told.
    return not any(np.isfinite(one).any() for one in apart)


def _mask(parcels: tuple[Parcel, ...], room_px: float) -> tuple[Mask, float, float]:
    """Cells that an object takes with room around it; row and column of the first cell."""
    outlines = np.concatenate([one.outline() for one in parcels])
    reach = room_px + max(one.outer_px for one in parcels) + _CELL_PX
    low, high = outlines.min(axis=0) - reach, outlines.max(axis=0) + reach
    rows, cols = (np.arange(low[i], high[i] + _CELL_PX, _CELL_PX) for i in (0, 1))
    taken = np.zeros((rows.size, cols.size), bool)
    for one in parcels:
        taken |= one.distance(rows[:, None], cols[None, :]) > -(room_px + one.outer_px)
    return taken, float(low[0]), float(low[1])


def _free_places(taken: Mask, mask: Mask, rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    """Places at random whose cells are free, of so many that are tried."""
    room = [whole - part - 1 for whole, part in zip(taken.shape, mask.shape, strict=True)]
    if min(room) < 0:
        return
    for _ in range(_ATTEMPTS):
        row, col = (int(rng.integers(0, size + 1)) for size in room)
        if not np.any(taken[row : row + mask.shape[0], col : col + mask.shape[1]] & mask):
            yield row, col
