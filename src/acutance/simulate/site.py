"""A calibration site: painted checkerboard, grass and a road, with the truth of every edge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from acutance.arguments import (
    require_all,
    require_finite,
    require_numbers,
    require_place,
    require_rng,
)
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.bars import BarsTruth
from acutance.simulate.edge import Truth
from acutance.simulate.limits import require_darker, require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.points import PointsTruth
from acutance.simulate.pulse import PulseTruth
from acutance.simulate.scene import Patch, Strip, render_patches, render_strip, texture
from acutance.simulate.star import StarTruth

__all__ = ["Scene", "SceneEdge", "SceneTarget", "checkerboard", "site"]

GUARD_PX = 3.0
"""Distance a region keeps from the corners of the tiles."""


@dataclass(frozen=True, eq=False)
class SceneEdge(ShortRepr):
    """One measurable edge of a scene.

    Parameters
    ----------
    name : str
    region : (4, 2) array
        Corners of the region around the edge as (row, col); integers are pixel centres.
    truth : Truth
    """

    name: str
    region: Floats
    truth: Truth


@dataclass(frozen=True, eq=False)
class SceneTarget(ShortRepr):
    """A target of a scene that is not one edge.

    Parameters
    ----------
    name : str
    kind : {"pulse", "bars", "star", "points"}
    region : (4, 2) array
        Corners of the region around it as (row, col); integers are pixel centres.
    truth : PulseTruth, BarsTruth, StarTruth or PointsTruth
    """

    name: str
    kind: Literal["pulse", "bars", "star", "points"]
    region: Floats
    truth: PulseTruth | BarsTruth | StarTruth | PointsTruth


@dataclass(frozen=True, eq=False)
class Scene(ShortRepr):
    """A simulated image with all that is known about it.

    Parameters
    ----------
    image : (rows, cols) array of float
    edges : tuple of SceneEdge
    sensor : Sensor
    description : str
        One sentence for people.
    targets : tuple of SceneTarget, optional
        All that are no edges.
    """

    image: Floats
    edges: tuple[SceneEdge, ...]
    sensor: Sensor
    description: str
    targets: tuple[SceneTarget, ...] = ()


def checkerboard(
    sensor: Sensor,
    *,
    shape: tuple[int, int] = (120, 120),
    tile_px: float = 28.0,
    turn_deg: float = 7.0,
    centre: tuple[float, float] | None = None,
    dark: float = 200.0,
    bright: float = 1200.0,
    ground: float = 500.0,
    texture_std: float = 0.0,
    texture_grain_px: float = 1.5,
    strips: Sequence[Strip] = (),
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
) -> Scene:
    """A checkerboard of two by two tiles on flat or textured ground: four edges.

    The bright tiles are the upper left and the lower right one before the board is turned.

    Parameters
    ----------
    sensor : Sensor
    shape : (rows, cols), optional
    tile_px : float, optional
        Side of a tile, at least 16 px.
    turn_deg : float, optional
        Turn of the board from the column axis towards the row axis (clockwise on the screen),
        -45 to 45.
    centre : (row, col), optional
        Where the four tiles meet; the middle of the image unless given.
    dark, bright, ground : float, optional
        Levels of the tiles and of the ground around them, in image units; dark below bright.
    texture_std, texture_grain_px : float, optional
        Standard deviation of the ground and size of its grain; the board has none.
    strips : sequence of Strip, optional
        Roads; they must not cross the board.
    snr : float, optional
        Contrast of the tiles over the standard deviation of added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    rng : numpy.random.Generator, optional
        Needed for texture and noise.

    Returns
    -------
    Scene
        Its edges are "upper", "lower" (normal near the columns' axis), "left" and "right".

    Raises
    ------
    ModelError
        If the board is too small, leaves the image, its dark tiles are not the darker ones, or
        randomness is requested without `rng`.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape)
    if centre is None:
        centre = (0.5 * (shape[0] - 1), 0.5 * (shape[1] - 1))
    require_place(centre=centre)
    require_numbers(tile_px=tile_px, turn_deg=turn_deg)
    require_texture(texture_std)
    require_finite(dark=dark, bright=bright, ground=ground, texture_grain_px=texture_grain_px)
    require_all(Strip, "strips", strips)
    require_darker(dark, bright, "the bright tiles are the upper left and the lower right one")
    _require_room(shape, tile_px, turn_deg, centre)
    board = _tiles(centre, tile_px, turn_deg, dark - ground, bright - ground)
    image = ground + render_patches(sensor, board, shape)
    for strip in strips:
        image = image + render_strip(sensor, strip, shape)
    if texture_std > 0:
        drawn = require_rng(rng, "texture")
        whole = Patch(*centre, 2 * tile_px, 2 * tile_px, turn_deg, 1.0)
        bare = 1 - render_patches(sensor, [whole], shape)
        image = image + bare * texture(sensor, shape, texture_std, texture_grain_px, drawn)
    added = noise_of_snr(bright - dark, snr, noise, min(dark, bright, ground))
    if added is not None:
        image = added.added_to(image, rng)
    edges = tuple(
        _board_edge(sensor, name, direction, centre, tile_px, turn_deg, dark, bright, added)
        for name, direction in (("right", 0.0), ("lower", 90.0), ("left", 180.0), ("upper", 270.0))
    )
    description = (
        f"Checkerboard of 2 x 2 tiles of {tile_px:g} px, turned by {turn_deg:g} deg, "
        f"{dark:g} and {bright:g} on {ground:g}"
    )
    return Scene(image, edges, sensor, description)


