"""Light of other groups of bars at the pixels of a group."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import map_coordinates

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.numerics.otf_modes import Complexes, MeanOtf, ProcessModes
from acutance.targets.periodic.bars_pixels import GroupPixels
from acutance.targets.periodic.otf_model import FittedOtf, all_modes, mode_count

__all__ = ["CoarseModes", "light_of_neighbours"]

_PADDING_PX: Final = 32
_COARSE_CPP: Final = 0.25
"""From here to twice as much frequencies fade out: groups are some pixels apart."""
_TABLE_CPP: Final = 0.02
_TABLE_SIZE: Final = 27


@dataclass(frozen=True, eq=False)
class CoarseModes:
    """All modes about a mean, at the low frequencies of a table.

    A fit changes their coefficients from pass to pass; to work them out takes longer than the rest
    of a pass.

    Attributes
    ----------
    modes : ((n + 1) (2 n + 1), m) array
        At the frequencies v from zero upwards in steps of 0.02 c/px, all u of each: the rest is
        their conjugate.
    """

    modes: Complexes

    @classmethod
    def of(cls, mean: MeanOtf, states: ProcessModes) -> CoarseModes:
        """The modes of a mean and its states."""
        n = _TABLE_SIZE
        freq: Floats = np.asarray(_TABLE_CPP * np.arange(-n, n + 1))
        u, v = np.tile(freq, n + 1), np.repeat(freq[n:], freq.size)
        return cls(all_modes(mean, mode_count(states), u, v))

    def transfer(self, otf: FittedOtf, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """A fitted sum of them, (n,), that fades out towards fine structure."""
        lower = otf.of_modes(self.modes).reshape(_TABLE_SIZE + 1, -1)
        table = np.vstack([np.conj(lower[:0:-1, ::-1]), lower])
        places = [v_cpp / _TABLE_CPP + _TABLE_SIZE, u_cpp / _TABLE_CPP + _TABLE_SIZE]
        parts = [map_coordinates(part, places, order=3) for part in (table.real, table.imag)]
        fade = np.clip(np.hypot(u_cpp, v_cpp) / _COARSE_CPP - 1.0, 0.0, 1.0)
        return np.asarray((parts[0] + 1j * parts[1]) * np.cos(0.5 * math.pi * fade) ** 2)


def light_of_neighbours(
    modes: CoarseModes, otf: FittedOtf, pixels: Sequence[GroupPixels]
) -> list[Floats]:
    """Light of all other groups at the pixels of every group, for unit contrast.

    Coarse structure is all that matters, and one Fourier transform a group is exact.

    Parameters
    ----------
    modes : CoarseModes
    otf : FittedOtf
        A sum of them.
    pixels : sequence of GroupPixels
    """
    rows = np.concatenate([one.rows for one in pixels])
    cols = np.concatenate([one.cols for one in pixels])
    top, left = int(rows.min()), int(cols.min())
    shape = [int(rows.max()) - top + 1 + _PADDING_PX, int(cols.max()) - left + 1 + _PADDING_PX]
    v, u = (
        grid.ravel()
        for grid in np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.rfftfreq(shape[1]), indexing="ij")
    )
    transfer = modes.transfer(otf, u, v)
    total, own = np.zeros(shape), []
    for one in pixels:
        bars = one.bars
        x, y = unit_vector(bars.normal_deg)
        f, g = u * x + v * y, v * x - u * y
        outline = bars.spectrum(f) * bars.length_px * np.sinc(bars.length_px * g)
        place = np.exp(-2j * math.pi * (u * (bars.col - left) + v * (bars.row - top)))
        image = np.fft.irfft2((transfer * outline * place).reshape(shape[0], -1), shape)
        total += image
        own.append(image[one.rows - top, one.cols - left])
    return [
        np.asarray(total[one.rows - top, one.cols - left] - alone)
        for one, alone in zip(pixels, own, strict=True)
    ]
