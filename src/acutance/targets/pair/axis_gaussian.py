"""The parametric kernel: a Gaussian with the low sensor's detector, along either axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.interpolation import spline_transfer
from acutance.targets.pair.tile import TapAxis

__all__ = ["MAX_VARIANCE_PX2", "MIN_VARIANCE_PX2", "AxisGaussian"]

MIN_VARIANCE_PX2 = -0.06
"""A reference that is softer than the low sensor's optics leaves a ratio sharper than a detector:
the variance of the Gaussian may then fall below zero."""
MAX_VARIANCE_PX2 = 6.0
_NODES = 96


@dataclass(frozen=True)
class AxisGaussian:
    """Blur along one axis: ``exp(-2 pi^2 variance f^2) sinc(f) exp(-2 pi i f shift)``.

    Motion adds the twelfth part of its length's square to the variance, and so does all that
    blurs a little: a detector of another size, a defocus.

    Parameters
    ----------
    shift_px : float
        Displacement of the low image's content, in low pixels.
    variance_px2 : float
        Variance of the Gaussian, in low pixels squared.
    """

    shift_px: float = 0.0
    variance_px2: float = 0.1

    def taps(self, axis: TapAxis) -> Floats:
        """Kernel at the taps, its slopes by shift, variance and detector, and what interpolation
        onto the low image's grid would add to it: (taps, 5).

        The inverse Fourier integral over the reference's band, which ends at half a cycle per
        sample.
        """
        nodes, weights = _quadrature(_NODES * max(1, axis.per_px // 2))
        freq = 0.25 * axis.per_px * (nodes + 1)
        gaussian, sinc = np.exp(-2 * math.pi**2 * self.variance_px2 * freq**2), np.sinc(freq)
        mass = 0.5 * weights * gaussian * sinc
        angle = 2 * math.pi * freq * (axis.places_px[:, None] + self.shift_px)
        value = np.cos(angle) @ mass
        by_shift = -np.sin(angle) @ (2 * math.pi * freq * mass)
        by_variance = np.cos(angle) @ (-2 * math.pi**2 * freq**2 * mass)
        by_width = np.cos(angle) @ (0.5 * weights * gaussian * (np.cos(math.pi * freq) - sinc))
        by_resampling = np.cos(angle) @ ((spline_transfer(freq) - 1) * mass)
        return np.stack([value, by_shift, by_variance, by_width, by_resampling], axis=1)


@cache
def _quadrature(nodes: int) -> tuple[Floats, Floats]:
    """Places and weights of Gauss and Legendre on -1 to 1."""
    return np.polynomial.legendre.leggauss(nodes)