def require_texture(texture_std: float) -> None:
    """Refuse a standard deviation of the ground that is none.

    Raises
    ------
    ModelError
        If it is negative, infinite or not a number.
    """
    require_finite(texture_std=texture_std)
    if texture_std < 0:
        raise ModelError(
            f"texture_std (--texture) is {texture_std:g}, it has to be 0 or more: 0 is even ground"
        )


def site(
    sensor: Sensor, rng: np.random.Generator, *, turn_deg: float = 7.0, noise: Noise | None = None
) -> Scene:
    """A small calibration site: a checkerboard of 28 px tiles on grass next to a road.

    Parameters
    ----------
    sensor : Sensor
    rng : numpy.random.Generator
    turn_deg : float, optional
        Turn of the board.
    noise : Noise, optional
        White noise of standard deviation 8 unless given, which is an SNR of 125 on the board.

    Returns
    -------
    Scene
        180 rows, 160 columns.
    """
    road = Strip(row=158.0, col=80.0, normal_deg=68.0, width_px=9.0, contrast=260.0)
    return checkerboard(
        sensor,
        shape=(180, 160),
        turn_deg=turn_deg,
        centre=(72.3, 78.6),
        ground=430.0,
        texture_std=14.0,
        strips=[road],
        noise=Noise(read=8.0) if noise is None else noise,
        rng=rng,
    )


def _require_room(
    shape: tuple[int, int], tile_px: float, turn_deg: float, centre: tuple[float, float]
) -> None:
    if not abs(turn_deg) <= 45:
        raise ModelError(f"the board is turned by {turn_deg:g} deg, it has to be -45 to 45")
    if not tile_px >= 16:
        raise ModelError(f"tiles of {tile_px:g} px leave no plateaus: at least 16 px are needed")
    reach = tile_px * sum(unit_vector(abs(turn_deg)))
    room = min(*centre, shape[0] - 1 - centre[0], shape[1] - 1 - centre[1])
    if reach > room:
        raise ModelError(
            f"the board reaches {reach:.1f} px from its centre, the image {room:.1f} px: "
            "use smaller tiles or a larger image"
        )


def _turned(x: float, y: float, turn_deg: float) -> tuple[float, float]:
    """(x, y) turned from the column axis towards the row axis."""
    cos, sin = unit_vector(turn_deg)
    return cos * x - sin * y, sin * x + cos * y


def _tiles(
    centre: tuple[float, float], tile_px: float, turn_deg: float, dark: float, bright: float
) -> list[Patch]:
    tiles = []
    for side_x, side_y in product((-0.5, 0.5), repeat=2):
        x, y = _turned(side_x * tile_px, side_y * tile_px, turn_deg)
        level = bright if side_x == side_y else dark
        tiles.append(Patch(centre[0] + y, centre[1] + x, tile_px, tile_px, turn_deg, level))
    return tiles


def _board_edge(
    sensor: Sensor,
    name: str,
    direction_deg: float,
    centre: tuple[float, float],
    tile_px: float,
    turn_deg: float,
    dark: float,
    bright: float,
    noise: Noise | None,
) -> SceneEdge:
    """The edge that runs from the board's centre in `direction_deg` (before the turn)."""
    towards = turn_deg + direction_deg
    # A quarter turn clockwise from the right-hand edge lies a bright tile, and so on round.
    clockwise_is_bright = direction_deg in (0.0, 180.0)
    normal = wrap_direction(towards + (90.0 if clockwise_is_bright else -90.0))
    middle_x, middle_y = _turned(0.5 * tile_px, 0.0, towards)
    length = tile_px - 2 * GUARD_PX
    ground_line = Line(centre[0] + middle_y, centre[1] + middle_x, normal, length_px=length)
    line = ground_line.moved(sensor.profile(normal).half_px, 0.0)
    corners = [
        _turned(0.5 * tile_px + along * 0.5 * length, across * (tile_px - GUARD_PX), towards)
        for along, across in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    region = np.array([(centre[0] + y, centre[1] + x) for x, y in corners])
    truth = Truth(sensor.response_along(normal), line, dark, bright, noise)
    return SceneEdge(name, region, truth)
