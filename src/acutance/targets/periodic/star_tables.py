"""Radial tables of the harmonics of a star, and their sum at pixels; formulas in `star_waves`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.bessel_table import bessel_table
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.lookup import CubicLookup

__all__ = ["Harmonic", "Wave", "add_harmonic", "tables_of"]

Wave = Literal["sine", "square"]

_HARMONICS_CPP: Final = 1.3
"""Harmonics whose frequency is beyond this at the rim are left out."""
_BESSEL_STEP: Final = 0.02
_BESSEL_REACH: Final = 64.0
_TOGETHER: Final = 8
"""Harmonics whose Bessel functions are tabled at once: a star of few spokes has dozens."""
_RADII: Final = 64
"""Radii of a table that are worked out at once: their Bessel functions stay in a cache."""


@dataclass(frozen=True, eq=False)
class Harmonic:
    """A radial table (n_r, functions) of one harmonic for every angular order, highest first.

    For each it has the real and the imaginary parts of those modes of the mean that have such an
    order, then the states.
    """

    number: int
    share: float
    table: Floats


def _harmonics_of(wave: Wave, cycles: int, rim_px: float) -> list[tuple[int, float]]:
    """Number and share of the harmonics of a star that a pixel resolves at its rim."""
    highest = 1
    if wave == "square":
        highest = max(int(_HARMONICS_CPP * 2 * math.pi * rim_px / cycles), 1)
    return [(n, (-1.0) ** index / n) for index, n in enumerate(range(1, highest + 1, 2))]


def tables_of(
    wave: Wave, cycles: int, rim_px: float, radii: Floats, freq: Floats, parts: Sequence[Floats]
) -> list[Harmonic]:
    """All harmonics, of the functions' parts (n_f, functions) of every order, highest first."""
    harmonics, orders, found = _harmonics_of(wave, cycles, rim_px), len(parts) // 2, []
    reach = _reach(max(float(radii[-1]), rim_px) * float(freq[-1]))
    for first in range(0, len(harmonics), _TOGETHER):
        some = harmonics[first : first + _TOGETHER]
        wanted = {n * cycles + extra for n, _ in some for extra in (0, orders, orders + 1)}
        bessel = _bessel(tuple(sorted(wanted)), reach)
        for number, share in some:
            table = _table(radii, freq, number * cycles, rim_px, parts, bessel)
            found.append(Harmonic(number, share, table))
    return found


def _table(
    radii: Floats, freq: Floats, cycles: int, rim_px: float, parts: Sequence[Floats],
    bessel: Mapping[int, Floats],
) -> Floats:  # fmt: skip
    """The integrals of all functions at radii (n_r,), some of which are taken at a time."""
    orders, rows = len(parts) // 2, []
    weight = cycles * (freq[1] - freq[0]) / freq * _rim(cycles, rim_px, freq, bessel[cycles])
    # Below their turning points by some of its widths J of all orders has fallen to nothing.
    nothing = cycles - orders - 12 * cycles ** (1 / 3)
    for start in range(0, radii.size, _RADII):
        some = radii[start : start + _RADII]
        first = int(np.searchsorted(freq, nothing / (2 * math.pi * some[-1])))
        weights = _weights(
            some, freq[first:], weight[first:], cycles + orders, 2 * orders + 1,
            bessel[cycles + orders], bessel[cycles + orders + 1],
        )  # fmt: skip
        rows.append(
            np.hstack([own @ part[first:] for own, part in zip(weights, parts, strict=True)])
        )
    return np.vstack(rows)


@compiled
def _weights(
    radii: Floats,
    freq: Floats,
    weight: Floats,
    highest: int,
    count: int,
    bessel: Floats,
    bessel_above: Floats,
) -> Floats:
    """J times a weight (n_f,) at all radii and frequencies for so many orders, (count, n_r, n_f).

    The highest order is first; tables of its Bessel function and of that above are given.
    """
    found = np.empty((count, radii.size, freq.size))
    above, here, twice = np.empty(freq.size), np.empty(freq.size), np.empty(freq.size)
    for i in range(radii.size):
        for k in range(freq.size):
            x = 2 * math.pi * radii[i] * freq[k]
            cell = int(x / _BESSEL_STEP)
            part = x / _BESSEL_STEP - cell
            here[k] = weight[k] * (bessel[cell] * (1 - part) + bessel[cell + 1] * part)
            above[k] = weight[k] * (bessel_above[cell] * (1 - part) + bessel_above[cell + 1] * part)
            twice[k] = 2 / x
        for m in range(count):
            # The recurrence is stable downwards.
            for k in range(freq.size):
                found[m, i, k] = here[k]
                below = (highest - m) * twice[k] * here[k] - above[k]
                above[k], here[k] = here[k], below
    return found


