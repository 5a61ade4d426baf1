"""The pixels around one straight edge that serve its measurement, and a fit of them."""

from __future__ import annotations

from dataclasses import dataclass

from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.fit.blur import Blur
from acutance.fit.line import Line

__all__ = ["EdgeBand", "EdgeFit"]


@dataclass(frozen=True, eq=False)
class EdgeBand:
    """A region trimmed to one edge: what every edge method starts from.

    Parameters
    ----------
    image : (rows, cols) array
        The cut. Pixels that must not be used (nodata, masked, outside the band) are NaN.
    line : Line
        The edge in the cut's own coordinates, good to a tenth of a pixel or better.
    dark, bright : float
        Plateau levels, in the image's units.
    width_px : float
        Standard deviation of the Gaussian that fits the blur of the edge, in pixels.
    noise : float
        Standard deviation of the noise about the edge model, in the image's units.
    blur : Blur, optional
        The plain blur fitted to the edge, with line and levels to match; without it the
        reference method fits its own.
    """

    image: Floats
    line: Line
    dark: float
    bright: float
    width_px: float
    noise: float
    blur: Blur | None = None


@dataclass(frozen=True, eq=False)
class EdgeFit:
    """What a method makes of a band.

    Parameters
    ----------
    line : Line
        The edge as the method located it, in the cut's coordinates, with standard deviations.
    response : Response
        The curves with their covariance; 0 of their distance axis is the 50 % point.
    dark, bright : float
        Plateau levels as the method fitted them.
    distance_px, value, residual : (n,) arrays
        The pixels used (row-major order of the band's finite pixels): normal distance from the
        50 % point, edge response normalised to 0..1, and what the fit leaves of it.
    """

    line: Line
    response: Response
    dark: float
    bright: float
    distance_px: Floats
    value: Floats
    residual: Floats
