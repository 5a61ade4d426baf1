"""A two-dimensional transfer function as a sum of known shapes.

Mean: a Gaussian, elliptical and rotated, through a square pixel. Corrections: Gaussian processes
of the point spread function, with covariance
``exp(-(|x|^2 + |x'|^2) / 2 L^2) exp(-|x - x'|^2 / 2 l^2)`` as along a straight edge.
Their eigenfunctions are the states of the 2-D harmonic oscillator, whose Fourier transforms are
states again (Mehler's formula; Refregier, MNRAS 338, 35, 2003), and which are a radial function
times cos or sin of a whole multiple of the direction. A star needs just that.

Distances of the processes are in units of the width of the mean, frequencies in cycles per pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import eval_genlaguerre, gammaln

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.numerics.lorentz_tail import tail_otf
from acutance.numerics.process_modes import mehler

__all__ = [
    "HIGHEST_CPP",
    "MEAN_MODES",
    "PROCESSES",
    "Complexes",
    "MeanOtf",
    "Process",
    "ProcessModes",
]

Complexes = NDArray[np.complex128]

HIGHEST_CPP: Final = 2.5
"""Highest frequency that contributes to the image of a periodic target."""

MEAN_MODES: Final = 8
"""Level, three widths, two places, two apertures: the mean's own directions."""


@dataclass(frozen=True)
class Process:
    """A Gaussian process of extent L and smoothness l (widths), in states up to an order."""

    extent: float
    smoothness: float
    orders: int


PROCESSES: Final = (Process(1.2, 0.6, 12), Process(0.7, 0.17, 10), Process(3.0, 1.2, 10))
"""Of the same extents as those along an edge: shape, detail, halo."""


@dataclass(frozen=True)
class MeanOtf(GaussianPixel2d):
    """The mean of the prior: a Gaussian of covariance (xx, xy, yy) in px^2 through a pixel."""

    @property
    def width_px(self) -> float:
        """Full width at half maximum (FWHM) of the Gaussian with the same mean variance.

        It is the unit of distance of the processes.
        """
        return FWHM_OF_SIGMA * math.sqrt(0.5 * (self.xx + self.yy) + 1 / 12)

    def modes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Transfer, and its derivatives by xx, xy, yy, by the place and by the aperture, (n, 8).

        The place in px, x and y; the aperture in px, its width and its height.
        """
        otf, slopes = self.otf(u_cpp, v_cpp), self.otf_slopes(u_cpp, v_cpp)
        by_place = -2j * math.pi * otf[:, None] * np.stack([u_cpp, v_cpp], axis=1)
        return np.column_stack([otf, slopes[:, :3], by_place, slopes[:, 3:]])


@dataclass(frozen=True)
class ProcessModes:
    """The states of all processes, for a mean optical transfer function (OTF) of a given width."""

    width_px: float

    @property
    def orders(self) -> int:
        """Largest angular order."""
        return max(process.orders for process in PROCESSES)

    def radial(self, order: int, freq_cpp: Floats) -> Floats:
        """Radial parts with an angular order, (n, r), scaled to a unit process."""
        parts = [
            _state(process, order, total, freq_cpp * self.width_px)
            for process in PROCESSES
            for total in range(order, process.orders + 1, 2)
        ]
        if order == 0:
            # A term falling like 1/u^2 without end, as diffraction's does, has this transfer.
            parts.append(tail_otf(freq_cpp, self.width_px))
        return np.stack(parts, axis=-1) if parts else np.empty((freq_cpp.size, 0))

    def blocks(self) -> NDArray[np.intp]:
        """Number of the amplitude of each state, in the order of `otf_modes`: see `_block`."""
        return _blocks()

    def otf_modes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """All states at frequencies across and along, (n, r)."""
        angle = np.arctan2(v_cpp, u_cpp)
        # A table of frequencies has every distance from zero several times.
        freq, where = np.unique(np.hypot(u_cpp, v_cpp), return_inverse=True)
        found = np.zeros((u_cpp.size, self.blocks().size), complex)
        end = 0
        for order in range(self.orders + 1):
            radial = self.radial(order, freq)[where]
            seen = found.imag if order % 2 else found.real
            for wave in (np.cos, np.sin) if order else (np.cos,):
                first, end = end, end + radial.shape[1]
                np.multiply(radial, wave(order * angle)[:, None], out=seen[:, first:end])
        return found


def _states(process: Process) -> tuple[float, float, float]:
    """Scale of the states in widths, ratio of the eigenvalues, and the first of them.

    Scaled so that the process, integrated over one axis, has unit variance at the origin.
    """
    ratio, scale = mehler(process.extent, process.smoothness)
    long2, short2 = process.extent**2, process.smoothness**2
    first = math.pi * long2 * (1 - ratio) ** 2
    projected = 2 * math.pi * long2 / math.sqrt(1 + 2 * long2 / short2)
    return scale, ratio, first / projected


def _state(process: Process, order: int, total: int, freq: Floats) -> Floats:
    """Fourier transform of one state's radial part, times its standard deviation, (n,)."""
    scale, ratio, first = _states(process)
    nodes = (total - order) // 2
    x = 2 * math.pi * scale * freq
    norm = math.exp(0.5 * (math.log(2) + gammaln(nodes + 1) - gammaln(nodes + order + 1)))
    angular = 1 / math.sqrt(2 * math.pi if order == 0 else math.pi)
    value = norm * angular * x**order * eval_genlaguerre(nodes, order, x * x) * np.exp(-0.5 * x * x)
    return np.asarray(2 * math.pi * scale * math.sqrt(first * ratio**total) * value)


@cache
def _blocks() -> NDArray[np.intp]:
    """Amplitudes 0, 1, 2: the round states of the processes; 3, 4, 5: the others; 6: the tail."""
    block: list[int] = []
    for order in range(max(process.orders for process in PROCESSES) + 1):
        own = [
            k + (3 if order else 0)
            for k, process in enumerate(PROCESSES)
            for _ in range(order, process.orders + 1, 2)
        ]
        block += own + ([6] if order == 0 else own)
    return np.array(block, dtype=np.intp)
