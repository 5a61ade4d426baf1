"""Landscapes: thousands of objects beside one another, as a sensor sees them, with every edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.optics.sensor import Sensor
from acutance.simulate.landscape_edges import LandscapeEdge
from acutance.simulate.landscape_layout import Waves, draw_waves, place_objects
from acutance.simulate.landscape_options import LandscapeOptions
from acutance.simulate.landscape_survey import edges_of
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_rng, require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.parcel import Parcel
from acutance.simulate.parcel_image import add_parcels, fine_samples, reach_of_light
from acutance.simulate.scene import texture
from acutance.simulate.sensor_field import SensorField, sensor_at

__all__ = ["LandscapeTruth", "landscape"]

_STRIPE_ROWS = 256
"""Ground and noise are added to so many rows at a time, which saves memory."""

Canvas = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class LandscapeTruth(ShortRepr):
    """All that is true of a simulated landscape.

    Parameters
    ----------
    edges : tuple of LandscapeEdge
        Every straight or gently curved border of 12 px or more that is free of corners.
    parcels : tuple of Parcel
        Everything drawn, discs and short borders too.
    ground : Waves
        The level of the ground between them.
    ground_texture : float
        Standard deviation of the ground's texture in the image.
    sensor : Sensor or SensorField
    options : LandscapeOptions
    noise : Noise, optional
        Noise that was added to the image.
    """

    edges: tuple[LandscapeEdge, ...]
    parcels: tuple[Parcel, ...]
    ground: Waves
    ground_texture: float
    sensor: Sensor | SensorField
    options: LandscapeOptions
    noise: Noise | None = None


def landscape(
    sensor: Sensor | SensorField,
    *,
    shape: tuple[int, int] = (1000, 1000),
    options: LandscapeOptions | None = None,
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Floats, LandscapeTruth]:
    """An image of fields, roofs, roads and discs of any direction, and the truth about it.

    Each object is drawn in a window of its own, so time grows with their number and memory with
    the image alone. Straight borders have the sensor's MTF to 1e-4. The blur of a sensor that
    changes over the field is the one at the middle of an object, for all that belongs to it: the
    truth of its edges is exact, the change goes from object to object. Textures are seen through
    the sensor in the middle of the image, and change at borders as these are blurred by a pixel;
    the long waves of the ground are as no sensor changes them.

    Parameters
    ----------
    sensor : Sensor or SensorField
        One for the whole image, or one that changes over it, such as `SoftCorners`.
    shape : (rows, cols), optional
    options : LandscapeOptions, optional
        What the landscape is made of.
    snr : float, optional
        Middle of the contrasts (``options.typical_contrast``) over the standard deviation of
        added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    rng : numpy.random.Generator
        Draws everything: the same state gives the same landscape.
    progress : function of (done, total), optional
        Called after each object.

    Returns
    -------
    image : (rows, cols) array
        Of single precision.
    truth : LandscapeTruth

    Raises
    ------
    ModelError
        If the image is too large, or no object finds room in it.
    OptionError
        If an argument is of the wrong kind.
    """
    require_shape(shape, MAX_SCENE_PIXELS)
    drawn = require_rng(rng, "a landscape")
    chosen = LandscapeOptions() if options is None else options
    added = noise_of_snr(chosen.typical_contrast, snr, noise)
    ground = draw_waves(chosen, drawn)
    ground_texture = chosen.typical_contrast * drawn.uniform(*chosen.texture)
    objects = place_objects(shape, chosen, drawn)
    if not objects:
        raise ModelError(
            f"none of the objects finds room in an image of {shape[0]} by {shape[1]} px: use a "
            "larger image, or smaller objects (LandscapeOptions)"
        )
    sensors = [sensor_at(sensor, one[0].row, one[0].col) for one in objects]
    image, covers = _draw_objects(sensor, objects, sensors, shape, progress)
    _add_textures(image, covers, sensor_at(sensor, *_middle(shape)), ground_texture, chosen, drawn)
    _add_ground_and_noise(image, ground, added, drawn)
    parcels = [parcel for one in objects for parcel in one]
    their_sensors = [at for at, one in zip(sensors, objects, strict=True) for _ in one]
    edges = edges_of(parcels, their_sensors, ground, ground_texture, shape, added)
    return np.asarray(image), LandscapeTruth(
        edges, tuple(parcels), ground, ground_texture, sensor, chosen, added
    )


def _middle(shape: tuple[int, int]) -> tuple[float, float]:
    return 0.5 * (shape[0] - 1), 0.5 * (shape[1] - 1)


def _draw_objects(
    sensor: Sensor | SensorField,
    objects: list[tuple[Parcel, ...]],
    sensors: list[Sensor],
    shape: tuple[int, int],
    progress: Callable[[int, int], None] | None,
) -> tuple[Canvas, Canvas]:
    """Objects on ground of level 0; how much of each pixel they cover, and that times texture."""
    image, covers = np.zeros(shape, np.float32), np.zeros((2, *shape), np.float32)
    places = [(0.0, 0.0), _middle(shape), (shape[0] - 1.0, shape[1] - 1.0)]
    typical = {sensor_at(sensor, *place) for place in places}
    reach = max(reach_of_light(one) for one in typical)
    subpixels = max(fine_samples(one) for one in typical)
    for done, (parcels, at) in enumerate(zip(objects, sensors, strict=True), start=1):
        add_parcels(image, covers, at, parcels, reach_px=reach, subpixels=subpixels)
        if progress is not None:
            progress(done, len(objects))
    return image, covers


def _add_textures(
    image: Canvas,
    covers: Canvas,
    sensor: Sensor,
    ground_texture: float,
    options: LandscapeOptions,
    rng: np.random.Generator,
) -> None:
    """Add a texture to the ground and another one to parcels, each of its own strength."""
    if options.texture[1] == 0:
        return
    cover, inside = covers
    shape = (image.shape[0], image.shape[1])
    grain = options.texture_grain_px
    image += ground_texture * (1 - cover) * texture(sensor, shape, 1.0, grain, rng)
    image += inside * texture(sensor, shape, 1.0, grain, rng)


def _add_ground_and_noise(
    image: Canvas, ground: Waves, noise: Noise | None, rng: np.random.Generator
) -> None:
    rows, cols = (np.arange(size) for size in image.shape)
    for top in range(0, rows.size, _STRIPE_ROWS):
        stripe = image[top : top + _STRIPE_ROWS] + ground.at(
            rows[top : top + _STRIPE_ROWS, None], cols[None, :]
        )
        image[top : top + _STRIPE_ROWS] = stripe if noise is None else noise.added_to(stripe, rng)
