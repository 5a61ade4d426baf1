"""The effect of the ends of the bars: light that is scattered along the bars."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.bar_group import Bars
from acutance.numerics.otf_modes import Complexes, MeanOtf, ProcessModes
from acutance.targets.periodic.bars_pixels import GroupPixels
from acutance.targets.periodic.otf_model import FittedOtf, all_modes, mode_count

__all__ = ["TableModes", "scattered_light"]

_ACROSS_CPP: Final = 1.0
_ALONG_CPP: Final = 1.2
_GRID_PX: Final = 0.5
_PADDING_PX: Final = 32
_COARSE_CPP: Final = 0.25
_TABLE_CPP: Final = 0.02
_TABLE_SIZE: Final = 88


@dataclass(frozen=True, eq=False)
class _OtfTable:
    """An OTF on a square grid of frequencies, looked up between its points.

    Attributes
    ----------
    table : (2 n + 1, 2 n + 1) array
        Optical transfer function (OTF) at rows v, columns u, in steps of 0.02 c/px about zero.
    """

    table: Complexes

    def __call__(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF at frequencies across and along, same shape."""
        places = [v_cpp / _TABLE_CPP + _TABLE_SIZE, u_cpp / _TABLE_CPP + _TABLE_SIZE]
        parts = [
            map_coordinates(part, places, order=3) for part in (self.table.real, self.table.imag)
        ]
        return np.asarray(parts[0] + 1j * parts[1])


@dataclass(frozen=True, eq=False)
class TableModes:
    """All modes about a mean, at the frequencies of a table.

    A fit changes their coefficients from pass to pass; to work them out takes longer than the rest
    of a pass.

    Attributes
    ----------
    modes : ((n + 1) (2 n + 1), m) array
        At the frequencies v from zero upwards, all u of each: the rest is their conjugate.
    """

    modes: Complexes

    @classmethod
    def of(cls, mean: MeanOtf, states: ProcessModes) -> TableModes:
        """The modes of a mean and its states."""
        n = _TABLE_SIZE
        freq: Floats = np.asarray(_TABLE_CPP * np.arange(-n, n + 1))
        u, v = np.tile(freq, n + 1), np.repeat(freq[n:], freq.size)
        return cls(all_modes(mean, mode_count(states), u, v))

    def table(self, otf: FittedOtf) -> _OtfTable:
        """A fitted sum of them, tabulated."""
        lower = otf.of_modes(self.modes).reshape(_TABLE_SIZE + 1, -1)
        return _OtfTable(np.vstack([np.conj(lower[:0:-1, ::-1]), lower]))


def scattered_light(
    modes: TableModes, otf: FittedOtf, pixels: Sequence[GroupPixels]
) -> list[Floats]:
    """Effect of the bars' ends and light of other groups at every group's pixels, contrast 1."""
    table = modes.table(otf)
    others = _light_of_neighbours(
        table, [one.bars for one in pixels], [(one.rows, one.cols) for one in pixels]
    )
    return [
        _end_effect(table, one.bars, one.across, one.along) + other
        for one, other in zip(pixels, others, strict=True)
    ]


def _end_effect(otf: _OtfTable, bars: Bars, across_px: Floats, along_px: Floats) -> Floats:
    """Image of bars of their length minus that of endless ones, for unit contrast, (n,).

    ``sum over g of L sinc(L g) exp(2 pi i g t) [H(f, g) - H(f, 0)]``, through the profile's
    spectrum at every f: small and smooth well inside the bars, and zero for a system that does
    not scatter that far. Frequencies along the bars fade out from 0.6 to 1.2 c/px.
    """
    reach_s, reach_t = float(np.max(np.abs(across_px))) + 2, float(np.max(np.abs(along_px))) + 2
    step_f = 1 / (2 * reach_s + bars.width_px + 30)
    step_g = 1 / (2 * reach_t + bars.length_px + 30)
    f: Floats = np.asarray(step_f * (np.arange(math.ceil(_ACROSS_CPP / step_f)) + 0.5))
    half = step_g * np.arange(1, math.ceil(_ALONG_CPP / step_g))
    g = np.concatenate([-half[::-1], half])
    x, y = unit_vector(bars.normal_deg)
    across, along = f[:, None], np.append(g, 0.0)[None, :]
    transfer = otf(across * x - along * y, across * y + along * x)
    fade = np.clip((np.abs(g) / _ALONG_CPP - 0.5) / 0.5, 0.0, 1.0)
    window = np.cos(0.5 * math.pi * fade) ** 2 * bars.length_px * np.sinc(bars.length_px * g)
    change = (transfer[:, :-1] - transfer[:, -1:]) * (window * step_g)
    change *= (2 * step_f * bars.spectrum(f))[:, None]
    s = _GRID_PX * np.arange(-math.ceil(reach_s / _GRID_PX), math.ceil(reach_s / _GRID_PX) + 1)
    t = _GRID_PX * np.arange(-math.ceil(reach_t / _GRID_PX), math.ceil(reach_t / _GRID_PX) + 1)
    image = np.exp(2j * math.pi * np.outer(s, f)) @ change @ np.exp(2j * math.pi * np.outer(g, t))
    places = np.stack([(across_px - s[0]) / _GRID_PX, (along_px - t[0]) / _GRID_PX])
    return np.asarray(map_coordinates(image.real, places, order=3, mode="nearest"))


def _light_of_neighbours(
    otf: _OtfTable,
    groups: Sequence[Bars],
    places: Sequence[tuple[NDArray[np.intp], NDArray[np.intp]]],
) -> list[Floats]:
    """Light of all other groups at the pixels of every group, for unit contrast.

    Groups are some pixels apart, so that coarse structure is all that matters: frequencies fade
    out from 0.25 to 0.5 c/px, and one Fourier transform a group is exact.

    Parameters
    ----------
    otf : OtfTable
    groups : sequence of Bars
    places : sequence of (rows, cols)
        The pixels of every group.
    """
    first = [min(int(one[axis].min()) for one in places) for axis in (0, 1)]
    last = [max(int(one[axis].max()) for one in places) for axis in (0, 1)]
    shape = [last[axis] - first[axis] + 1 + _PADDING_PX for axis in (0, 1)]
    v, u = (
        grid.ravel()
        for grid in np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.rfftfreq(shape[1]), indexing="ij")
    )
    fade = np.clip(np.hypot(u, v) / _COARSE_CPP - 1.0, 0.0, 1.0)
    transfer = otf(u, v) * np.cos(0.5 * math.pi * fade) ** 2
    total, own = np.zeros(shape), []
    for bars, (rows, cols) in zip(groups, places, strict=True):
        x, y = unit_vector(bars.normal_deg)
        f, g = u * x + v * y, v * x - u * y
        outline = bars.spectrum(f) * bars.length_px * np.sinc(bars.length_px * g)
        place = np.exp(-2j * math.pi * (u * (bars.col - first[1]) + v * (bars.row - first[0])))
        spectrum = (transfer * outline * place).reshape(shape[0], -1)
        image = np.fft.irfft2(spectrum, shape)
        total += image
        own.append(image[rows - first[0], cols - first[1]])
    return [
        np.asarray(total[rows - first[0], cols - first[1]] - alone)
        for alone, (rows, cols) in zip(own, places, strict=True)
    ]
