"""Blur made after the charge was collected: filters and trails."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Axis, Transfer, along_axis, require, require_axis

__all__ = ["Butterworth", "Exponential", "TransferLoss"]


@dataclass(frozen=True)
class Butterworth:
    """The electronics of the generic sensor model: ``1 / (1 + (D / D0)^2)``.

    D is the radial frequency. The form is kept as printed in the SDSU generic sensor model
    (2005, equation 2.5); it is the squared modulus of a first order low-pass.

    Parameters
    ----------
    cutoff_cpp : float, optional
        D0 in cycles per pixel, where the transfer is 1/2.
    """

    cutoff_cpp: float = 1.4

    def __post_init__(self) -> None:
        require(self, above=True, cutoff_cpp=self.cutoff_cpp)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return np.asarray(1 / (1 + (np.hypot(u, v) / self.cutoff_cpp) ** 2))


@dataclass(frozen=True)
class Exponential:
    """A one-sided exponential trail, as slow electronics or lost charge leave it.

    The spread function is ``exp(-x / L) / L`` for x > 0 (towards higher columns or rows), its
    OTF ``1 / (1 + 2 pi i f L)``: complex, since the blur is not symmetric.

    Parameters
    ----------
    length_px : float
        Length L of the trail in pixels, at least 0.
    axis : {"across", "along"}, optional
        Direction of the trail.
    """

    length_px: float
    axis: Axis = "across"

    def __post_init__(self) -> None:
        require(self, length_px=self.length_px)
        require_axis(self, self.axis)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return np.asarray(1 / (1 + 2j * math.pi * self.length_px * along_axis(u, v, self.axis)))


@dataclass(frozen=True)
class TransferLoss:
    """Charge that stays behind, and comes with the next pixel: traps of a CCD that ages.

    Of every pixel's charge the share ``(1 - s) s^k`` arrives k pixels late (towards higher columns
    or rows); the transform is ``(1 - s) / (1 - s exp(-2 pi i f))``. Light of a pixel moves by whole
    pixels: above the Nyquist frequency the transfer rises again, as that of no exponential.

    Parameters
    ----------
    share : float
        Part s of the charge that is left, 0 to 0.9; it is late by ``s / (1 - s)`` px in the mean.
    axis : {"across", "along"}, optional
        Direction of the transfer.
    """

    share: float
    axis: Axis = "along"

    def __post_init__(self) -> None:
        require(self, 0.0, 0.9, share=self.share)
        require_axis(self, self.axis)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        late = np.exp(-2j * math.pi * along_axis(u, v, self.axis))
        return np.asarray((1 - self.share) / (1 - self.share * late))
