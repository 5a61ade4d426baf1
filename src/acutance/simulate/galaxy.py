"""Galaxies: discs and bulges, whose spectra are known in closed form or from a table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import j0

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import require

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

__all__ = ["Galaxy", "Profile"]

Profile = Literal["exponential", "de-vaucouleurs"]

_HALF_LIGHT_OF_SCALE: Final = 1.67834699
"""Half-light radius of an exponential disc over its scale length."""
_TAPER: Final = (4.0, 8.0)
"""Half-light radii between which a de Vaucouleurs profile is led to zero."""
_VAUCOULEURS: Final = 7.23868376
"""The constant b of exp(-b (r / r_e)^(1/4)) that puts half of the light within r_e, led to zero so;
7.669 of a profile without an end, which has 15 % of its light beyond 4 r_e."""
_MAX_FREQ: Final = 200.0


@dataclass(frozen=True)
class Galaxy:
    """A galaxy with elliptical isophotes.

    Parameters
    ----------
    row, col : float
        Its centre in pixels; integers are pixel centres.
    flux : float
        Its light: the sum over all pixels of what it adds to the image.
    half_light_px : float
        Radius of the circle with the area of the ellipse that holds half of the light.
    profile : {"exponential", "de-vaucouleurs"}
        How its light falls: that of a disc, or of a bulge, led to zero between
        4 and 8 of its half-light radii.
    axis_ratio : float
        Minor over major axis, 0.1 to 1.
    turn_deg : float
        Direction of the major axis, from the column axis towards the row axis.

    Raises
    ------
    ModelError
        If a number or the profile makes no sense.
    """

    row: float
    col: float
    flux: float
    half_light_px: float
    profile: Profile = "exponential"
    axis_ratio: float = 1.0
    turn_deg: float = 0.0

    def __post_init__(self) -> None:
        require(self, above=True, half_light_px=self.half_light_px)
        require(self, 0.1, 1.0, axis_ratio=self.axis_ratio)
        require(self, -math.inf, row=self.row, col=self.col, flux=self.flux, turn_deg=self.turn_deg)
        if not isinstance(self.profile, str) or self.profile not in get_args(Profile):
            raise ModelError(
                f'Galaxy: profile is {self.profile!r}, it has to be "exponential" or '
                '"de-vaucouleurs"'
            )

    def spectrum(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Fourier transform about its own centre (real), at cycles per pixel."""
        cos, sin = unit_vector(self.turn_deg)
        u, v = np.asarray(u, float), np.asarray(v, float)
        stretch = math.sqrt(self.axis_ratio)
        freq = np.hypot((cos * u + sin * v) / stretch, (cos * v - sin * u) * stretch)
        if self.profile == "exponential":
            scale = 2 * math.pi * self.half_light_px / _HALF_LIGHT_OF_SCALE
            return np.asarray(self.flux / (1 + (scale * freq) ** 2) ** 1.5)
        return np.asarray(self.flux * _bulge(freq * self.half_light_px))


def _bulge(freq: Floats) -> Floats:
    """Spectrum of a de Vaucouleurs profile at frequencies in cycles per half-light radius."""
    low = np.log(np.clip(freq, 1e-3, _MAX_FREQ))
    return np.asarray(_bulge_table()(low))


@cache
def _bulge_table() -> CubicSpline:
    """The Hankel transform of the profile over the logarithm of the frequency."""
    from scipy.interpolate import CubicSpline

    # In t = (r / r_e)^(1/4) the integrand is smooth; its fastest wave takes 10 steps a period.
    begin, edge = _TAPER
    steps = round(40 * edge * _MAX_FREQ)
    t = (np.arange(steps) + 0.5) * edge**0.25 / steps
    taper = np.cos(0.5 * math.pi * np.clip((t**4 - begin) / (edge - begin), 0.0, 1.0)) ** 2
    light = t**7 * np.exp(-_VAUCOULEURS * t) * taper
    log_freq = np.linspace(math.log(1e-3), math.log(_MAX_FREQ), 160)
    values = [light @ j0(2 * math.pi * math.exp(one) * t**4) for one in log_freq.tolist()]
    return CubicSpline(log_freq, np.array(values) / light.sum())
