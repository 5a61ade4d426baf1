"""The effect of the ends of the bars: light that is scattered along them, mode by mode.

The wider a mode scatters, the more of its light goes over the ends of the bars: to the image of
endless bars it adds little inside them, or takes most of it away. So the ends belong to the images
of the modes, not to those of the transfer function that was fitted before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.bar_group import Bars
from acutance.numerics.lookup import CubicLookup
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.targets.periodic.otf_model import mode_count, mode_parts

__all__ = ["EndEffect", "end_effects"]

_ACROSS_CPP: Final = 0.6
"""Light that comes from beyond the ends shows no finer bars."""
_ALONG_CPP: Final = 1.2
"""Ends are 5 px away from the pixels: from half of it frequencies fade out."""
_ACROSS_PX: Final = 0.5
_NEAR_PX: Final = 6.0
"""Up to here from an end places stand a pixel apart, beyond in proportion to the distance."""
_PADDING_PX: Final = 30.0
_ONE_DIRECTION_DEG: Final = 0.5
_BLOCK: Final = 1 << 14
"""So many frequencies at a time: all modes there take 70 MB."""

Complexes32 = NDArray[np.complex64]


@dataclass(frozen=True, eq=False)
class EndEffect:
    """The images of all modes of a group of bars minus those of endless ones, for unit contrast.

    Attributes
    ----------
    half_px : float
        Half the length of the bars.
    across : (s,) array
        Regular places along the normal, px.
    along : (t,) array
        Regular places along the bars, in units of `_stretched`.
    table : (s t, m) array
    """

    half_px: float
    across: Floats
    along: Floats
    table: Floats

    @classmethod
    def nothing(cls, bars: Bars, reach_px: float, modes: int) -> EndEffect:
        """An empty table for pixels up to `reach_px` to the sides of the bars."""
        half = 0.5 * bars.length_px
        count = math.ceil((0.5 * bars.width_px + reach_px) / _ACROSS_PX) + 1
        last = math.ceil(float(_stretched(np.array([half]), half)[0])) + 1
        across = np.asarray(_ACROSS_PX * np.arange(-count, count + 1))
        along = np.arange(-last, last + 1.0)
        return cls(half, across, along, np.zeros((across.size * along.size, modes)))

    def light(self, bars: Bars, freq: _Frequencies, block: _Block) -> Floats:
        """What some frequencies add to the table, (s t, m)."""
        g, t = freq.along_cpp, _unstretched(self.along, self.half_px)
        window = freq.fade * freq.along_step * bars.length_px * np.sinc(bars.length_px * g)
        ends = np.exp(2j * math.pi * np.outer(t, g)) * window
        lines, size = block.modes.shape[1:]
        image = ends.astype(np.complex64) @ block.modes.reshape(g.size, -1)
        image = image.reshape(t.size, lines, size)
        image -= ends.sum(axis=1).astype(np.complex64)[:, None, None] * block.without_ends
        wave = np.exp(2j * math.pi * np.outer(self.across, block.across_cpp))
        wave *= 2 * freq.across_step * bars.spectrum(block.across_cpp)
        image = image.transpose(1, 0, 2).reshape(lines, -1)
        real = wave.real.astype(np.float32) @ np.ascontiguousarray(image.real)
        real -= wave.imag.astype(np.float32) @ np.ascontiguousarray(image.imag)
        return np.asarray(real.reshape(self.table.shape), float)

    def columns(self, across_px: Floats, along_px: Floats) -> Floats:
        """The effect in the images of all modes at pixels (n,), (n, m)."""
        rows = CubicLookup.of(across_px, self.across)
        cols = CubicLookup.of(_stretched(along_px, self.half_px), self.along)
        four = np.arange(4)[:, None]
        places = (rows.first + four)[:, None] * self.along.size + (cols.first + four)[None]
        weights = rows.weights[:, None] * cols.weights[None]
        n = across_px.size
        starts = np.arange(0, 16 * n + 1, 16)
        lookup = csr_array(
            (weights.reshape(16, n).T.ravel(), places.reshape(16, n).T.ravel(), starts),
            shape=(n, self.table.shape[0]),
        )
        return np.asarray(lookup @ self.table)


@dataclass(frozen=True, eq=False)
class _Frequencies:
    """Those across the bars, and those along them with both signs and without zero."""

    across_step: float
    along_step: float
    along_cpp: Floats

    @classmethod
    def of(cls, groups: Sequence[Bars], reach_px: float) -> _Frequencies:
        """Fine enough for the widest and the longest of some groups."""
        width = max(one.width_px for one in groups)
        length = max(one.length_px for one in groups)
        step = 1 / (2 * length + _PADDING_PX)
        half = step * np.arange(1, math.ceil(_ALONG_CPP / step))
        return cls(
            1 / (2 * (width + reach_px) + _PADDING_PX), step, np.concatenate([-half[::-1], half])
        )

    @property
    def fade(self) -> Floats:
        """Weights of the frequencies along the bars."""
        past_half = np.clip((np.abs(self.along_cpp) / _ALONG_CPP - 0.5) / 0.5, 0.0, 1.0)
        return np.asarray(np.cos(0.5 * math.pi * past_half) ** 2)

    def blocks(self, mean: MeanOtf, states: ProcessModes, normal_deg: float) -> Iterator[_Block]:
        """All modes at all frequencies of bars with some normal, some frequencies at a time."""
        across = self.across_step * (np.arange(math.ceil(_ACROSS_CPP / self.across_step)) + 0.5)
        x, y = unit_vector(normal_deg)
        g = np.append(self.along_cpp, 0.0)[:, None]
        count = max(_BLOCK // g.size, 1)
        for first in range(0, across.size, count):
            f = np.asarray(across[first : first + count])
            u, v = f * x - g * y, f * y + g * x
            parts = mode_parts(mean, mode_count(states), u.ravel(), v.ravel())
            modes = np.hstack(parts, dtype=np.complex64, casting="same_kind")
            modes = modes.reshape(g.size, f.size, -1)
            yield _Block(f, modes[:-1], modes[-1])


@dataclass(frozen=True, eq=False)
class _Block:
    """All modes at frequencies along and across, (g, f, m), and without the former, (f, m)."""

    across_cpp: Floats
    modes: Complexes32
    without_ends: Complexes32


def end_effects(
    mean: MeanOtf, states: ProcessModes, groups: Sequence[Bars], reach_px: float
) -> list[EndEffect]:
    """The effect of the ends of every group on its pixels.

    For a mode ``H``

        ``sum over f, g of P(f) L sinc(L g) exp(2 pi i (f s + g t)) [H(f, g) - H(f, 0)]``

    with the spectrum P of the bars' profile and their length L: small and smooth well inside the
    bars, and zero for a mode that does not scatter that far.

    Parameters
    ----------
    mean : MeanOtf
    states : ProcessModes
    groups : sequence of Bars
    reach_px : float
        How far to the sides of the bars the pixels of a group go.
    """
    freq = _Frequencies.of(groups, reach_px)
    found = [EndEffect.nothing(one, reach_px, mode_count(states)) for one in groups]
    normals = np.array([one.normal_deg for one in groups])
    kind = np.round(normals / _ONE_DIRECTION_DEG)
    for own in np.unique(kind):
        members = np.flatnonzero(kind == own).tolist()
        for block in freq.blocks(mean, states, float(normals[members].mean())):
            for number in members:
                one = found[number]
                light = one.light(groups[number], freq, block)
                found[number] = replace(one, table=one.table + light)
    return found


def _stretched(along_px: Floats, half_px: float) -> Floats:
    """Places along the bars, from their middle, in steps that are wide far from both ends."""
    return np.asarray(
        np.sign(along_px) * (_depth(np.array(half_px)) - _depth(half_px - np.abs(along_px)))
    )


def _unstretched(places: Floats, half_px: float) -> Floats:
    """The distance from the middle of the bars, px, of such places."""
    depth = _depth(np.array(half_px)) - np.abs(places)
    far = _NEAR_PX * np.exp(np.maximum(depth, _NEAR_PX) / _NEAR_PX - 1)
    return np.asarray(np.sign(places) * (half_px - np.where(depth < _NEAR_PX, depth, far)))


def _depth(distance_px: Floats) -> Floats:
    """Distance from an end, a sixth of whose logarithm it is beyond 6 px."""
    far = _NEAR_PX * (1 + np.log(np.maximum(distance_px, _NEAR_PX) / _NEAR_PX))
    return np.asarray(np.where(distance_px < _NEAR_PX, distance_px, far))
