"""Ground of a pair of images: fields with straight borders, and texture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.arguments import require_kind, require_rng, require_whole
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import require
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_shape

__all__ = ["PairGround", "pair_ground"]

_MANY_FIELDS = 1 << 16
"""Lines cut ground into fewer fields than there are sides to lie on: above so many they are
counted."""


@dataclass(frozen=True)
class PairGround:
    """Fields with straight borders, and a texture whose power falls like a power of frequency.

    Parameters
    ----------
    fields : int, optional
        Number of straight borders drawn across the ground; none leaves the texture alone.
    texture : float, optional
        Standard deviation of the texture as a share of the contrast between the fields.
    slope : float, optional
        Exponent of the texture's power spectrum, ``f^-slope``; natural scenes have 2 to 3.
    """

    fields: int = 12
    texture: float = 0.15
    slope: float = 2.4

    def __post_init__(self) -> None:
        require(self, 0.0, 40.0, fields=self.fields)
        require(self, texture=self.texture, slope=self.slope)
        if self.fields == 0 and self.texture == 0:
            raise ModelError("PairGround: no fields and no texture leave uniform ground")


def pair_ground(
    shape: tuple[int, int], period: int, ground: PairGround, rng: np.random.Generator
) -> Floats:
    """Samples of a landscape, 0 in the darkest field and 1 in the brightest, texture added.

    Parameters
    ----------
    shape : (rows, cols)
    period : int
        Samples in a low pixel; the texture levels off at periods longer than 64 of these.
    ground : PairGround
    rng : numpy.random.Generator

    Returns
    -------
    (rows, cols) array

    Raises
    ------
    ModelError, OptionError
        If the shape is too large, or an argument of the wrong kind.
    """
    require_shape(shape, MAX_SCENE_PIXELS)
    require_whole(1, period=period)
    require_kind(PairGround, ground=ground)
    rng = require_rng(rng, "ground of a pair")
    number, count = _fields(shape, ground.fields, rng)
    level = rng.permutation(np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5]))
    radiance: Floats = level[number]
    if ground.texture > 0:
        # Frequencies of either sign have one amplitude.
        v = fft.rfftfreq(shape[0])[:, None] * period
        u = fft.rfftfreq(shape[1])[None, :] * period
        half = (np.hypot(u, v) ** 2 + (1 / 64) ** 2) ** (-ground.slope / 4)
        spectrum = fft.rfft2(rng.standard_normal(shape))
        spectrum[: len(half)] *= half
        spectrum[len(half) :] *= half[1 : shape[0] - len(half) + 1][::-1]
        noise = fft.irfft2(spectrum, shape)
        radiance = radiance + ground.texture * noise / noise.std()
    return radiance


def _fields(
    shape: tuple[int, int], lines: int, rng: np.random.Generator
) -> tuple[NDArray[np.intp], int]:
    """The number of the field every sample lies in, (rows, cols), and of all fields.

    Straight lines cut the ground into fields: those that lie on the same sides of all of them.
    """
    rows = np.arange(shape[0])[:, None] / max(shape)
    cols = np.arange(shape[1])[None, :] / max(shape)
    number, count = np.zeros(shape, np.intp), 1
    across = np.empty(shape)
    for _ in range(lines):
        angle, place = rng.uniform(0, math.pi), rng.uniform(-0.45, 0.45)
        np.add((cols - 0.5) * math.cos(angle), (rows - 0.5) * math.sin(angle), out=across)
        number *= 2
        number += across > place
        count *= 2
        if count > _MANY_FIELDS:
            number, count = _counted(number, count)
    return _counted(number, count)


def _counted(number: NDArray[np.intp], most: int) -> tuple[NDArray[np.intp], int]:
    """Numbers below `most`, those that are none left out."""
    is_one = np.bincount(number.ravel(), minlength=most) > 0
    return (np.cumsum(is_one) - 1)[number], int(is_one.sum())
