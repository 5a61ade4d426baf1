"""What a kernel may be besides its parametric form: Gaussian processes over the plane.

A process has the covariance ``exp(-(x^2 + x'^2) / 2 L^2) exp(-(x - x')^2 / 2 l^2)`` along either
axis, and the product of both over the plane: what it adds lives within L pixels of the kernel's
centre and varies over l pixels. Three of them, each with an amplitude that the data decide:

- CORE: sharpening, asymmetry, the shape of the detector, down to the reference's own resolution;
- FLANK: shoulders and rings, smear of some pixels;
- HALO: scattered light.

A fourth function, TAIL, falls like 1 / r^3 without end, as diffraction does. It belongs to the
kernel's volume, which normalises the OTF. Beyond the taps it acts on means of low pixels.

The parameters of the mean kernel stay free: each has a function of its own. So has the
interpolation of a product onto the grid of a map: its transfer falls from near 1 to near 0 between
0.35 and 0.65 cycles per pixel, which no smooth process does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.lorentz_tail import tail_otf, tail_psf
from acutance.numerics.process_modes import covariance_modes
from acutance.targets.pair import tuned
from acutance.targets.pair.axis_gaussian import AxisGaussian
from acutance.targets.pair.tile import (
    Complexes,
    PairTile,
    TapAxis,
    TapGrid,
    blurred,
    blurred_far,
    far_taps,
    filtered_across,
    filtered_down,
)

__all__ = ["KernelBasis"]

_PARAMETERS: Final = (
    np.array([0, 1, 0, 2, 0, 3, 0, 4, 0, 4]),
    np.array([0, 0, 1, 0, 2, 0, 3, 0, 4, 4]),
)
"""Which columns of `AxisGaussian.taps` along rows and columns make the parameters' functions."""
_NEGLIGIBLE = 1e-3


