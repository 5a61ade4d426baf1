"""Ground made of rectangles and strips, as a sensor sees it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.fit.line import Line
from acutance.optics.block import require
from acutance.optics.sensor import Sensor
from acutance.simulate.ground import alias_bands

__all__ = ["Patch", "Strip", "render_patches", "render_strip", "texture"]

MARGIN_PX = 64
"""Empty ground around the image; light scattered further comes back on the other side."""


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

    def spectrum(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Fourier transform of the patch about its own centre (real), at cycles per pixel."""
        angle = math.radians(self.turn_deg)
        u, v = np.asarray(u, float), np.asarray(v, float)
        p = math.cos(angle) * u + math.sin(angle) * v
        q = math.cos(angle) * v - math.sin(angle) * u
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


def render_strip(sensor: Sensor, strip: Strip, shape: tuple[int, int]) -> Floats:
    """A strip above dark ground: the difference of two ESFs, exact; (rows, cols) array."""
    middle = Line(strip.row, strip.col, strip.normal_deg)
    distance = middle.normal_distance(*np.indices(shape))
    esf = sensor.profile(strip.normal_deg).esf
    half = 0.5 * strip.width_px
    return np.asarray(strip.contrast * (esf(distance + half) - esf(distance - half)))


def render_patches(sensor: Sensor, patches: Sequence[Patch], shape: tuple[int, int]) -> Floats:
    """Patches above dark ground, each pixel with all the light that reaches it.

    The spectrum of a rectangle has a closed form, so nothing is drawn on a finer grid: the
    image's spectrum is the sum over all alias bands of patch spectra times the OTF. Corners
    are as exact as edges. What remains is the light of the copies one period away: at least
    64 px of empty ground lie between, which leaves below 1e-6 of the contrast for
    systems without tails, 1e-4 for an aperture's.

    Parameters
    ----------
    sensor : Sensor
    patches : sequence of Patch
        Inside the image or less than 32 px outside of it.
    shape : (rows, cols)

    Returns
    -------
    (rows, cols) array
    """
    rows, cols = (size + MARGIN_PX for size in shape)
    bands = range(-alias_bands(sensor), alias_bands(sensor) + 1)
    folded = np.zeros((rows, cols // 2 + 1), complex)
    for band_v in bands:
        v = (np.fft.fftfreq(rows) + band_v)[:, None]
        for band_u in bands:
            u = np.fft.rfftfreq(cols) + band_u
            ground = np.zeros(folded.shape, complex)
            for patch in patches:
                phase_u = np.exp(-2j * math.pi * u * patch.col)
                phase_v = np.exp(-2j * math.pi * v * patch.row)
                ground += patch.spectrum(u, v) * phase_u * phase_v
            folded += ground * sensor.otf(u, v)
    return np.ascontiguousarray(np.fft.irfft2(folded, (rows, cols))[: shape[0], : shape[1]])


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
    """
    if not grain_px >= 0.5:
        raise ModelError(f"texture: grain_px is {grain_px:g}, it has to be at least 0.5")
    u = np.fft.rfftfreq(shape[1])
    v = np.fft.fftfreq(shape[0])[:, None]
    grain = np.exp(-2 * (math.pi * grain_px) ** 2 * (u**2 + v**2)) * sensor.otf(u, v)
    impulse = np.fft.irfft2(grain, shape)
    white = np.fft.rfft2(rng.standard_normal(shape))
    return np.asarray(std * np.fft.irfft2(white * grain, shape) / np.sqrt(np.sum(impulse**2)))
