"""How a star looks through any transfer function, without approximation.

A scene ``cos(k phi + alpha)`` for r < R has a spectrum of one angular order. Let the transfer be
``sum_m h_m(f) exp(i m theta)``; then the image is the real part of

    sum_m i^m exp(i ((k + m) phi + alpha)) integral_0^inf h_m(f) Q(f) k / f J_(k+m)(2 pi f r) df

with ``Q(f) = 1/k integral_0^(2 pi f R) x J_k(x) dx``, which is 1 for a star without end. The
integrand rises at the local frequency k / (2 pi r) of the spokes: all that "the MTF at the local
frequency" leaves out, which counts near the centre, is in the rest of the integral. A square wave
is the sum of its odd harmonics, each a star of n k cycles.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.lookup import CubicLookup
from acutance.numerics.otf_modes import (
    HIGHEST_CPP,
    MEAN_MODES,
    Complexes,
    MeanOtf,
    ProcessModes,
)
from acutance.targets.periodic.star_tables import Harmonic, Wave, add_harmonic, tables_of

__all__ = ["BlurredStar", "StarTable", "Wave", "blurred_star", "star_table"]

_STEP_PX: Final = 0.05
_DIRECTIONS: Final = 64
_COARSE_PX: Final = 0.1
_COARSE_CPP: Final = 1.5
_EVEN_AND_ODD: Final = (np.array([0, 1, 2, 3, 6, 7]), np.array([4, 5]))
"""Modes of the mean that are even functions of frequency, and odd ones: places."""
_ALONE: Final = (np.array([0]), np.array([], np.intp))
"""The mean alone, which is even."""
_BLUR_ORDERS: Final = 12
"""Of a Gaussian through a pixel alone: beyond, its transfer is below .005."""


@dataclass(frozen=True)
class StarTable:
    """The image of a star for every mode of a transfer function, by radius.

    Parameters
    ----------
    mean : MeanOtf
        Mean of the transfer.
    cycles : int
    wave : {"sine", "square"}
    inner_px, outer_px : float
        Radii between which pixels are looked up.
    rim_px : float
        Radius of the star.
    """

    mean: MeanOtf
    cycles: int
    wave: Wave
    inner_px: float
    outer_px: float
    rim_px: float

    @cached_property
    def _radii(self) -> Floats:
        first = max(self.inner_px - 3 * _STEP_PX, _STEP_PX)
        count = math.ceil((self.outer_px - first) / _STEP_PX) + 4
        return np.asarray(first + _STEP_PX * np.arange(count))

    @cached_property
    def _freq(self) -> Floats:
        step = 1 / (2 * self.rim_px + 24)
        return np.asarray(step * np.arange(1, math.ceil(HIGHEST_CPP / step)))

    @cached_property
    def _harmonics(self) -> list[Harmonic]:
        states = ProcessModes(self.mean.width_px)
        mean = _angular_parts(self.mean.modes, self._freq)
        radial = states.radial(self._freq)
        parts = [
            _apart(mean[:, _EVEN_AND_ODD[m % 2], m % _DIRECTIONS], radial[abs(m)])
            for m in range(states.orders, -states.orders - 1, -1)
        ]
        return tables_of(self.wave, self.cycles, self.rim_px, self._radii, self._freq, parts)

    def columns(self, radius_px: Floats, phase: Floats, turn: Floats) -> tuple[Floats, Floats]:
        """The image of every mode at some pixels.

        Parameters
        ----------
        radius_px : (n,) array
            Distance from the centre.
        phase : (n,) array
            Phase of the spokes, ``k phi + alpha``.
        turn : (n,) array
            Direction phi of the pixels.

        Returns
        -------
        columns : (n, MEAN_MODES + states) array
        by_phase : (n,) array
            Derivative of the first column (the mean itself) by the phase.
        """
        sizes = ProcessModes(self.mean.width_px).sizes()
        states = int(sizes[0] + 2 * sizes[1:].sum())
        found, by_phase = np.zeros((radius_px.size, MEAN_MODES + states)), np.zeros(radius_px.size)
        at = CubicLookup.of(radius_px, self._radii)
        for one in self._harmonics:
            add_harmonic(found, by_phase, one, at, phase, turn, _EVEN_AND_ODD, sizes)
        return found, by_phase


@dataclass(frozen=True)
class BlurredStar:
    """The image of a star through a Gaussian and a pixel, also at its centre and around it.

    Parameters
    ----------
    blur : MeanOtf
    cycles : int
    wave : {"sine", "square"}
    outer_px : float
        Radius up to which pixels are looked up.
    rim_px : float
        Radius of the star.
    """

    blur: MeanOtf
    cycles: int
    wave: Wave
    outer_px: float
    rim_px: float

    def __call__(self, radius_px: Floats, phase: Floats, turn: Floats) -> Floats:
        """The image at pixels (n,), of unit amplitude; arguments as of `StarTable.columns`."""
        image, by_phase = np.zeros((radius_px.size, 1)), np.zeros(radius_px.size)
        at, sizes = CubicLookup.of(radius_px, self._radii), np.zeros(_BLUR_ORDERS + 1, np.intp)
        for one in self._harmonics:
            add_harmonic(image, by_phase, one, at, phase, turn, _ALONE, sizes)
        return image[:, 0]

    @cached_property
    def _radii(self) -> Floats:
        return np.asarray(_COARSE_PX * np.arange(1, math.ceil(self.outer_px / _COARSE_PX) + 4))

    @cached_property
    def _harmonics(self) -> list[Harmonic]:
        step = 1 / (2 * max(self.rim_px, self.outer_px) + 24)
        freq = np.asarray(step * np.arange(1, math.ceil(_COARSE_CPP / step)))
        otf = _angular_parts(lambda u, v: self.blur.otf(u, v)[:, None].astype(complex), freq)
        none = np.empty((freq.size, 0))
        parts = [
            _apart(otf[:, _ALONE[m % 2], m % _DIRECTIONS], none)
            for m in range(_BLUR_ORDERS, -_BLUR_ORDERS - 1, -1)
        ]
        return tables_of(self.wave, self.cycles, self.rim_px, self._radii, freq, parts)


def _apart(modes: Complexes, states: Floats) -> Floats:
    """Real and imaginary parts of modes, and states, side by side, (n_f, functions)."""
    return np.hstack([modes.real, modes.imag, states])


def _angular_parts(modes_of: Callable[[Floats, Floats], Complexes], freq: Floats) -> Complexes:
    """Angular Fourier coefficients of m modes, (n_f, m, directions)."""
    angle = 2 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    u, v = np.outer(freq, np.cos(angle)), np.outer(freq, np.sin(angle))
    modes = modes_of(u.ravel(), v.ravel()).reshape(freq.size, _DIRECTIONS, -1)
    return np.asarray(np.fft.fft(modes, axis=1).transpose(0, 2, 1) / _DIRECTIONS)


@lru_cache(maxsize=8)
def star_table(
    mean: MeanOtf, cycles: int, wave: Wave, inner_px: float, outer_px: float, rim_px: float
) -> StarTable:
    """The table of a star; that of the same star is kept."""
    return StarTable(mean, cycles, wave, inner_px, outer_px, rim_px)


@lru_cache(maxsize=8)
def blurred_star(
    blur: MeanOtf, cycles: int, wave: Wave, outer_px: float, rim_px: float
) -> BlurredStar:
    """The blurred image of a star; that of the same star is kept."""
    return BlurredStar(blur, cycles, wave, outer_px, rim_px)
