"""Ground made of rectangles and straight strips, as a sensor sees it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from numbers import Integral
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import (
    require_all,
    require_finite,
    require_floats,
    require_kind,
    require_rng,
    require_whole,
)
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import ModelError, OptionError
from acutance.geometry.line import Line
from acutance.optics.block import Transfer, require
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.ground import alias_bands
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_shape

__all__ = [
    "Patch",
    "Point",
    "Shape",
    "Strip",
    "add_patches",
    "grain_transfer",
    "render_patches",
    "render_strip",
    "stamp",
    "texture",
]

MARGIN_PX = 64
"""Empty ground around the image; light scattered further comes back on the other side."""

_STEP_PX = 16
"""Sizes of a patch's window are multiples of it, so that spectra of several patches are shared."""

_TILE_PX, _KERNEL_PX, _GRAIN_SIGMAS = 1024, 64, 4.0
"""A wide texture is filtered in tiles, which overlap by what the sensor scatters, or the grain."""


@dataclass(frozen=True)
class Patch:
    """A rectangle of uniform ground.

    Parameters
    ----------
    row, col : float
        Its centre in pixels; integers are pixel centres.
    width_px, height_px : float
        Its sides, the first along the column axis before the rectangle is turned.
    turn_deg : float
        Turn from the column axis towards the row axis (clockwise on the screen).
    contrast : float
        Level above the ground around it, in image units.
    """

    row: float
    col: float
    width_px: float
    height_px: float
    turn_deg: float
    contrast: float

    def __post_init__(self) -> None:
        require(self, above=True, width_px=self.width_px, height_px=self.height_px)
        require(self, -math.inf, row=self.row, col=self.col, turn_deg=self.turn_deg)
        require(self, -math.inf, contrast=self.contrast)

    def spectrum(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Fourier transform of the patch about its own centre (real), at cycles per pixel."""
        cos, sin = unit_vector(self.turn_deg)
        u, v = np.asarray(u, float), np.asarray(v, float)
        p, q = cos * u + sin * v, cos * v - sin * u
        area = self.contrast * self.width_px * self.height_px
        return np.asarray(area * np.sinc(self.width_px * p) * np.sinc(self.height_px * q))


@dataclass(frozen=True)
class Strip:
    """An endless straight strip: a road, a canal, a bridge.

    Parameters
    ----------
    row, col : float
        A point on its middle line.
    normal_deg : float
        Direction across it, from the column axis towards the row axis.
    width_px : float
        Width across.
    contrast : float
        Level above the ground around it, in image units.
    """

    row: float
    col: float
    normal_deg: float
    width_px: float
    contrast: float

    def __post_init__(self) -> None:
        require(self, above=True, width_px=self.width_px)
        require(self, -math.inf, row=self.row, col=self.col, normal_deg=self.normal_deg)
        require(self, -math.inf, contrast=self.contrast)


def render_strip(sensor: Sensor, strip: Strip, shape: tuple[int, int]) -> Floats:
    """A strip above dark ground: the difference of two ESFs, exact; (rows, cols) array.

    Raises
    ------
    ModelError, OptionError
        If the image is too large, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_kind(Strip, strip=strip)
    require_shape(shape, MAX_SCENE_PIXELS)
    middle = Line(strip.row, strip.col, strip.normal_deg)
    distance = middle.normal_distance(*np.indices(shape))
    esf = sensor.profile(strip.normal_deg).esf
    half = 0.5 * strip.width_px
    return np.asarray(strip.contrast * (esf(distance + half) - esf(distance - half)))


@dataclass(frozen=True)
class Point:
    """A source too small to have a shape: a mirror, a lamp.

    Parameters
    ----------
    row, col : float
        Its place in pixels; integers are pixel centres.
    flux : float
        Its light: the sum over all pixels of what it adds to the image.
    """

    row: float
    col: float
    flux: float

    def __post_init__(self) -> None:
        require(self, -math.inf, row=self.row, col=self.col, flux=self.flux)

    def spectrum(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Fourier transform about its own place: the flux at every frequency."""
        return np.full(np.broadcast_shapes(np.shape(u), np.shape(v)), self.flux)


class Shape(Protocol):
    """What lies on the ground at a place, with a spectrum in closed form."""

    @property
    def row(self) -> float:
        """Row of its centre in pixels."""
        ...

    @property
    def col(self) -> float:
        """Column of its centre."""
        ...

    def spectrum(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Fourier transform about its own centre, at cycles per pixel."""
        ...


def render_patches(
    sensor: Sensor,
    patches: Sequence[Shape],
    shape: tuple[int, int],
    *,
    margin_px: int = MARGIN_PX,
) -> Floats:
    """Patches and points above dark ground, each pixel with all the light that reaches it.

    The spectrum of a rectangle has a closed form, so nothing is drawn on a finer grid: the
    image's spectrum is the sum over all alias bands of patch spectra times the OTF. Corners
    are as exact as edges. What remains is the light of the copies one period away: with 64 px
    of empty ground between, below 1e-6 of the contrast for systems without tails, 1e-4 for an
    aperture's.

    Parameters
    ----------
    sensor : Sensor
    patches : sequence of Patch, Point or another Shape
        Inside the image or less than half the margin outside of it.
    shape : (rows, cols)
    margin_px : int, optional
        Empty ground between the image and its copies.

    Returns
    -------
    (rows, cols) array

    Raises
    ------
    ModelError, OptionError
        If the image is too large, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape)
    require_whole(0, margin_px=margin_px)
    _require_shapes(patches)
    rows, cols = (size + margin_px for size in shape)
    folded = np.zeros((rows, cols // 2 + 1), complex)
    points = [(one.row, one.col, one.flux) for one in patches if isinstance(one, Point)]
    row, col, flux = np.array(points, float).reshape(-1, 3).T
    for u, v, otf in _bands(sensor, rows, cols):
        # Of all points at once: a product of two matrices.
        ground = (np.exp(-2j * math.pi * v * row) * flux) @ np.exp(-2j * math.pi * np.outer(col, u))
        for patch in (one for one in patches if not isinstance(one, Point)):
            phase = np.exp(-2j * math.pi * v * patch.row) * np.exp(-2j * math.pi * u * patch.col)
            ground += patch.spectrum(u, v) * phase
        folded += ground * otf
    return np.ascontiguousarray(np.fft.irfft2(folded, (rows, cols))[: shape[0], : shape[1]])


def _require_shapes(patches: Any) -> None:
    for number, one in enumerate(require_all(object, "patches", patches), start=1):
        if isinstance(one, type) or not callable(getattr(one, "spectrum", None)):
            found = f"number {number} of patches is {one!r:.80}"
            raise OptionError(f"{found}: give Patch(...) or Point(...)")


@lru_cache(maxsize=4)
def _bands(sensor: Sensor, rows: int, cols: int) -> tuple[tuple[Floats, Floats, Transfer], ...]:
    """Frequencies (u, v) of every alias band of an image, and the OTF at them."""
    around = range(-alias_bands(sensor), alias_bands(sensor) + 1)
    right: Floats = np.asarray(np.fft.rfftfreq(cols), np.float64)
    down: Floats = np.asarray(np.fft.fftfreq(rows)[:, None], np.float64)
    frequencies = [(right + band_u, down + band_v) for band_v in around for band_u in around]
    return tuple((u, v, sensor.otf(u, v)) for u, v in frequencies)


def add_patches(
    image: NDArray[Any], sensor: Sensor, patches: Sequence[Patch | Point], *, reach_px: int = 24
) -> None:
    """Add patches and points that lie together to a large image, at the cost of a small one.

    Only a window around them is rendered: light that goes further than `reach_px` is left out,
    below 1e-6 of the contrast for systems without tails, 1e-3 for an aperture's.

    Parameters
    ----------
    image : (rows, cols) array
        Changed in place: a canvas.
    sensor : Sensor
    patches : sequence of Patch or Point
    reach_px : int, optional
        Room around them, in pixels.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    """
    require_canvas(image)
    require_all((Patch, Point), "patches", patches)
    require_whole(0, reach_px=reach_px)
    if not patches:
        return
    extents = [
        0.0 if isinstance(one, Point) else 0.5 * math.hypot(one.width_px, one.height_px)
        for one in patches
    ]
    top, left = (
        math.floor(min(at - e for at, e in zip(places, extents, strict=True))) - reach_px
        for places in ([one.row for one in patches], [one.col for one in patches])
    )
    bottom, right = (
        math.ceil(max(at + e for at, e in zip(places, extents, strict=True))) + reach_px
        for places in ([one.row for one in patches], [one.col for one in patches])
    )
    # Whole multiples of a step, so that windows share their frequencies.
    shape = tuple(-(-size // _STEP_PX) * _STEP_PX for size in (bottom - top, right - left))
    moved = [replace(one, row=one.row - top, col=one.col - left) for one in patches]
    stamp(image, render_patches(sensor, moved, (shape[0], shape[1]), margin_px=0), top, left)


def stamp(image: NDArray[Any], part: Floats, top: int, left: int) -> None:
    """Add a small image to a large one in place; what lies outside is cut off.

    Parameters
    ----------
    image : (rows, cols) array
        Changed in place.
    part : (m, n) array
    top, left : int
        Where the first pixel of `part` goes.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    """
    require_canvas(image)
    part = require_floats("part", part)
    if part.ndim != 2:
        raise OptionError(f"part has the shape {part.shape}: give rows and columns of numbers")
    for name, place in (("top", top), ("left", left)):
        if not isinstance(place, Integral):
            raise OptionError(f"{name} is {place!r:.80}: it has to be a whole number of pixels")
    first, last = max(top, 0), min(top + part.shape[0], image.shape[0])
    begin, end = max(left, 0), min(left + part.shape[1], image.shape[1])
    if first < last and begin < end:
        image[first:last, begin:end] += part[first - top : last - top, begin - left : end - left]


def require_canvas(image: Any) -> None:
    """Refuse what cannot be drawn on: anything but an array of rows and columns of floats.

    Raises
    ------
    OptionError
        Names what was given.
    """
    if not isinstance(image, np.ndarray) or image.ndim != 2 or image.dtype.kind != "f":
        raise OptionError(
            f"image is {image!r:.80}: give rows and columns to draw on, numpy.zeros(shape)"
        )


def texture(
    sensor: Sensor, shape: tuple[int, int], std: float, grain_px: float, rng: np.random.Generator
) -> Floats:
    """Random ground with Gaussian grain seen through the sensor, mean 0.

    Parameters
    ----------
    sensor : Sensor
    shape : (rows, cols)
    std : float
        Standard deviation in the image, over many images.
    grain_px : float
        Standard deviation of the Gaussian grain in pixels, at least 0.5 (finer grain would
        alias, which is not modelled here).
    rng : numpy.random.Generator

    Returns
    -------
    (rows, cols) array

    Raises
    ------
    ModelError, OptionError
        If the image is too large, the grain too fine, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape, MAX_SCENE_PIXELS)
    require_finite(std=std, grain_px=grain_px)
    rng = require_rng(rng, "texture")
    if grain_px < 0.5:
        raise ModelError(f"texture: grain_px is {grain_px:g}, it has to be at least 0.5")
    if max(shape) > _TILE_PX:
        return _wide_texture(sensor, shape, std, grain_px, rng)
    grain, gain = grain_transfer(sensor, shape, grain_px)
    white = np.fft.rfft2(rng.standard_normal(shape))
    return np.asarray(std * gain * np.fft.irfft2(white * grain, shape))


@lru_cache(maxsize=4)
def grain_transfer(
    sensor: Sensor, shape: tuple[int, int], grain_px: float
) -> tuple[Transfer, float]:
    """Transfer of a grain seen through the sensor, and what gives it unit variance."""
    u = np.fft.rfftfreq(shape[1])
    v = np.fft.fftfreq(shape[0])[:, None]
    grain = np.exp(-2 * (math.pi * grain_px) ** 2 * (u**2 + v**2)) * sensor.otf(u, v)
    impulse = np.fft.irfft2(grain, shape)
    return grain, float(1 / np.sqrt(np.sum(impulse**2)))


def _wide_texture(
    sensor: Sensor, shape: tuple[int, int], std: float, grain_px: float, rng: np.random.Generator
) -> Floats:
    """Texture of a large image, tile after tile, in single precision: tiles overlap and add up."""
    half = max(_KERNEL_PX // 2, math.ceil(_GRAIN_SIGMAS * grain_px))
    side = _TILE_PX + 2 * half
    grain, gain = grain_transfer(sensor, (side, side), grain_px)
    total = np.zeros(shape, np.float32)
    for top in range(-half, shape[0] + half, _TILE_PX):
        for left in range(-half, shape[1] + half, _TILE_PX):
            white = np.zeros((side, side))
            white[half:-half, half:-half] = rng.standard_normal((_TILE_PX, _TILE_PX))
            tile = np.fft.irfft2(np.fft.rfft2(white) * grain, (side, side))
            stamp(total, std * gain * tile, top - half, left - half)
    return np.asarray(total)
