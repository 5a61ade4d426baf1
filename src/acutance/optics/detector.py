"""Blur made by the detector: the area of a pixel and the charge that wanders in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Transfer, require

__all__ = ["ChargeDiffusion", "Detector"]


@dataclass(frozen=True)
class Detector:
    """The rectangular sensitive area of a pixel: ``sinc(w u) sinc(h v)``.

    Parameters
    ----------
    width_px : float, optional
        Width along the column axis in pixels; 1 is a fill factor of 100 %.
    height_px : float, optional
        Height along the row axis in pixels; the same as the width unless given.
    """

    width_px: float = 1.0
    height_px: float | None = None

    def __post_init__(self) -> None:
        require(self, width_px=self.width_px)
        if self.height_px is not None:
            require(self, height_px=self.height_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        height = self.width_px if self.height_px is None else self.height_px
        return np.sinc(self.width_px * np.asarray(u)) * np.sinc(height * np.asarray(v))


@dataclass(frozen=True)
class ChargeDiffusion:
    """Charge born at the far side of a field-free layer, spreading before it is collected.

    ``cosh(d / L) / cosh(d sqrt((2 pi f)^2 + 1 / L^2))``, the solution of the diffusion equation
    for a thinned detector lit from the back (Crowell and Labuda, Bell Syst. Tech. J. 48, 1481,
    1969); `f` is the radial frequency.

    Parameters
    ----------
    depth_px : float
        Thickness d of the layer in pixels (depth in micrometres over the pitch).
    diffusion_length_px : float, optional
        Diffusion length L in pixels; infinite (nothing recombines) unless given.
    """

    depth_px: float
    diffusion_length_px: float | None = None

    def __post_init__(self) -> None:
        require(self, depth_px=self.depth_px)
        if self.diffusion_length_px is not None:
            require(self, above=True, diffusion_length_px=self.diffusion_length_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        inverse = 0.0 if self.diffusion_length_px is None else 1.0 / self.diffusion_length_px
        rest = self.depth_px * inverse
        travelled = self.depth_px * np.sqrt((2 * math.pi * np.hypot(u, v)) ** 2 + inverse**2)
        # cosh a / cosh b with the large exponentials cancelled by hand.
        growth = np.exp(rest - travelled)
        return np.asarray(growth * (1 + math.exp(-2 * rest)) / (1 + np.exp(-2 * travelled)))
