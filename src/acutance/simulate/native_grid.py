"""Products: what a sensor saw on its own grid, interpolated onto that of the map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.optics.block import Transfer, require
from acutance.optics.interpolation import spline_transfer
from acutance.simulate.noise import Noise

__all__ = ["NativeGrid"]

_PHASE_PX = (0.3, 0.45)
"""Where the grids meet; both turn and pitch vary the phase over the image anyway."""


@dataclass(frozen=True)
class NativeGrid:
    """The grid a sensor samples on, and interpolation with a cubic spline from there.

    The phase between the two grids varies over the image, so the transfer of the interpolation is
    that of the mean phase, and light aliased by the native sampling has no fixed phase in the
    product.

    Parameters
    ----------
    turn_deg : float, optional
        From the product's columns to the native ones.
    pitch_row_px, pitch_col_px : float, optional
        Distances of native rows and columns in pixels of the product.
    """

    turn_deg: float = 18.0
    pitch_row_px: float = 1.048
    pitch_col_px: float = 1.003

    def __post_init__(self) -> None:
        require(self, -45.0, 45.0, turn_deg=self.turn_deg)
        require(self, 0.5, 2.0, pitch_row_px=self.pitch_row_px, pitch_col_px=self.pitch_col_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        """Mean transfer of the interpolation, frequencies in cycles per pixel of the product."""
        right, down = self._native(np.asarray(u, float), np.asarray(v, float))
        across = spline_transfer(right * self.pitch_col_px)
        return np.asarray(across * spline_transfer(down * self.pitch_row_px))

    def product(
        self,
        scene: Floats,
        samples: int,
        shape: tuple[int, ...],
        noise: Noise | None,
        rng: np.random.Generator,
    ) -> Floats:
        """An image sampled on the native grid, made noisy, and interpolated.

        Parameters
        ----------
        scene : (rows, cols) array
            The blurred ground, one period of it.
        samples : int
            Of the scene in a pixel of the product, whose first corners coincide.
        shape : (rows, cols)
            Of the product.
        noise : Noise or None
            Of the native image.
        rng : numpy.random.Generator
        """
        middle = [0.5 * (size - 1) for size in shape]
        rows, cols = np.indices(shape, float)
        right, down = self._native(cols - middle[1], rows - middle[0])
        right, down = right / self.pitch_col_px, down / self.pitch_row_px
        # A margin for the spline, whose weights fall to a thousandth within six pixels.
        half = [math.ceil(float(np.abs(one).max())) + 8 for one in (down, right)]
        i, j = np.indices([2 * size + 1 for size in half], float)
        y = (i - half[0] + _PHASE_PX[0]) * self.pitch_row_px
        x = (j - half[1] + _PHASE_PX[1]) * self.pitch_col_px
        cos, sin = unit_vector(self.turn_deg)
        places = [cos * y - sin * x + middle[0], cos * x + sin * y + middle[1]]
        # Four samples a pixel or more hold the image without aliasing: a spline of order 5
        # between them is as good as exact.
        at = [(place + 0.5) * samples - 0.5 for place in places]
        native: Floats = map_coordinates(scene, at, order=5, mode="grid-wrap")
        if noise is not None:
            native = noise.added_to(native, rng)
        back = [down + half[0] - _PHASE_PX[0], right + half[1] - _PHASE_PX[1]]
        return np.asarray(map_coordinates(native, back, order=3, mode="mirror"))

    def _native(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Components along the native columns' and rows' directions."""
        cos, sin = unit_vector(self.turn_deg)
        return np.asarray(cos * x - sin * y), np.asarray(sin * x + cos * y)
