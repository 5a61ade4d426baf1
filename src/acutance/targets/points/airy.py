"""The image of a point behind a round aperture that diffracts, seen through a square pixel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import j0, j1

from acutance.curves.grid import Floats
from acutance.optics import Diffraction

__all__ = ["Airy"]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_PLANE = 0.25 * np.outer(_WEIGHTS, _WEIGHTS).ravel()
_NARROWNESS = 1.03 / 2.3548200450309493
"""Cut-off times the standard deviation of a Gaussian with the Airy pattern's FWHM."""
_STEP_PX = 0.005
_REACH_PX = 60.0


@dataclass(frozen=True)
class Airy:
    """Image behind a perfect aperture, of unit volume, through a square of `aperture_px`.

    Parameters
    ----------
    cutoff_cpp : float
        Frequency where the OTF ends, in cycles per pixel.
    obscuration : float
        Diameter of the central obscuration over that of the aperture.
    aperture_px : float
        Side of the detector's square.
    """

    cutoff_cpp: float
    obscuration: float = 0.0
    aperture_px: float = 1.0

    @classmethod
    def as_narrow_as(cls, sigma_px: float, obscuration: float, aperture_px: float) -> Airy:
        """The pattern whose FWHM, were there no obscuration, is that of a Gaussian."""
        return cls(_NARROWNESS / sigma_px, obscuration, aperture_px)

    def slopes(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Light per square pixel at places (x, y), (n,), and its derivatives by x and y."""
        across, down = self._nodes(x, y)
        light, slope = (_read(table, across, down) for table in self._tables)
        return _PLANE @ light, _PLANE @ (slope * across), _PLANE @ (slope * down)

    def psf(self, x: Floats, y: Floats) -> Floats:
        """Light per square pixel at places (x, y), (n,)."""
        return np.asarray(_PLANE @ _read(self._tables[0], *self._nodes(x, y)))

    def _nodes(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Places within the aperture, (nodes, n)."""
        half = 0.5 * self.aperture_px
        across = x[None, :] + half * np.repeat(_NODES, _NODES.size)[:, None]
        return across, y[None, :] + half * np.tile(_NODES, _NODES.size)[:, None]

    @cached_property
    def _tables(self) -> tuple[Floats, Floats]:
        """The pattern, and its derivative by the radius over the radius, at steps of radius."""
        hole = self.obscuration
        scale = np.pi * self.cutoff_cpp
        z = np.maximum(scale * np.arange(0.0, _REACH_PX + _STEP_PX, _STEP_PX), 1e-4)
        field = 2 * (j1(z) - hole * j1(hole * z)) / z
        bend = 2 * (j0(z) - hole**2 * j0(hole * z)) / z - 2 * field / z
        peak = 0.25 * scale * self.cutoff_cpp / (1 - hole**2)
        return peak * field**2, 2 * peak * field * bend * scale**2 / z

    def otf(self, u: Floats, v: Floats) -> Floats:
        """Transfer function at frequencies in cycles per pixel."""
        box = np.sinc(self.aperture_px * u) * np.sinc(self.aperture_px * v)
        return np.asarray(Diffraction(self.cutoff_cpp, self.obscuration).otf(u, v) * box)


def _read(table: Floats, x: Floats, y: Floats) -> Floats:
    """A table over the radius at places (x, y), by linear interpolation."""
    place = np.minimum(np.sqrt(x * x + y * y) * (1 / _STEP_PX), (_REACH_PX - 1) / _STEP_PX)
    cell = place.astype(np.intp)
    place -= cell
    low = table.take(cell)
    cell += 1
    return np.asarray(low + place * (table.take(cell) - low))