def add_harmonic(
    found: Floats,
    by_phase: Floats,
    harmonic: Harmonic,
    at: CubicLookup,
    phase: Floats,
    turn: Floats,
    modes: tuple[NDArray[np.intp], NDArray[np.intp]],
    sizes: NDArray[np.intp],
) -> None:
    """Add a harmonic to the columns (n, m), and to the derivative of the first by the phase (n,).

    The functions of an angular order m have the wave ``i^m exp(i (n (k phi + alpha) + m phi))``.

    Parameters
    ----------
    found, by_phase : (n, m), (n,) arrays
        The columns of modes, then those of states, by order: with cos of m phi, then with sin.
    harmonic : Harmonic
    at : CubicLookup
        Of the pixels in the table.
    phase, turn : (n,) arrays
        Phase of the spokes and direction of the pixels.
    modes : pair of (k,) int arrays
        Columns of modes with even and with odd orders.
    sizes : (orders + 1,) int array
        How many states every order has.
    """
    _sum_up(
        found, by_phase, harmonic.table, at.first, at.weights, phase, turn,
        harmonic.number, harmonic.share, *modes, sizes,
    )  # fmt: skip


@compiled
def _sum_up(
    found: Floats,
    by_phase: Floats,
    table: Floats,
    first: NDArray[np.intp],
    weights: Floats,
    phase: Floats,
    turn: Floats,
    number: int,
    share: float,
    even: NDArray[np.intp],
    odd: NDArray[np.intp],
    sizes: NDArray[np.intp],
) -> None:
    """`add_harmonic` for arrays; `even` and `odd` are its modes."""
    highest, own = sizes.size - 1, np.empty(table.shape[1])
    for i in range(first.size):
        p, q, r, s = (table[first[i]], table[first[i] + 1], table[first[i] + 2],
                      table[first[i] + 3])  # fmt: skip
        a, b, c, d = weights[0, i], weights[1, i], weights[2, i], weights[3, i]
        for k in range(own.size):
            own[k] = a * p[k] + b * q[k] + c * r[k] + d * s[k]
        step = complex(-math.sin(turn[i]), math.cos(turn[i]))
        wave = share * complex(math.cos(number * phase[i]), math.sin(number * phase[i]))
        for _ in range(highest):
            wave *= step
        k, to = 0, found.shape[1]
        for m in range(highest, -highest - 1, -1):
            modes, size = odd if m % 2 else even, sizes[abs(m)]
            for j in range(modes.size):
                real, imaginary = own[k + j], own[k + modes.size + j]
                found[i, modes[j]] += real * wave.real - imaginary * wave.imag
                if modes[j] == 0:
                    by_phase[i] -= number * (real * wave.imag + imaginary * wave.real)
            k += 2 * modes.size
            # Columns of states with cos and with sin of |m| phi; those of odd orders are imaginary.
            by_cos, by_sin = (-wave.imag, wave.real) if m % 2 else (wave.real, wave.imag)
            if m >= 0:
                to -= 2 * size if m else size
            _add_states(found[i, to:], own[k:], size, 0.5 * by_cos if m else by_cos)
            if m != 0:
                _add_states(
                    found[i, to + size :], own[k:], size, 0.5 * by_sin if m > 0 else -0.5 * by_sin
                )
            if m <= 0:
                to += 2 * size if m else size
            k += size
            wave *= step.conjugate()


@inlined
def _add_states(found: Floats, states: Floats, size: int, factor: float) -> None:
    """Add so many states times a factor to columns."""
    for j in range(size):
        found[j] += factor * states[j]


def _rim(cycles: int, rim_px: float, freq: Floats, bessel: Floats) -> Floats:
    """Q: the effect of the star's end on its spectrum."""
    x = _BESSEL_STEP * np.arange(bessel.size)
    integrand = x * bessel
    total = np.concatenate([[0.0], np.cumsum(0.5 * (integrand[1:] + integrand[:-1]))])
    return np.interp(2 * math.pi * rim_px * freq, x, total * _BESSEL_STEP / cycles)


def _reach(cycles: float) -> float:
    """Largest argument of a Bessel function, in coarse steps, so that many stars share a table.

    `cycles` are those of the highest frequency between the centre and the furthest radius.
    """
    return math.ceil(2 * math.pi * cycles / _BESSEL_REACH) * _BESSEL_REACH


@lru_cache(maxsize=4)
def _bessel(orders: tuple[int, ...], reach: float) -> dict[int, Floats]:
    """J of some orders at 0, 0.02 ... beyond `reach`."""
    x = np.asarray(_BESSEL_STEP * np.arange(math.ceil(reach / _BESSEL_STEP) + 3))
    return dict(zip(orders, bessel_table(orders, x), strict=True))
