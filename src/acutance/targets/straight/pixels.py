"""The usable pixels around one straight edge, and a fit of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.geometry.line import Line
from acutance.numerics.compiled import compiled
from acutance.numerics.gaussian_pixel import GaussianPixel

__all__ = ["EdgeFit", "EdgePixels", "Pixels"]


@dataclass(frozen=True, eq=False)
class Pixels:
    """The pixels of a fit, (n,) each.

    Attributes
    ----------
    at : two int arrays
        Their rows and columns, as an index of the image.
    row, col : arrays
        The same as coordinates; integers are pixel centres.
    value : array
    """

    at: tuple[NDArray[np.intp], NDArray[np.intp]]
    row: Floats
    col: Floats
    value: Floats

    @classmethod
    def of(cls, image: Floats) -> Pixels:
        """The finite pixels of an image, in row-major order."""
        rows, cols, (row, col, value) = _finite(np.ascontiguousarray(image, float))
        return cls((rows, cols), row, col, value)


@compiled
def _finite(image: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats]:
    """Rows and columns of the finite pixels; as coordinates, with their values, (3, n)."""
    finite = np.isfinite(image)
    count, n = np.count_nonzero(finite), 0
    rows, cols, found = np.empty(count, np.intp), np.empty(count, np.intp), np.empty((3, count))
    for row in range(image.shape[0]):
        for col in range(image.shape[1]):
            if finite[row, col]:
                rows[n], cols[n] = row, col
                found[0, n], found[1, n], found[2, n] = row, col, image[row, col]
                n += 1
    return rows, cols, found


@dataclass(frozen=True, eq=False)
class EdgePixels:
    """A region trimmed to one edge: the input of every edge method.

    Parameters
    ----------
    image : (rows, cols) array
        The region. Pixels that must not be used (nodata, masked, trimmed away) are NaN.
    line : Line
        The edge in pixels of the region, good to a tenth of a pixel or better.
    dark, bright : float
        Plateau levels, in the image's units.
    width_px : float
        Standard deviation of the Gaussian that fits the blur of the edge, in pixels.
    noise : float
        Standard deviation of the noise about the edge model, in the image's units.
    blur : GaussianPixel, optional
        The Gaussian through a pixel fitted to the edge together with line and levels; without it
        the reference method fits its own.
    """

    image: Floats
    line: Line
    dark: float
    bright: float
    width_px: float
    noise: float
    blur: GaussianPixel | None = None

    @cached_property
    def pixels(self) -> Pixels:
        """The pixels that may be used."""
        return Pixels.of(self.image)


@dataclass(frozen=True, eq=False)
class EdgeFit:
    """The result of a method for trimmed pixels.

    Parameters
    ----------
    line : Line
        The edge as the method located it, in pixels of the region, with standard deviations.
    response : Response
        The curves with their covariance; 0 of their distance axis is the 50 % point.
    dark, bright : float
        Plateau levels as the method fitted them.
    distance_px, value, residual : (n,) arrays
        The pixels used (row-major order of the trimmed pixels): normal distance from the
        50 % point, edge response normalised to 0..1, and its residual.
    """

    line: Line
    response: Response
    dark: float
    bright: float
    distance_px: Floats
    value: Floats
    residual: Floats
