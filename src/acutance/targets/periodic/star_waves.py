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
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final, Literal

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.bessel_table import bessel_table
from acutance.numerics.lookup import CubicLookup
from acutance.numerics.otf_modes import (
    HIGHEST_CPP,
    MEAN_MODES,
    Complexes,
    MeanOtf,
    ProcessModes,
)

__all__ = ["BlurredStar", "StarTable", "Wave", "blurred_star", "star_table"]

Wave = Literal["sine", "square"]

_HARMONICS_CPP: Final = 1.3
"""Harmonics whose frequency is beyond this at the rim are left out."""
_STEP_PX: Final = 0.05
_BESSEL_STEP: Final = 0.02
_BESSEL_REACH: Final = 64.0
_DIRECTIONS: Final = 64
_COARSE_PX: Final = 0.1
_COARSE_CPP: Final = 1.5
_TOGETHER: Final = 8
"""Harmonics whose Bessel functions are tabled at once: a star of few spokes has dozens."""
_BLUR_ORDERS: Final = 12
"""Of a Gaussian through a pixel alone: beyond, its transfer is below .005."""


@dataclass(frozen=True, eq=False)
class _Harmonic:
    """Radial tables of one harmonic: (n_r, functions) for every angular order."""

    number: int
    share: float
    mean: dict[int, Complexes]
    states: dict[int, Floats]


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
    def _harmonics(self) -> list[_Harmonic]:
        states = ProcessModes(self.mean.width_px)
        mean = _angular_parts(self.mean.modes, self._freq)
        radial = [states.radial(m, self._freq) for m in range(states.orders + 1)]
        found = []
        for number, share, weights in _weights_of_harmonics(
            self.wave, self.cycles, self.rim_px, states.orders, self._radii, self._freq
        ):
            tables: tuple[dict[int, Complexes], dict[int, Floats]] = ({}, {})
            for m, weight in weights:
                tables[0][m] = weight @ mean[:, :, m % _DIRECTIONS]
                tables[1][m] = weight @ radial[abs(m)]
            found.append(_Harmonic(number, share, *tables))
        return found

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
        take = CubicLookup.of(radius_px, self._radii)
        orders = ProcessModes(self.mean.width_px).orders
        mean = np.zeros((radius_px.size, MEAN_MODES))
        by_phase = np.zeros(radius_px.size)
        even = [np.zeros(0)] * (orders + 1)
        odd = [np.zeros(0)] * (orders + 1)
        for one in self._harmonics:
            for m in range(orders + 1):
                ahead = _wave(one.number, one.share, phase, m * turn, m)
                behind = _wave(one.number, one.share, phase, -m * turn, -m)
                for order, wave in ((m, ahead), (-m, behind))[: 2 if m else 1]:
                    seen = take(one.mean[order]) * wave[:, None]
                    mean += seen.real
                    by_phase -= one.number * seen[:, 0].imag
                plus, minus = take(one.states[m]), take(one.states[-m])
                first, second = _pair(m, plus, ahead, minus, behind)
                even[m] = first if even[m].size == 0 else even[m] + first
                odd[m] = second if odd[m].size == 0 else odd[m] + second
        states = [even[0]]
        for m in range(1, orders + 1):
            states += [even[m], odd[m]]
        return np.hstack([mean, *states]), by_phase


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
        take = CubicLookup.of(radius_px, self._radii)
        image = np.zeros(radius_px.size)
        for number, share, tables in self._harmonics:
            for order, table in tables.items():
                wave = _wave(number, share, phase, order * turn, order)
                image += (take(table)[:, 0] * wave).real
        return image

    @cached_property
    def _radii(self) -> Floats:
        return np.asarray(_COARSE_PX * np.arange(1, math.ceil(self.outer_px / _COARSE_PX) + 4))

    @cached_property
    def _harmonics(self) -> list[tuple[int, float, dict[int, Complexes]]]:
        step = 1 / (2 * max(self.rim_px, self.outer_px) + 24)
        freq = np.asarray(step * np.arange(1, math.ceil(_COARSE_CPP / step)))
        otf = _angular_parts(lambda u, v: self.blur.otf(u, v)[:, None].astype(complex), freq)
        found = []
        for number, share, weights in _weights_of_harmonics(
            self.wave, self.cycles, self.rim_px, _BLUR_ORDERS, self._radii, freq
        ):
            # It looks the same from opposite directions.
            even = {m: w @ otf[:, :, m % _DIRECTIONS] for m, w in weights if m % 2 == 0}
            found.append((number, share, even))
        return found


