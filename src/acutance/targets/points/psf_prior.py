"""What is known of a point spread function before the pixels are seen.

The PSF is the mean blur, a Gaussian through a pixel with a free ellipse, plus what follows, each
with an amplitude that the data decide (`amplitudes`):

- APERTURE: another width of the detector's aperture across and along;
- the families of sensors (`psf_families`): the principal directions in which telescopes, halos,
  trails, smear, sharpened, restored and resampled products depart from the mean;
- SHAPE, DETAIL: smooth differences near the peak and its fine structure, for what no family has;
- TAIL: light falling like 1 / r^3 without end, as behind an aperture that diffracts.

SHAPE and DETAIL are Gaussian processes as the prior of an LSF has them. A
process has covariance ``exp(-(u^2 + u'^2) / 2 L^2) exp(-(u - u')^2 / 2 l^2)`` in either
direction, in units of the blur's width. By Mehler's formula its eigenfunctions are Hermite
functions, with variances that fall by a constant factor from order to order: every direction has
a closed form in the plane and in the plane of frequencies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel_2d import WIDE_WIDTHS, GaussianPixel2d, PixelSlopes
from acutance.numerics.lorentz_tail import tail_otf, tail_psf
from acutance.targets.points import tuned
from acutance.targets.points.psf_families import Families, learned_families
from acutance.targets.points.psf_modes import Process, add_modes, hermite, hermite_slopes

__all__ = ["PsfDirections"]

Complexes = NDArray[np.complex128]


_PROCESSES: Final = tuple(Process(*one) for one in tuned.PROCESSES)
_BLURRED: Final = 5
_GAUGE_STEP: Final = 0.3
_GAUGE_REACH: Final = 4.5


def _in_widths(u: Floats, v: Floats, light: Floats, pixel: NDArray[np.intp], count: int) -> Floats:
    """Families, without tails, and modes at places in widths, summed over pixels, (count, r).

    These are the same for every blur, in units of its widths.
    """
    families = learned_families()
    sizes = [process.sizes for process in _PROCESSES]
    found = np.zeros((count, families.tail.size + sum(one.size for one in sizes)))
    families.add(found, pixel, light, u, v)
    first = families.tail.size
    for process, size in zip(_PROCESSES, sizes, strict=True):
        across, along = (hermite(at / process.scale, process.order) for at in (u, v))
        add_modes(found, first, pixel, light, across, along, *process.orders, size)
        first += size.size
    return found


@cache
def _raster_in_widths() -> tuple[Floats, Floats, Floats]:
    """A dense raster of places in widths, and `_in_widths` there."""
    steps = np.arange(-_GAUGE_REACH, _GAUGE_REACH + 1e-9, _GAUGE_STEP)
    u, v = (grid.ravel() for grid in np.meshgrid(steps, steps))
    return u, v, _in_widths(u, v, np.ones(u.size), np.arange(u.size), u.size)


@dataclass(frozen=True)
class PsfDirections:
    """The directions in which the PSF may differ from a mean `blur`.

    First the three elements of Sigma and the two apertures, then the families, the modes of the
    processes, and the tail. From each the share is taken out that a change of flux or of place
    would explain: every source has its own flux and place.
    """

    blur: GaussianPixel2d

    def __reduce__(self) -> tuple[type[PsfDirections], tuple[GaussianPixel2d]]:
        # The tables all follow from the blur.
        return PsfDirections, (self.blur,)

    @property
    def families(self) -> Families:
        """The directions learned from optics, in units of the blur's widths."""
        return learned_families()

    @property
    def size(self) -> int:
        """Number of directions."""
        return self.block.size

    @cached_property
    def block(self) -> NDArray[np.intp]:
        """Which amplitude determines each direction; -1 for those with a scale of their own."""
        last = len(tuned.FAMILY_LOG_AMPLITUDES)
        counts = [3, 2, *(process.sizes.size for process in _PROCESSES), 1]
        rest = np.repeat([-1, -1, last, last + 1, last + 2], counts)
        return np.concatenate([rest[:_BLURRED], self.families.block, rest[_BLURRED:]])

    @cached_property
    def scale(self) -> Floats:
        """Prior standard deviation of each direction, relative to its block's amplitude."""
        scale = np.ones(self.size)
        scale[:3] = self.half_width_px**2
        scale[3:_BLURRED] = tuned.APERTURE_STD * self.blur.aperture_px
        return scale

    @property
    def learned(self) -> slice:
        """Which directions are those of the families."""
        return slice(_BLURRED, self._first_mode)

    @property
    def is_detail(self) -> NDArray[np.bool_]:
        """Which directions are modes of DETAIL, (size,)."""
        return np.asarray(self.block == len(tuned.FAMILY_LOG_AMPLITUDES) + 1)

    @cached_property
    def _first_mode(self) -> int:
        """Number of the first mode of the processes."""
        return _BLURRED + self.families.tail.size

    @property
    def half_width_px(self) -> float:
        """Half width of the tail: the mean width of the blur."""
        return math.sqrt(self._area)

    @property
    def _area(self) -> float:
        return math.prod(self.blur.widths_px)

    def evaluate(self, x: Floats, y: Floats) -> Floats:
        """Every direction at places (x, y) in pixels, (n, size)."""
        return self.summed(x, y, np.ones(x.size), np.arange(x.size))[0]

    def summed(
        self, x: Floats, y: Floats, light: Floats, pixel: NDArray[np.intp]
    ) -> tuple[Floats, Floats]:
        """Every direction, and the mean blur, summed over the sources that light a pixel.

        Parameters
        ----------
        x, y : (n,) arrays
            Places of pixels about sources.
        light : (n,) array
            Flux of the source.
        pixel : (n,) int array
            Number of the pixel; none below the largest is missing.

        Returns
        -------
        (m, size) array
        (m,) array
        """
        count, area = int(pixel.max()) + 1, self._area
        wide, high = self.blur.widths_px

        def onto(values: Floats) -> Floats:
            return np.asarray(np.bincount(pixel, light * values, count), float)

        parts = [onto(one) for one in self.blur.slopes(x, y)]
        tail = onto(tail_psf(np.hypot(x, y), self.half_width_px))
        columns = np.empty((count, self.size))
        columns[:, _BLURRED:-1] = _in_widths(x / wide, y / high, light / area, pixel, count)
        self._complete(columns, parts, tail)
        columns -= np.stack(parts[:3], axis=1) @ self._gauge
        return columns, parts[0]

    def _complete(self, columns: Floats, slopes: Sequence[Floats], tail: Floats) -> None:
        """Put the blur's directions and the tail beside those of `_in_widths`."""
        columns[:, :_BLURRED] = np.stack(slopes[3:], axis=1)
        columns[:, self.learned] += tail[:, None] * self.families.tail
        columns[:, -1] = tail

    def sum(self, x: Floats, y: Floats, weights: Floats) -> Floats:
        """Mean blur plus ``evaluate(x, y) @ weights``, (n,)."""
        if not weights.any():
            return self.blur.psf(x, y)
        slopes = self.blur.slopes(x, y)
        psf = slopes.psf - (self._gauge @ weights) @ np.stack(slopes[:3])
        for weight, part in zip(weights.tolist(), slopes[3:], strict=False):
            psf += weight * part
        psf += self._of_families(x, y, weights)[0]
        for table, (scale_x, scale_y) in self._mixtures(weights):
            order = table.shape[0] - 1
            along = table @ hermite(y / scale_y, order)
            psf += np.einsum("ij,ij->j", hermite(x / scale_x, order), along)
        tail = self._tail_weight(weights)
        return np.asarray(psf + tail * tail_psf(np.hypot(x, y), self.half_width_px))

    def _tail_weight(self, weights: Floats) -> float:
        own = weights[_BLURRED : self._first_mode]
        return float(weights[-1] + self.families.tail @ own)

    def _of_families(self, x: Floats, y: Floats, weights: Floats) -> Floats:
        """What the families add, without tails, and its derivatives by x and y, (3, n)."""
        wide, high = self.blur.widths_px
        sums = self.families.sums(x / wide, y / high, weights[self.learned])
        return sums / (self._area * np.array([[1.0], [wide], [high]]))

    def _scaled(self) -> list[tuple[Process, tuple[float, float]]]:
        """The processes with the scales of their modes across and along, in pixels."""
        wide, high = self.blur.widths_px
        return [(one, (one.scale * wide, one.scale * high)) for one in _PROCESSES]

    def _mixtures(self, weights: Floats) -> list[tuple[Floats, tuple[float, float]]]:
        """For every process, weights of the products of Hermite functions, and their scales."""
        first, area = self._first_mode, self._area
        found = []
        for process, scales in self._scaled():
            i, j = process.orders
            table = np.zeros((process.order + 1, process.order + 1))
            table[i, j] = weights[first : first + i.size] * process.sizes / area
            first += i.size
            found.append((table, scales))
        return found

    def sum_with_slopes(self, x: Floats, y: Floats, weights: Floats) -> tuple[Floats, ...]:
        """Mean blur plus ``evaluate(x, y) @ weights`` and its derivatives by x and y."""
        slopes = self.blur.slopes(x, y)
        if not weights.any():
            return slopes[:3]
        gauge = self._gauge @ weights
        step = 1e-4
        shifted = [self.blur.slopes(x + step, y), self.blur.slopes(x, y + step)]

        def blurred(at: tuple[Floats, ...]) -> Floats:
            whole = at[0] * (1 - gauge[0]) - gauge[1] * at[1] - gauge[2] * at[2]
            for weight, column in zip(weights[:_BLURRED].tolist(), at[3:], strict=True):
                whole = whole + weight * column
            return np.asarray(whole)

        psf = blurred(slopes)
        by_x, by_y = ((blurred(one) - psf) / step for one in shifted)
        learned = self._of_families(x, y, weights)
        psf, by_x, by_y = (
            part + more for part, more in zip((psf, by_x, by_y), learned, strict=True)
        )
        for table, (scale_x, scale_y) in self._mixtures(weights):
            across = hermite(x / scale_x, table.shape[0])
            along = hermite(y / scale_y, table.shape[0])
            mixed = table @ along[:-1]
            psf = psf + np.einsum("ij,ij->j", across[:-1], mixed)
            by_x = by_x + np.einsum("ij,ij->j", hermite_slopes(across), mixed) / scale_x
            by_y = (
                by_y + np.einsum("ij,ij->j", table.T @ across[:-1], hermite_slopes(along)) / scale_y
            )
        tail = self._tail_weight(weights) * tail_psf(np.hypot(x, y), self.half_width_px)
        bend = -3 * tail / (x * x + y * y + self.half_width_px**2)
        return psf + tail, by_x + bend * x, by_y + bend * y

    @cached_property
    def _raster(self) -> tuple[Floats, Floats, PixelSlopes]:
        """A dense raster of places, and the blur there."""
        wide, high = self.blur.widths_px
        u, v, _ = _raster_in_widths()
        x, y = u * wide, v * high
        return x, y, self.blur.slopes(x, y)

    def _shares(self, columns: Floats) -> Floats:
        """Shares of the blur, and of its slopes by x and y, in columns on the raster, (3, m).

        What least squares on a dense raster of pixels under white noise would find.
        """
        own = np.stack(self._raster[2][:3], axis=1)
        return np.asarray(np.linalg.solve(own.T @ own, own.T @ columns))

    @cached_property
    def _gauge(self) -> Floats:
        """Shares of the blur, and of its slopes by x and y, in every direction: (3, size)."""
        x, y, slopes = self._raster
        columns = np.empty((x.size, self.size))
        columns[:, _BLURRED:-1] = _raster_in_widths()[2] / self._area
        self._complete(columns, slopes, tail_psf(np.hypot(x, y), self.half_width_px))
        return self._shares(columns)

    def light_of_blur(self, psf: Callable[[Floats, Floats], Floats]) -> float:
        """Flux of the mean blur that least squares finds in a PSF, a function of places (x, y).

        No direction holds any: a source of this flux has the amplitudes of the directions.
        """
        x, y, _ = self._raster
        return float(self._shares(psf(x, y)[:, None])[0, 0])

    @property
    def wings_share(self) -> float:
        """How much of the blur least squares finds in the wings of the first fit."""
        return self.light_of_blur(self.blur.widened(WIDE_WIDTHS).psf)

    def transform(self, u: Floats, v: Floats) -> Complexes:
        """Fourier transform of every direction at frequencies in cycles per pixel, (n, size)."""
        columns = np.empty((u.size, self.size), complex)
        columns[:, :_BLURRED] = self.blur.otf_slopes(u, v)
        wide, high = self.blur.widths_px
        tail = tail_otf(np.hypot(u, v), self.half_width_px)
        first = self._first_mode
        columns[:, _BLURRED:first] = self.families.transform(u * wide, v * high)
        columns[:, _BLURRED:first] += tail[:, None] * self.families.tail
        for process, (scale_x, scale_y) in self._scaled():
            across = hermite(2 * np.pi * scale_x * u, process.order)
            along = hermite(2 * np.pi * scale_y * v, process.order)
            order_x, order_y = process.orders
            size = 2 * np.pi * scale_x * scale_y / self._area
            turns = (-1j) ** ((order_x + order_y) % 4) * process.sizes * size
            columns[:, first : first + order_x.size] = (across[order_x] * along[order_y]).T * turns
            first += order_x.size
        columns[:, -1] = tail
        own = self.blur.otf(u, v)
        gauge = self._gauge
        columns -= own[:, None] * gauge[0]
        columns -= (2j * np.pi * u * own)[:, None] * gauge[1]
        columns -= (2j * np.pi * v * own)[:, None] * gauge[2]
        return columns

    def transform_sum(self, u: Floats, v: Floats, weights: Floats) -> Complexes:
        """``transform(u, v) @ weights`` and the mean blur's transform: that of `sum`, (n,)."""
        own = self.blur.otf(u, v)
        if not weights.any():
            return own.astype(complex)
        wide, high = self.blur.widths_px
        gauge = self._gauge @ weights
        found = own * (1 - gauge[0] - 2j * np.pi * (u * gauge[1] + v * gauge[2]))
        found += self.blur.otf_slopes(u, v) @ weights[:_BLURRED]
        learned = weights[_BLURRED : self._first_mode]
        found += self.families.transform_sum(u * wide, v * high, learned)
        for table, (scale_x, scale_y) in self._mixtures(weights):
            order = np.arange(table.shape[0])
            turns = (-1j) ** ((order[:, None] + order) % 4) * (2 * np.pi * scale_x * scale_y)
            across = hermite(2 * np.pi * scale_x * u, order[-1])
            along = hermite(2 * np.pi * scale_y * v, order[-1])
            found += np.einsum("ij,ij->j", across, (table * turns) @ along)
        tail = tail_otf(np.hypot(u, v), self.half_width_px)
        return np.asarray(found + self._tail_weight(weights) * tail)
