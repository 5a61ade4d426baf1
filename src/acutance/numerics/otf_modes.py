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

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
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

    def radial(self, freq_cpp: Floats) -> list[Floats]:
        """Radial parts of every angular order, (n, r) each, scaled to a unit process."""
        found = self._radial(freq_cpp)
        return np.split(found, _ends()[:-1], axis=1)

    def _radial(self, freq_cpp: Floats) -> Floats:
        """Radial parts of all angular orders, (n, r)."""
        found = np.empty((freq_cpp.size, _ends()[-1]))
        scales = np.array([_states(process)[0] for process in PROCESSES])
        _fill_radial(found, freq_cpp * self.width_px, scales, _counts(), _stds())
        # A term falling like 1/u^2 without end, as diffraction's does, has this transfer.
        found[:, _ends()[0] - 1] = tail_otf(freq_cpp, self.width_px)
        return found

    def sizes(self) -> NDArray[np.intp]:
        """Number of radial parts of every angular order, (orders + 1,)."""
        return np.diff(_ends(), prepend=0)

    def blocks(self) -> NDArray[np.intp]:
        """Number of the amplitude of each state, in the order of `otf_modes`: see `_block`."""
        return _blocks()

    def otf_modes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """All states at frequencies across and along, (n, r)."""
        found = np.empty((u_cpp.size, self.blocks().size), complex)
        _turn(found, self._radial(np.hypot(u_cpp, v_cpp)), _ends(), u_cpp, v_cpp)
        return found


@compiled
def _fill_radial(
    found: Floats, freq: Floats, scales: Floats, counts: NDArray[np.intp], stds: Floats
) -> None:
    """Fourier transforms of the states' radial parts, order by order, put into `found` (n, r).

    For every process and order these are Laguerre's polynomials of the square of the frequency, of
    no node, one, two and so on, under one envelope.

    Parameters
    ----------
    found : (n, r) array
        A column behind those of order 0 is left out.
    freq : (n,) array
        In units of the inverse width.
    scales : (p,) array
        Of the processes.
    counts : (orders, p) int array
        How many states of an order a process has.
    stds : (r,) array
        Factors of all columns.
    """
    x, envelope = np.empty(scales.size), np.empty(scales.size)
    for i in range(freq.size):
        for p in range(scales.size):
            x[p] = 2 * math.pi * scales[p] * freq[i]
            envelope[p] = math.exp(-0.5 * x[p] ** 2)
        k = 0
        for order in range(len(counts)):
            for p in range(scales.size):
                polynomial, change, square = 1.0, 0.0, x[p] ** 2
                for nodes in range(counts[order, p]):
                    found[i, k] = stds[k] * envelope[p] * polynomial
                    change = (nodes * change - square * polynomial) / (nodes + order + 1)
                    polynomial += change
                    k += 1
                envelope[p] *= x[p]
            k += order == 0


@compiled
def _turn(found: Complexes, radial: Floats, ends: NDArray[np.intp], u: Floats, v: Floats) -> None:
    """Radial parts (n, r) times cos and sin of every order, put into `found` (n, states).

    Those of an angular order end at a column of `ends`. The states of even orders are real, the
    others imaginary.
    """
    for i in range(u.size):
        freq, row, own = math.hypot(u[i], v[i]), radial[i], found[i]
        one = complex(u[i] / freq, v[i] / freq) if freq > 0 else complex(1.0, 0.0)
        wave, first, to = complex(1.0, 0.0), 0, 0
        for order in range(ends.size):
            unit, size = complex(0.0, 1.0) if order % 2 else complex(1.0, 0.0), ends[order] - first
            for k in range(size):
                own[to + k] = unit * (wave.real * row[first + k])
            to += size
            if order:
                for k in range(size):
                    own[to + k] = unit * (wave.imag * row[first + k])
                to += size
            wave, first = wave * one, ends[order]


def _states(process: Process) -> tuple[float, float, float]:
    """Scale of the states in widths, ratio of the eigenvalues, and the first of them.

    Scaled so that the process, integrated over one axis, has unit variance at the origin.
    """
    ratio, scale = mehler(process.extent, process.smoothness)
    long2, short2 = process.extent**2, process.smoothness**2
    first = math.pi * long2 * (1 - ratio) ** 2
    projected = 2 * math.pi * long2 / math.sqrt(1 + 2 * long2 / short2)
    return scale, ratio, first / projected


@cache
def _counts() -> NDArray[np.intp]:
    """How many states every process has of every angular order, (orders, processes)."""
    orders = np.arange(max(process.orders for process in PROCESSES) + 1)[:, None]
    last = np.array([process.orders for process in PROCESSES])
    return np.asarray(np.maximum((last - orders) // 2 + 1, 0), np.intp)


@cache
def _ends() -> NDArray[np.intp]:
    """Where the radial parts of every angular order end: those of order 0 with the tail's."""
    return np.cumsum(_counts().sum(axis=1)) + 1


@cache
def _stds() -> Floats:
    """Standard deviations of all radial parts, times the factors of their transforms, (r,).

    These belong to Laguerre polynomials that are 1 at zero. The tail has its own.
    """
    found = []
    for order, counts in enumerate(_counts().tolist()):
        angular = 1 / math.sqrt(2 * math.pi if order == 0 else math.pi)
        for process, count in zip(PROCESSES, counts, strict=True):
            scale, ratio, first = _states(process)
            for nodes in range(count):
                norm = math.sqrt(2 * math.comb(nodes + order, order) / math.factorial(order))
                std = math.sqrt(first * ratio ** (order + 2 * nodes))
                found.append(norm * angular * 2 * math.pi * scale * std)
        found += [1.0] if order == 0 else []
    return np.array(found)


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
