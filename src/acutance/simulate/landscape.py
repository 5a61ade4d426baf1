"""Landscapes: thousands of objects beside one another, as a sensor sees them, with every edge."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from acutance.arguments import require_optional, require_rng
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.optics.sensor import Sensor
from acutance.raster import Box
from acutance.simulate.landscape_edges import LandscapeEdge
from acutance.simulate.landscape_layout import Waves, draw_layout
from acutance.simulate.landscape_options import LandscapeOptions
from acutance.simulate.landscape_pixels import Canvas, draw_tiles
from acutance.simulate.landscape_survey import edges_of
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.parcel import Parcel
from acutance.simulate.sensor_field import SensorField, sensor_at

__all__ = ["LandscapeTruth", "landscape", "landscape_tiles"]


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
    the image alone; `landscape_tiles` gives the same image in parts. Straight borders have the
    sensor's MTF to 1e-4. The blur of a sensor that changes over the field is the one at the middle
    of an object, for all that belongs to it: the truth of its edges is exact, the change goes from
    object to object. Textures are seen through the sensor in the middle of the image, and change at
    borders as these are blurred by a pixel; the long waves of the ground are as no sensor changes
    them.

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
        Called with numbers of pixels, after each million of them.

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
    tiles, truth = landscape_tiles(
        sensor, shape=shape, options=options, snr=snr, noise=noise, rng=rng
    )
    image, done = np.empty(shape, np.float32), 0
    for box, pixels in tiles:
        image[box.slices] = pixels
        done += pixels.size
        if progress is not None:
            progress(done, image.size)
    return np.asarray(image), truth


def landscape_tiles(
    sensor: Sensor | SensorField,
    *,
    shape: tuple[int, int] = (1000, 1000),
    options: LandscapeOptions | None = None,
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator,
) -> tuple[Iterator[tuple[Box, Canvas]], LandscapeTruth]:
    """A landscape tile by tile, for images larger than memory, and the truth about it.

    Arguments are those of `landscape`, whose image is made of these tiles. The truth is there
    before the first of them is drawn. `acutance.raster.write_geotiff_tiles` writes them.

    Returns
    -------
    tiles : iterator of (Box, (height, width) array)
        From left to right, row after row: drawn as they are asked for, in single precision.
    truth : LandscapeTruth

    Examples
    --------
    >>> tiles, truth = landscape_tiles(sensor, shape=(10000, 10000), rng=rng)  # doctest: +SKIP
    >>> write_geotiff_tiles("land.tif", (10000, 10000), tiles)  # doctest: +SKIP
    """
    require_shape(shape, MAX_SCENE_PIXELS)
    require_optional(LandscapeOptions, options=options)
    drawn = require_rng(rng, "a landscape")
    # What is no sensor is refused before the layout is drawn, which takes a while.
    sensor_at(sensor, 0.0, 0.0)
    chosen = LandscapeOptions() if options is None else options
    added = noise_of_snr(chosen.typical_contrast, snr, noise)
    layout = draw_layout(shape, chosen, drawn)
    parcels = tuple(parcel for one in layout.objects for parcel in one)
    sensors = [
        at
        for one in layout.objects
        for at in [sensor_at(sensor, one[0].row, one[0].col)] * len(one)
    ]
    ground, texture = layout.ground, layout.ground_texture
    edges = edges_of(parcels, sensors, ground, texture, shape, added)
    truth = LandscapeTruth(edges, parcels, ground, texture, sensor, chosen, added)
    return draw_tiles(layout, sensor, added), truth
