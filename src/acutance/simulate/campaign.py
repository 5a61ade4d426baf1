"""A field campaign: tarps, mirrors, bars and a star on grass, in one image."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import (
    require_all,
    require_finite,
    require_numbers,
    require_optional,
    require_rng,
    require_types,
)
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.geometry.line import Line
from acutance.optics.sensor import Sensor, normal_direction_deg, require_sensor
from acutance.simulate.bars import BarGroup, BarsTruth
from acutance.simulate.edge import Truth
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_shape
from acutance.simulate.noise import Noise
from acutance.simulate.points import PointsTruth, mirror_columns, peak_per_flux
from acutance.simulate.pulse import PulseTruth
from acutance.simulate.scene import Point, add_patches, texture
from acutance.simulate.site import Scene, SceneEdge, SceneTarget, require_texture
from acutance.simulate.star import Star, StarTruth, add_star
from acutance.simulate.tarps import (
    GUARD_PX,
    EdgeTarps,
    PulseTarp,
    tarp_patches,
    tarp_region,
)

__all__ = ["Placed", "brookings", "render_site"]

STRIPE_ROWS = 256
"""Noise is drawn for so many rows at a time: a scene of 20,000 rows fits into memory."""


@dataclass(frozen=True)
class Placed:
    """The targets of a site other than tarps.

    Parameters
    ----------
    bars : tuple of BarGroup, optional
        All with one normal.
    bars_level : float, optional
        Level of the bars, in image units.
    star : Star, optional
    star_levels : (float, float), optional
        Levels between which its spokes go.
    mirrors : sequence of (row, col), optional
    mirror_peak : float, optional
        Signal that a mirror on the centre of a pixel adds to that pixel.

    Raises
    ------
    OptionError
        If one of them is of another kind.
    """

    bars: tuple[BarGroup, ...] = ()
    bars_level: float = 1200.0
    star: Star | None = None
    star_levels: tuple[float, float] = (200.0, 1200.0)
    mirrors: Sequence[tuple[float, float]] = ()
    mirror_peak: float = 1000.0

    def __post_init__(self) -> None:
        require_types(self)


def render_site(
    sensor: Sensor,
    tarps: Sequence[EdgeTarps | PulseTarp],
    shape: tuple[int, int],
    *,
    placed: Placed | None = None,
    ground: float = 430.0,
    texture_std: float = 0.0,
    texture_grain_px: float = 1.5,
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
    progress: Callable[[int, int], None] | None = None,
    description: str = "A site",
) -> Scene:
    """Many targets on textured ground in one image.

    Each target is rendered in a window of its own, so time grows with their number and memory
    with the image alone. Tarps, bars and mirrors are exact as `add_patches`, the star as
    `add_star`; texture ends where a tarp begins, both blurred.

    Parameters
    ----------
    sensor : Sensor
    tarps : sequence of EdgeTarps or PulseTarp
        They must not touch one another.
    shape : (rows, cols)
    placed : Placed, optional
        Other targets.
    ground : float, optional
        Mean level of the ground, in image units.
    texture_std, texture_grain_px : float, optional
        Standard deviation of the ground in the image and size of its grain.
    noise : Noise, optional
    rng : numpy.random.Generator, optional
        Needed for texture and noise.
    progress : function of (done, total), optional
        Called after each tarp.
    description : str, optional
        One sentence for people.

    Returns
    -------
    Scene
        Its image is of single precision.

    Raises
    ------
    ModelError
        If the image is too large, a target reaches beyond it, a level is not finite, or randomness
        is requested without `rng`.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape, MAX_SCENE_PIXELS)
    require_texture(texture_std)
    require_finite(ground=ground, texture_grain_px=texture_grain_px)
    require_all((EdgeTarps, PulseTarp), "tarps", tarps)
    require_optional(Placed, placed=placed)
    require_optional(Noise, noise=noise)
    others = Placed() if placed is None else placed
    image = np.zeros(shape, np.float32)
    if texture_std > 0:
        drawn = require_rng(rng, "texture")
        cover = np.ones(shape, np.float32)
        for patch in [one for tarp in tarps for one in tarp_patches(tarp, -1.0, -1.0)]:
            add_patches(cover, sensor, [patch])
        image += texture(sensor, shape, texture_std, texture_grain_px, drawn)
        image *= cover
    image += np.float32(ground)
    edges, targets = [], []
    for i, tarp in enumerate(tarps):
        _require_inside(tarp.name, tarp_region(tarp), shape)
        if isinstance(tarp, EdgeTarps):
            add_patches(image, sensor, tarp_patches(tarp, tarp.dark - ground, tarp.bright - ground))
            edges.append(_edge(sensor, tarp, noise))
        else:
            add_patches(image, sensor, tarp_patches(tarp, tarp.level - ground, 0.0))
            targets.append(_pulse(sensor, tarp, ground, noise))
        if progress is not None:
            progress(i + 1, len(tarps))
    targets += _add_others(image, sensor, others, ground, noise)
    if noise is not None:
        for top in range(0, shape[0], STRIPE_ROWS):
            stripe = image[top : top + STRIPE_ROWS].astype(float)
            image[top : top + STRIPE_ROWS] = noise.added_to(stripe, rng)
    return Scene(np.asarray(image), tuple(edges), sensor, description, tuple(targets))