@dataclass(frozen=True, eq=False)
class KernelBasis(ShortRepr):
    """The parametric kernel and the directions in which the kernel may differ from it.

    Parameters
    ----------
    grid : TapGrid
    down, across : AxisGaussian
        The parametric kernel, volume 1.
    processes : int
        How many of the three processes: 2 leaves the halo out.
    """

    grid: TapGrid
    down: AxisGaussian
    across: AxisGaussian
    processes: int = 3

    @cached_property
    def _axes(self) -> tuple[Floats, Floats, list[tuple[int, NDArray[np.intp], NDArray[np.intp]]]]:
        """Kernels along rows, along columns, and which pairs of them every process takes.

        The first five of either are the parametric kernel and its slopes.
        """
        down = [self.down.taps(self.grid.down)]
        across = [self.across.taps(self.grid.across)]
        pairs = [(-1, *_PARAMETERS)]
        first = [down[0].shape[1], across[0].shape[1]]
        for block, (extent, smooth) in enumerate(tuned.SCALES_PX[: self.processes]):
            own_down, power_down = _process(self.grid.down, self.down.shift_px, extent, smooth)
            own_across, power_across = _process(
                self.grid.across, self.across.shift_px, extent, smooth
            )
            share = np.outer(power_down / power_down[-1], power_across / power_across[-1])
            a, b = np.nonzero(share > _NEGLIGIBLE)
            pairs.append((block, a + first[0], b + first[1]))
            down.append(own_down)
            across.append(own_across)
            first = [first[0] + own_down.shape[1], first[1] + own_across.shape[1]]
        return np.hstack(down), np.hstack(across), pairs

    @cached_property
    def scale(self) -> Floats:
        """Prior standard deviations, (k,), of the parameters' moves; 1 within the processes."""
        scale = np.ones(self.size)
        scale[: tuned.PARAMETER_STD.size] = tuned.PARAMETER_STD
        return scale

    @cached_property
    def blocks(self) -> NDArray[np.intp]:
        """Which process every function belongs to, (k,); -1 for the parametric kernel."""
        pairs = [np.full(a.size, block) for block, a, _ in self._axes[2]]
        return np.concatenate([*pairs, [self.processes]])

    @property
    def log_amplitude(self) -> Floats:
        """Prior mean of the logarithm of every block's amplitude."""
        return np.append(tuned.LOG_AMPLITUDE[: self.processes], tuned.LOG_AMPLITUDE[-1])

    @property
    def size(self) -> int:
        """Number of functions."""
        return int(self.blocks.size)

    @property
    def reach_px(self) -> float:
        """How far the taps reach, in low pixels."""
        return min(axis.half / axis.per_px for axis in (self.grid.down, self.grid.across))

    def columns(self, tile: PairTile) -> Floats:
        """The low pixels every function makes of the reference, (h, w, k)."""
        down, across, pairs = self._axes
        half = filtered_across(tile, self.grid, across)
        parts = []
        for _, a, b in pairs:
            own_b, place_b = np.unique(b, return_inverse=True)
            own_a, place_a = np.unique(a, return_inverse=True)
            field = filtered_down(half[:, :, own_b], self.grid, down[:, own_a])
            parts.append(field[:, :, place_a, place_b])
        tail = blurred(tile, self.grid, self._tail) + blurred_far(tile, self.far_tail)
        return np.concatenate([*parts, tail[:, :, None]], axis=2)

    def taps(self) -> Floats:
        """The functions at the taps, (k, taps down, taps across)."""
        down, across, pairs = self._axes
        parts = [down.T[a][:, :, None] * across.T[b][:, None, :] for _, a, b in pairs]
        return np.concatenate([*parts, self._tail[None]])

    @cached_property
    def _tail(self) -> Floats:
        return self._tail_at(self.grid.down.places_px, self.grid.across.places_px)

    @cached_property
    def far_tail(self) -> Floats:
        """What TAIL has beyond the taps, gathered in low pixels: (2 FAR_PX + 1,) squared."""
        down, across = (far_taps(axis) for axis in (self.grid.down, self.grid.across))
        tail = self._tail_at(down.places_px, across.places_px)
        near = down.is_near[:, None] & across.is_near
        return np.asarray(down.cells.T @ np.where(near, 0.0, tail) @ across.cells)

    def _tail_at(self, down_px: Floats, across_px: Floats) -> Floats:
        """TAIL as weights of taps: ``a / (2 pi (r^2 + a^2)^(3/2))``, transform of its transfer."""
        x, y = across_px + self.across.shift_px, down_px + self.down.shift_px
        density = tail_psf(np.hypot(x, y[:, None]), tuned.TAIL_PX)
        return np.asarray(density / (self.grid.down.per_px * self.grid.across.per_px))

    def transfer(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Fourier transforms of the functions at frequencies in cycles per low pixel, (n, k)."""
        down, across, pairs = self._axes
        along = self.grid.down.waves(v_cpp) @ down
        over = self.grid.across.waves(u_cpp) @ across
        tail = tail_otf(np.hypot(u_cpp, v_cpp), tuned.TAIL_PX) * np.conj(
            self.centring(u_cpp, v_cpp)
        )
        parts = [along[:, a] * over[:, b] for _, a, b in pairs]
        return np.concatenate([*parts, tail[:, None]], axis=1)

    def centring(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor, (n,), that moves the parametric kernel's centre to the origin."""
        shift = u_cpp * self.across.shift_px + v_cpp * self.down.shift_px
        return np.asarray(np.exp(2j * math.pi * shift))


def _process(
    axis: TapAxis, shift_px: float, extent: float, smoothness: float
) -> tuple[Floats, Floats]:
    """Kernels (taps, r) whose squares sum to a process's covariance along an axis, and powers.

    As weights of taps: a density per pixel takes 1 / per_px of it.
    """
    place = axis.places_px + shift_px
    variance, shape = covariance_modes(place, extent, smoothness, _NEGLIGIBLE)
    # Eigenvectors come with any sign: a stored fit needs the same ones wherever it is read.
    lean = np.exp(-0.5 * (place / extent) ** 2) * (1 + place / extent)
    shape = shape * np.where(lean @ shape < 0, -1.0, 1.0)
    return np.asarray(shape * np.sqrt(variance) / axis.per_px), variance