def _harmonics_of(wave: Wave, cycles: int, rim_px: float) -> list[tuple[int, float]]:
    """Number and share of the harmonics of a star that a pixel resolves at its rim."""
    highest = 1
    if wave == "square":
        highest = max(int(_HARMONICS_CPP * 2 * math.pi * rim_px / cycles), 1)
    return [(n, (-1.0) ** index / n) for index, n in enumerate(range(1, highest + 1, 2))]


def _weights_of_harmonics(
    wave: Wave, cycles: int, rim_px: float, orders: int, radii: Floats, freq: Floats
) -> Iterator[tuple[int, float, Iterator[tuple[int, Floats]]]]:
    """Number, share and weights of every harmonic, whose angular orders are consumed in turn."""
    harmonics = _harmonics_of(wave, cycles, rim_px)
    reach = _reach(max(float(radii[-1]), rim_px))
    for first in range(0, len(harmonics), _TOGETHER):
        some = harmonics[first : first + _TOGETHER]
        wanted = {n * cycles + extra for n, _ in some for extra in (0, orders, orders + 1)}
        bessel = _bessel(tuple(sorted(wanted)), reach)
        for number, share in some:
            yield number, share, _weights(radii, freq, number * cycles, rim_px, orders, bessel)


def _weights(
    radii: Floats, freq: Floats, cycles: int, rim_px: float, orders: int,
    bessel: Mapping[int, Floats],
) -> Iterator[tuple[int, Floats]]:  # fmt: skip
    """The integral's weights (n_r, n_f) for every angular order, highest first."""
    x = 2 * math.pi * np.outer(radii, freq)
    step = freq[1] - freq[0]
    weight = cycles * step / freq * _rim(cycles, rim_px, freq, bessel[cycles])
    place = x / _BESSEL_STEP
    cell = place.astype(np.intp)
    part = place - cell
    above, here = (
        table[cell] * (1 - part) + table[cell + 1] * part
        for table in (bessel[cycles + orders + extra] for extra in (1, 0))
    )
    for m in range(orders, -orders - 1, -1):
        yield m, here * weight
        # The recurrence is stable downwards.
        above, here = here, 2 * (cycles + m) / x * here - above


def _wave(number: int, share: float, phase: Floats, turn: Floats, order: int) -> Complexes:
    """``share i^m exp(i (n (k phi + alpha) + m phi))``."""
    unit = (1, 1j, -1, -1j)[order % 4]
    return np.asarray(share * unit * np.exp(1j * (number * phase + turn)))


def _pair(
    m: int, plus: Floats, ahead: Complexes, minus: Floats, behind: Complexes
) -> tuple[Floats, Floats]:
    """Columns of the states with cos and with sin of m times the direction; odd ones times i."""
    if m == 0:
        return plus * ahead.real[:, None], np.zeros(0)
    one, other = plus * ahead[:, None], minus * behind[:, None]
    factor = 0.5j if m % 2 else 0.5
    return (factor * (one + other)).real, (-1j * factor * (one - other)).real


def _angular_parts(modes_of: Callable[[Floats, Floats], Complexes], freq: Floats) -> Complexes:
    """Angular Fourier coefficients of m modes, (n_f, m, directions)."""
    angle = 2 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    u, v = np.outer(freq, np.cos(angle)), np.outer(freq, np.sin(angle))
    modes = modes_of(u.ravel(), v.ravel()).reshape(freq.size, _DIRECTIONS, -1)
    return np.asarray(np.fft.fft(modes, axis=1).transpose(0, 2, 1) / _DIRECTIONS)


def _rim(cycles: int, rim_px: float, freq: Floats, bessel: Floats) -> Floats:
    """Q: the effect of the star's end on its spectrum."""
    x = _BESSEL_STEP * np.arange(bessel.size)
    integrand = x * bessel
    total = np.concatenate([[0.0], np.cumsum(0.5 * (integrand[1:] + integrand[:-1]))])
    return np.interp(2 * math.pi * rim_px * freq, x, total * _BESSEL_STEP / cycles)


def _reach(radius_px: float) -> float:
    """Largest argument of a Bessel function, in coarse steps, so that many stars share a table."""
    return math.ceil(2 * math.pi * radius_px * HIGHEST_CPP / _BESSEL_REACH) * _BESSEL_REACH


@lru_cache(maxsize=4)
def _bessel(orders: tuple[int, ...], reach: float) -> dict[int, Floats]:
    """J of some orders at 0, 0.02 ... beyond `reach`."""
    x = np.asarray(_BESSEL_STEP * np.arange(math.ceil(reach / _BESSEL_STEP) + 3))
    return dict(zip(orders, bessel_table(orders, x), strict=True))


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