def brookings(
    sensor: Sensor,
    rng: np.random.Generator,
    *,
    turn_deg: float = 6.0,
    texture_std: float = 14.0,
    noise: Noise | None = None,
) -> Scene:
    """A campaign as at Brookings: everything on one field, turned by 6 degrees.

    Four tarps that make a nearly vertical and a nearly horizontal edge, a tarp of three pixels
    for a pulse, twenty mirrors in the layout of the 2003 QuickBird campaign, four groups of bars
    and a Siemens star, on grass. Sizes are in pixels, whatever the GSD.

    Parameters
    ----------
    sensor : Sensor
    rng : numpy.random.Generator
    turn_deg : float, optional
        Turn of the field from the column axis towards the row axis, 2 to 14.
    texture_std : float, optional
        Standard deviation of the grass in the image.
    noise : Noise, optional
        White noise of standard deviation 8 unless given.

    Returns
    -------
    Scene
        300 rows, 260 columns. Edges "vertical" and "horizontal"; targets "pulse", "bars", "star"
        and "mirrors".

    Raises
    ------
    ModelError, OptionError
        If the field is turned too far, or an argument is of the wrong kind.
    """
    require_numbers(turn_deg=turn_deg)
    if not 2 <= turn_deg <= 14:
        raise ModelError(f"the field is turned by {turn_deg:g} deg, it has to be 2 to 14")
    across, along = turn_deg, normal_direction_deg(turn_deg, "along")
    tarps = (
        EdgeTarps("vertical", 50.3, 60.4, across, 32.0, 200.0, 1200.0),
        EdgeTarps("horizontal", 150.6, 45.2, along, 32.0, 200.0, 1200.0),
        PulseTarp("pulse", 150.4, 110.7, across, 3.0, 60.0, 1200.0),
    )
    tangent = Line(0.0, 0.0, across).normal
    places = [
        (240.0 + (i - 1.5) * 26 * tangent[0], 30.0 - (i - 1.5) * 26 * tangent[1]) for i in range(4)
    ]
    groups = tuple(
        BarGroup(row, col, across, period, 4, 18.0)
        for (row, col), period in zip(places, (6.0, 4.0, 3.0, 2.5), strict=True)
    )
    mirrors = tuple((float(row), float(col)) for row, col in mirror_columns((22.0, 170.0)))
    placed = Placed(bars=groups, star=Star(226.0, 186.0, 48.0), mirrors=mirrors, mirror_peak=900.0)
    return render_site(
        sensor,
        tarps,
        (300, 260),
        placed=placed,
        texture_std=texture_std,
        noise=Noise(read=8.0) if noise is None else noise,
        rng=rng,
        description=f"Edge tarps, a pulse tarp, 20 mirrors, bars and a star on grass, turned by "
        f"{turn_deg:g} deg",
    )


