"""Parcels as a sensor sees them: drawn soft on a fine grid, sharpened and blurred in one step.

A border cannot be sampled: it has no highest frequency. So parcels are drawn blurred by a Gaussian
of one fine sample, in closed form. The transform of the samples is then multiplied by the sensor's
OTF over that of the Gaussian, which leaves the ground as the sensor alone blurs it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy import fft

from acutance.arguments import require_all, require_whole
from acutance.curves.grid import Floats
from acutance.optics.block import Transfer
from acutance.optics.sensor import Sensor, require_sensor
from acutance.raster import Box
from acutance.simulate.limits import require_shape
from acutance.simulate.parcel import Parcel

__all__ = ["fine_samples", "reach_of_light", "render_parcels", "window_of_light"]

_BLUR_SAMPLES = 1.1
"""Standard deviation of the Gaussian in fine samples: aliases below 1e-9 at the zero frequency."""

_SUBPIXELS = (4, 6, 8)
"""Fine samples in a pixel: the first whose band holds the sensor's."""

_BEYOND = 2e-3
"""Contrast that a sensor may pass beyond 90 % of the band of the fine grid."""

_REACHES_PX, _LEFT_OUT = (24, 32, 48, 64), 5e-4
"""Room around parcels: the first beyond which the ESF is flat to this share of the contrast."""

_STEP_PX = 32
"""Sizes of windows are multiples of it, so that windows share their frequencies."""


def fine_samples(sensor: Sensor) -> int:
    """Samples in a pixel, along one axis, that parcels seen by `sensor` are drawn with: 4 to 8."""
    freq = np.arange(0.0, 8.0, 0.01)
    otf = np.maximum(np.abs(sensor.otf(freq, 0.0)), np.abs(sensor.otf(0.0, freq)))
    for count in _SUBPIXELS:
        if np.max(otf[freq > 0.45 * count]) < _BEYOND:
            return count
    return _SUBPIXELS[-1]


def reach_of_light(sensor: Sensor) -> int:
    """How far around parcels their light is drawn, in pixels: 24 to 64."""
    for reach in _REACHES_PX:
        off = max(abs(float(sensor.profile(way).esf(-reach))) for way in (0.0, 90.0, 180.0, 270.0))
        if off < _LEFT_OUT:
            return reach
    return _REACHES_PX[-1]


def render_parcels(
    sensor: Sensor,
    parcels: Sequence[Parcel],
    shape: tuple[int, int],
    *,
    subpixels: int = 4,
) -> tuple[Floats, Floats]:
    """What parcels add to the image of the ground around them, and how their textures mix.

    The image is periodic: leave empty ground at its borders. The MTF of a straight border is that
    of the sensor to 1e-4 up to 1 cycle per pixel, where `subpixels` is that of `fine_samples`.

    Parameters
    ----------
    sensor : Sensor
    parcels : sequence of Parcel
    shape : (rows, cols)
    subpixels : int, optional
        Fine samples in a pixel, along one axis.

    Returns
    -------
    image : (rows, cols) array
        In image units; 0 is the ground.
    covers : (2, rows, cols) array
        Share of a pixel that parcels cover, and that share times the parcels' textures.

    Raises
    ------
    ModelError, OptionError
        If the image is too large, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape)
    require_all(Parcel, "parcels", parcels)
    require_whole(1, subpixels=subpixels)
    size = (shape[0] * subpixels, shape[1] * subpixels)
    blur_px = _BLUR_SAMPLES / subpixels
    ground, covers = np.zeros(size), np.zeros((2, *size))
    for parcel in parcels:
        rows, cols = _window(parcel, shape, blur_px)
        level, cover = parcel.drawn(
            _places(rows, subpixels)[:, None], _places(cols, subpixels)[None, :], blur_px
        )
        ground[_fine(rows, subpixels), _fine(cols, subpixels)] += level
        fine = _fine(rows, subpixels), _fine(cols, subpixels)
        covers[:, *fine] += np.array([1.0, parcel.texture_std])[:, None, None] * cover
    transfer = _transfer(sensor, shape, subpixels, blur_px)
    image, *seen = (
        _every_pixel(fft.rfft2(one) * transfer, shape, subpixels) for one in (ground, *covers)
    )
    return image, np.array(seen)


def window_of_light(parcels: Sequence[Parcel], reach_px: int) -> Box:
    """Where parcels that lie together are seen, with `reach_px` of empty ground around them."""
    extents = np.array([_extent(one) for one in parcels])
    top, left = (math.floor(low) - reach_px for low in extents[:, :2].min(axis=0))
    bottom, right = (math.ceil(high) + reach_px for high in extents[:, 2:].max(axis=0))
    rows, cols = (-(-size // _STEP_PX) * _STEP_PX for size in (bottom - top, right - left))
    return Box(top, left, rows, cols)


def _extent(parcel: Parcel) -> tuple[float, float, float, float]:
    """Lowest row and column, highest row and column that a parcel and its strips reach."""
    outline, room = parcel.outline(), parcel.outer_px
    low, high = outline.min(axis=0) - room, outline.max(axis=0) + room
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _window(parcel: Parcel, shape: tuple[int, int], blur_px: float) -> tuple[slice, slice]:
    """Rows and columns of the image in which a parcel is drawn."""
    softness = [one.softness_px for one in parcel.borders]
    softness += [one.softness_px for one in parcel.strips]
    room = 7 * math.hypot(blur_px, max(softness)) + 1
    top, left, bottom, right = _extent(parcel)
    return (
        slice(max(0, math.floor(top - room)), min(shape[0], math.ceil(bottom + room) + 1)),
        slice(max(0, math.floor(left - room)), min(shape[1], math.ceil(right + room) + 1)),
    )


def _fine(pixels: slice, subpixels: int) -> slice:
    return slice(pixels.start * subpixels, pixels.stop * subpixels)


def _places(pixels: slice, subpixels: int) -> Floats:
    """Places of fine samples in pixels; the first of each pixel is its centre."""
    fine = _fine(pixels, subpixels)
    return np.arange(fine.start, fine.stop) / subpixels


@lru_cache(maxsize=12)
def _transfer(sensor: Sensor, shape: tuple[int, int], subpixels: int, blur_px: float) -> Transfer:
    """OTF of the sensor over that of the Gaussian, at the frequencies of the fine grid."""
    v = fft.fftfreq(shape[0] * subpixels, 1 / subpixels)[:, None]
    u = fft.rfftfreq(shape[1] * subpixels, 1 / subpixels)[None, :]
    sharper = np.exp(2 * (math.pi * blur_px) ** 2 * v**2) * np.exp(
        2 * (math.pi * blur_px) ** 2 * u**2
    )
    return np.asarray(sensor.otf(u, v) * sharper)


def _every_pixel(spectrum: Transfer, shape: tuple[int, int], subpixels: int) -> Floats:
    """The samples at pixel centres of an image on the fine grid, of its half spectrum."""
    rows, cols = shape
    # Taking every n-th row folds the spectrum; the columns are taken after the transform.
    folded = spectrum.reshape(subpixels, rows, -1).sum(axis=0)
    lines = fft.irfft(fft.ifft(folded, axis=0), cols * subpixels, axis=1)
    return np.ascontiguousarray(lines[:, ::subpixels]) / subpixels
