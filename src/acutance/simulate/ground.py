"""Ground drawn in fine squares, and clutter (ground that is not uniform), as a sensor sees them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import (
    require_choice,
    require_floats,
    require_rng,
    require_types,
    require_whole,
)
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import Transfer, require, require_count
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_shape

__all__ = ["GroundNoise", "alias_bands", "render_raster"]

MAX_BANDS = 8
NEGLIGIBLE = 1e-5
"""Contrast below which an alias band is left out."""

MARGIN_PX = 8
"""Ground drawn beyond the image for noise; what is scattered further comes from the other side."""

MAX_SUBPIXELS = 60_000_000


def alias_bands(sensor: Sensor) -> int:
    """Number of alias bands on either side of the first that still carry light, 1 to 8.

    Raises
    ------
    OptionError
        If there is no sensor.
    """
    require_sensor(sensor)
    freq = np.arange(0.5, MAX_BANDS + 0.5, 0.02)
    strength = np.maximum(np.abs(sensor.otf(freq, 0.0)), np.abs(sensor.otf(0.0, freq)))
    return max(1, math.ceil(float(np.max(freq[strength > NEGLIGIBLE], initial=0.5)) - 0.5))


Drawn = Literal["squares", "points", "means"]


def render_raster(
    sensor: Sensor, ground: Floats, subpixels: int, *, drawn: Drawn = "squares"
) -> Floats:
    """Ground drawn on a fine grid, seen through a sensor.

    Exact for ground made of uniform squares: its spectrum is that of its samples times the sinc
    of a square, times the OTF, summed over the alias bands (those above 1e-5 of contrast, 8 at
    most). The ground repeats itself beyond its borders.

    Parameters
    ----------
    sensor : Sensor
    ground : (rows * subpixels, cols * subpixels) array
        Levels of the squares; `subpixels` of them side by side fill a pixel.
    subpixels : int
        At least 1.
    drawn : {"squares", "points", "means"}, optional
        The meaning of a sample: the level of a uniform square, the level at the square's centre, or
        the mean over the square. The last two hold for ground with
        little contrast beyond ``subpixels / 2`` cycles per pixel.

    Returns
    -------
    (rows, cols) array

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    ModelError
        If the ground does not fill whole pixels.
    """
    require_sensor(sensor)
    require_whole(1, subpixels=subpixels)
    require_choice(get_args(Drawn), drawn=drawn)
    ground = require_floats("ground", ground)
    if ground.ndim != 2 or any(size % subpixels for size in ground.shape):
        raise ModelError(
            f"ground of shape {ground.shape} does not fill whole pixels of {subpixels} by "
            f"{subpixels} squares: give sizes that are multiples of {subpixels}"
        )
    rows, cols = (size // subpixels for size in ground.shape)
    reach = alias_bands(sensor) + 0.5
    right = np.arange(math.ceil(reach * cols) + 1)
    down = np.arange(-math.ceil(reach * rows), math.ceil(reach * rows) + 1)
    # The spectrum of samples repeats itself; that of squares does not.
    across = np.fft.fft(ground, axis=1)[:, right % ground.shape[1]]
    spectrum = np.fft.fft(across, axis=0)[down % ground.shape[0]]
    u, v = right / cols, down[:, None] / rows
    # The centre of a pixel's first square lies this far before that of the pixel.
    first = 0.5 * (subpixels - 1) / subpixels
    power = {"squares": 1, "points": 0, "means": -1}[drawn]
    square_u = np.sinc(u / subpixels) ** power * np.exp(2j * math.pi * first * u)
    square_v = np.sinc(v / subpixels) ** power * np.exp(2j * math.pi * first * v)
    # Half of the plane of frequencies is enough for a real image, its border counted half.
    square_u[0] *= 0.5
    spectrum *= sensor.otf(u, v)
    spectrum *= square_u
    spectrum *= square_v
    folded = _fold(_fold(spectrum, right % cols, cols).T, down % rows, rows).T
    return np.asarray(2 / subpixels**2 * np.fft.ifft2(folded).real)


def _fold(spectrum: Transfer, index: NDArray[np.int_], size: int) -> Transfer:
    """Sum columns that have the same place in a shorter spectrum."""
    folded: Transfer = np.zeros((spectrum.shape[0], size), complex)
    for start in range(0, index.size, size):
        part = index[start : start + size]
        folded[:, part] += spectrum[:, start : start + size]
    return folded


@dataclass(frozen=True)
class GroundNoise:
    """Clutter, ground that is not uniform: white fields of several grain sizes on the target.

    As in the SDSU generic sensor model (2005, 3.4.3.1): for every grain a field of independent,
    normally distributed squares, with a random origin of its grid; all fields have the same
    variance and are summed. It is part of the ground, so the sensor blurs it.

    Parameters
    ----------
    variance : float, optional
        Variance of each field, in squared image units.
    grains : tuple of int, optional
        Sides of the squares in sub-pixels, 1 to 20 unless given.
    subpixels : int, optional
        Sub-pixels in a pixel, 1 to 100.

    Raises
    ------
    ModelError
        If a number makes no sense, or there is no grain.
    OptionError
        If the grains are no whole numbers.
    """

    variance: float = 100.0
    grains: tuple[int, ...] = tuple(range(1, 21))
    subpixels: int = 20

    def __post_init__(self) -> None:
        require(self, variance=self.variance)
        require_count(self, 100, subpixels=self.subpixels)
        require_types(self)
        if not len(self.grains) or min(self.grains) < 1:
            raise ModelError(f"grains are {self.grains}, there have to be some, all 1 or more")

    @property
    def std(self) -> float:
        """Standard deviation on the ground, before the sensor."""
        return math.sqrt(self.variance * len(self.grains))

    def std_seen_by(self, sensor: Sensor) -> float:
        """Standard deviation in the image, over many images.

        Every grain is white noise through a square: its power spectrum times the squared MTF,
        summed over all frequencies that a sub-pixel grid holds.

        Raises
        ------
        OptionError
            If there is no sensor.
        """
        require_sensor(sensor)
        freq = (np.arange(-640, 640) + 0.5) / 64
        power = np.abs(sensor.otf(freq, freq[:, None])) ** 2
        total = 0.0
        for grain in self.grains:
            side = grain / self.subpixels
            square = np.sinc(freq * side) ** 2 * side
            total += float(square @ power @ square) / 64**2
        return math.sqrt(self.variance * total)

    def field(self, shape: tuple[int, int], rng: np.random.Generator) -> Floats:
        """One realisation on the ground.

        Parameters
        ----------
        shape : (rows, cols)
            In pixels.
        rng : numpy.random.Generator

        Returns
        -------
        (rows * subpixels, cols * subpixels) array

        Raises
        ------
        ModelError, OptionError
            If the field would have more than 60 million squares, the shape is none, or no
            generator was handed in.
        """
        require_shape(shape, MAX_SCENE_PIXELS)
        rng = require_rng(rng, "ground noise")
        height, width = (size * self.subpixels for size in shape)
        if height * width > MAX_SUBPIXELS:
            raise ModelError(
                f"ground noise over {shape[0]} by {shape[1]} px has {height * width / 1e6:.0f} "
                f"million squares of 1/{self.subpixels} px, {MAX_SUBPIXELS / 1e6:.0f} million are "
                "possible: use a smaller image, or texture for a whole scene"
            )
        total = np.zeros((height, width))
        for grain in self.grains:
            down, right = (int(start) for start in rng.integers(0, grain, 2))
            cells = ((height + down - 1) // grain + 1, (width + right - 1) // grain + 1)
            coarse = rng.standard_normal(cells)
            stripes = coarse[:, (np.arange(width) + right) // grain]
            total += stripes[(np.arange(height) + down) // grain]
        return total * math.sqrt(self.variance)

    def seen_by(
        self, sensor: Sensor, shape: tuple[int, int], rng: np.random.Generator | None
    ) -> Floats:
        """One realisation in the image, mean 0: what is to be added to the image of a target.

        Parameters
        ----------
        sensor : Sensor
        shape : (rows, cols)
        rng : numpy.random.Generator

        Returns
        -------
        (rows, cols) array
            As exact as `render_raster`; ground 8 px around the image is drawn too.

        Raises
        ------
        ModelError, OptionError
            If the field is too large, there is no sensor, or no generator was handed in.
        """
        require_sensor(sensor)
        require_shape(shape)
        drawn = require_rng(rng, "ground noise")
        wide = (shape[0] + 2 * MARGIN_PX, shape[1] + 2 * MARGIN_PX)
        image = render_raster(sensor, self.field(wide, drawn), self.subpixels)
        return np.ascontiguousarray(image[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX])