def _require_inside(name: str, region: Floats, shape: tuple[int, int]) -> None:
    low, high = region.min(axis=0), region.max(axis=0)
    if np.any(low < 0) or np.any(high > np.array(shape) - 1):
        raise ModelError(
            f"the target {name} reaches from ({low[0]:.0f}, {low[1]:.0f}) to ({high[0]:.0f}, "
            f"{high[1]:.0f}), beyond the image of {shape[0]} by {shape[1]} px: move it or use a "
            "larger image"
        )


def _shown_line(sensor: Sensor, tarp: EdgeTarps | PulseTarp, length_px: float) -> Line:
    """Where the image shows what lies at a tarp's middle: off by the ESF's 50 % point."""
    middle = Line(tarp.row, tarp.col, tarp.normal_deg, length_px=length_px)
    return middle.moved(sensor.profile(tarp.normal_deg).half_px, 0.0)


def _edge(sensor: Sensor, tarp: EdgeTarps, noise: Noise | None) -> SceneEdge:
    line = _shown_line(sensor, tarp, tarp.side_px - 2 * GUARD_PX)
    response = sensor.response_along(tarp.normal_deg)
    truth = Truth(response, line, tarp.dark, tarp.bright, noise)
    return SceneEdge(tarp.name, tarp_region(tarp), truth)


def _pulse(sensor: Sensor, tarp: PulseTarp, ground: float, noise: Noise | None) -> SceneTarget:
    line = _shown_line(sensor, tarp, tarp.length_px - 2 * GUARD_PX)
    truth = PulseTruth(sensor, line, tarp.width_px, ground, tarp.level, ground, noise)
    return SceneTarget(tarp.name, "pulse", tarp_region(tarp), truth)


def _add_others(
    image: NDArray[Any], sensor: Sensor, placed: Placed, ground: float, noise: Noise | None
) -> list[SceneTarget]:
    """Bars, star and mirrors drawn into the image, and what is true of them."""
    found = []
    if placed.bars:
        for group in placed.bars:
            add_patches(image, sensor, group.patches(placed.bars_level - ground))
        truth = BarsTruth(sensor, placed.bars, ground, placed.bars_level, noise)
        corners = np.concatenate([group.region for group in placed.bars])
        found.append(SceneTarget("bars", "bars", _around(corners, 6.0), truth))
    if placed.star is not None:
        star, (dark, bright) = placed.star, placed.star_levels
        middle, swing = 0.5 * (dark + bright), 0.5 * (bright - dark)
        add_star(image, sensor, star, mean=middle - ground, amplitude=swing)
        region = _around(np.array([[star.row, star.col]]), star.radius_px + 2)
        spokes = StarTruth(sensor, star, dark, bright, ground, noise)
        found.append(SceneTarget("star", "star", region, spokes))
    if placed.mirrors:
        places = np.array(placed.mirrors, float)
        flux = placed.mirror_peak / peak_per_flux(sensor)
        add_patches(image, sensor, [Point(row, col, flux) for row, col in placed.mirrors])
        lights = PointsTruth(sensor, places, np.full(len(places), flux), ground, noise)
        found.append(SceneTarget("mirrors", "points", _around(places, 8.0), lights))
    for target in found:
        _require_inside(target.name, target.region, (image.shape[0], image.shape[1]))
    return found


def _around(places: Floats, room_px: float) -> Floats:
    """Corners of the upright rectangle around places."""
    (top, left), (bottom, right) = places.min(axis=0) - room_px, places.max(axis=0) + room_px
    return np.array([(top, left), (top, right), (bottom, right), (bottom, left)])
