"""What is known of a point spread function before the pixels are seen.

The PSF is the mean blur, a Gaussian through a pixel with a free ellipse, plus what follows, each
with an amplitude that the data decide (`amplitudes`):

- APERTURE: another width of the detector's aperture across and along;
- WINGS: the blur twice and four times as wide (scatter; less light there, if negative);
- AIRY: the image behind an aperture as narrow as the blur, with its rings and wings: clear, and
  with a third of its diameter obscured;
- SHAPE: smooth differences near the peak (sharpening, asymmetry, smear);
- DETAIL: fine structure of the peak (a hard aperture, little optical blur);
- HALO: broad differences out to many widths (stray light, halo, charge trails);
- TAIL: light falling like 1 / r^3 without end, as behind an aperture that diffracts.

SHAPE, DETAIL and HALO are Gaussian processes as the prior of an LSF has them. A
process has covariance ``exp(-(u^2 + u'^2) / 2 L^2) exp(-(u - u')^2 / 2 l^2)`` in either
direction, in units of the blur's width. By Mehler's formula its eigenfunctions are Hermite
functions, with variances that fall by a constant factor from order to order: every direction has
a closed form in the plane and in the plane of frequencies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel_2d import (
    WIDE_WIDTHS,
    Gaussian2d,
    GaussianPixel2d,
    PixelSlopes,
)
from acutance.numerics.lorentz_tail import tail_otf, tail_psf
from acutance.numerics.process_modes import mehler
from acutance.targets.points import tuned
from acutance.targets.points.airy import Airy

__all__ = ["PsfDirections"]

Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class _Process:
    """A Gaussian process of extent L and smoothness l, in widths, up to an order of its modes.

    Its amplitude is normalised so that, integrated over one direction, it has the variance of
    the process of an LSF with the same L and l at the line's middle.
    """

    extent: float
    smoothness: float
    order: int

    @property
    def ratio(self) -> float:
        """Factor of the variance from one order to the next."""
        return mehler(self.extent, self.smoothness)[0]

    @property
    def scale(self) -> float:
        """Scale of the Hermite functions, in widths."""
        return mehler(self.extent, self.smoothness)[1]

    @cached_property
    def orders(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Orders across and along of every mode."""
        i, j = np.indices((self.order + 1, self.order + 1)).reshape(2, -1)
        kept = i + j <= self.order
        return i[kept], j[kept]

    @cached_property
    def sizes(self) -> Floats:
        """Standard deviation of every mode's coefficient, relative to the process."""
        i, j = self.orders
        inverse = 1 / self.extent**2
        lsf_variance = 2 * np.pi / math.sqrt(inverse * (inverse + 2 / self.smoothness**2))
        middle = math.pi * (1 - self.ratio**2) * self.ratio ** (i + j)
        return np.asarray(np.sqrt(middle / lsf_variance))


_PROCESSES: Final = tuple(_Process(*one) for one in tuned.PROCESSES)
_BLURRED: Final = 5
_EXPLICIT: Final = 9
_GAUGE_STEP: Final = 0.3
_GAUGE_REACH: Final = 4.5


def hermite(t: Floats, order: int) -> Floats:
    """Orthonormal Hermite functions 0 .. order at `t` (n,), as (order + 1, n)."""
    values = np.empty((order + 1, t.size))
    values[0] = math.pi**-0.25 * np.exp(-0.5 * t * t)
    if order > 0:
        values[1] = math.sqrt(2.0) * t * values[0]
    for n in range(2, order + 1):
        values[n] = math.sqrt(2 / n) * t * values[n - 1] - math.sqrt((n - 1) / n) * values[n - 2]
    return values


def _hermite_slopes(values: Floats) -> Floats:
    """Derivatives by t of the Hermite functions but the last, from the functions."""
    orders = np.arange(values.shape[0] - 1)[:, None]
    slopes = -np.sqrt((orders + 1) / 2) * values[1:]
    slopes[1:] += np.sqrt(orders[1:] / 2) * values[: slopes.shape[0] - 1]
    return slopes


@dataclass(frozen=True)
class PsfDirections:
    """The directions in which the PSF may differ from a mean `blur`.

    First the three elements of Sigma, the two apertures, the wings and the Airy patterns, then the
    modes of the processes, then the tail. From each the share is taken out that a change of flux
    or of place would explain: every source has its own flux and place.
    """

    blur: GaussianPixel2d

    def __reduce__(self) -> tuple[type[PsfDirections], tuple[GaussianPixel2d]]:
        # The tables all follow from the blur.
        return PsfDirections, (self.blur,)

    @cached_property
    def _patterns(self) -> tuple[GaussianPixel2d | Gaussian2d | Airy, ...]:
        """What has a form of its own and one weight: wings, and apertures that diffract."""
        blur, sigma_px = self.blur, (self.blur.xx * self.blur.yy) ** 0.25
        airy = (Airy.as_narrow_as(sigma_px, hole, blur.aperture_px) for hole in tuned.OBSCURATIONS)
        return (blur.widened(WIDE_WIDTHS), blur.broadened(tuned.BROAD_WIDTHS), *airy)

    def _explicit(self, x: Floats, y: Floats, slopes: PixelSlopes) -> tuple[Floats, ...]:
        """The directions that are no process and no tail, before the gauge."""
        return (*slopes[3:], *(one.psf(x, y) for one in self._patterns))

    @property
    def size(self) -> int:
        """Number of directions."""
        return _EXPLICIT + sum(process.sizes.size for process in _PROCESSES) + 1

    @cached_property
    def block(self) -> NDArray[np.intp]:
        """Which amplitude determines each direction; -1 for those with a scale of their own."""
        counts = [
            3,
            2,
            2,
            len(tuned.OBSCURATIONS),
            *(process.sizes.size for process in _PROCESSES),
            1,
        ]
        return np.repeat([-1, 4, 5, 6, 0, 1, 2, 3], counts)

    @cached_property
    def scale(self) -> Floats:
        """Prior standard deviation of each direction, relative to its block's amplitude."""
        scale = np.ones(self.size)
        scale[:3] = self.half_width_px**2
        scale[3:5] = self.blur.aperture_px
        return scale

    @property
    def half_width_px(self) -> float:
        """Half width of the tail: the mean width of the blur."""
        return math.sqrt(math.prod(self.blur.widths_px))

    def evaluate(self, x: Floats, y: Floats) -> Floats:
        """Every direction at places (x, y) in pixels, (n, size)."""
        return self.with_mean(x, y)[0]

    def with_mean(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Every direction at places (x, y), (n, size), and the mean blur there, (n,)."""
        slopes = self.blur.slopes(x, y)
        columns = self._raw(x, y, self._explicit(x, y, slopes)).T
        columns -= self._gauge.T @ np.stack(slopes[:3])
        return columns.T, slopes.psf

    def sum(self, x: Floats, y: Floats, weights: Floats) -> Floats:
        """Mean blur plus ``evaluate(x, y) @ weights``, (n,)."""
        if not weights.any():
            return self.blur.psf(x, y)
        slopes = self.blur.slopes(x, y)
        gauge = self._gauge @ weights
        psf = slopes.psf - gauge @ np.stack(slopes[:3])
        for weight, part in zip(weights.tolist(), self._explicit(x, y, slopes), strict=False):
            psf += weight * part
        for table, (scale_x, scale_y) in self._mixtures(weights):
            order = table.shape[0] - 1
            along = table @ hermite(y / scale_y, order)
            psf += np.einsum("ij,ij->j", hermite(x / scale_x, order), along)
        return np.asarray(psf + weights[-1] * tail_psf(np.hypot(x, y), self.half_width_px))

    def _raw(self, x: Floats, y: Floats, explicit: tuple[Floats, ...]) -> Floats:
        columns = np.empty((self.size, x.size))
        for i, column in enumerate(explicit):
            columns[i] = column
        first = _EXPLICIT
        for process, (scale_x, scale_y) in self._scaled():
            across, along = hermite(x / scale_x, process.order), hermite(y / scale_y, process.order)
            order_x, order_y = process.orders
            own = columns[first : first + order_x.size]
            np.multiply(across[order_x], along[order_y], out=own)
            own *= (process.sizes / math.prod(self.blur.widths_px))[:, None]
            first += order_x.size
        columns[-1] = tail_psf(np.hypot(x, y), self.half_width_px)
        return columns.T

    def _scaled(self) -> list[tuple[_Process, tuple[float, float]]]:
        """The processes with the scales of their modes across and along, in pixels."""
        wide, high = self.blur.widths_px
        return [(one, (one.scale * wide, one.scale * high)) for one in _PROCESSES]

    def _mixtures(self, weights: Floats) -> list[tuple[Floats, tuple[float, float]]]:
        """For every process, weights of the products of Hermite functions, and their scales."""
        first, area = _EXPLICIT, math.prod(self.blur.widths_px)
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
        free = weights[:_BLURRED]

        def explicit(at: tuple[Floats, ...]) -> Floats:
            whole = at[0] * (1 - gauge[0]) - gauge[1] * at[1] - gauge[2] * at[2]
            for weight, column in zip(free.tolist(), at[3:], strict=True):
                whole = whole + weight * column
            return np.asarray(whole)

        psf = explicit(slopes)
        by_x, by_y = ((explicit(one) - psf) / step for one in shifted)
        for weight, other in zip(
            weights[_BLURRED:_EXPLICIT].tolist(),
            (one.slopes(x, y)[:3] for one in self._patterns),
            strict=True,
        ):
            psf, by_x, by_y = (
                whole + weight * part for whole, part in zip((psf, by_x, by_y), other, strict=True)
            )
        for table, (scale_x, scale_y) in self._mixtures(weights):
            across = hermite(x / scale_x, table.shape[0])
            along = hermite(y / scale_y, table.shape[0])
            mixed = table @ along[:-1]
            psf = psf + np.einsum("ij,ij->j", across[:-1], mixed)
            by_x = by_x + np.einsum("ij,ij->j", _hermite_slopes(across), mixed) / scale_x
            by_y = (
                by_y
                + np.einsum("ij,ij->j", table.T @ across[:-1], _hermite_slopes(along)) / scale_y
            )
        tail = weights[-1] * tail_psf(np.hypot(x, y), self.half_width_px)
        bend = -3 * tail / (x * x + y * y + self.half_width_px**2)
        return psf + tail, by_x + bend * x, by_y + bend * y

    @cached_property
    def _raster(self) -> tuple[Floats, Floats, PixelSlopes]:
        """A dense raster of places, and the blur there."""
        wide, high = self.blur.widths_px
        steps = np.arange(-_GAUGE_REACH, _GAUGE_REACH + 1e-9, _GAUGE_STEP)
        x, y = (grid.ravel() for grid in np.meshgrid(steps * wide, steps * high))
        return x, y, self.blur.slopes(x, y)

    @cached_property
    def _gauge(self) -> Floats:
        """Shares of the blur, and of its slopes by x and y, in every direction: (3, size).

        What least squares on a dense raster of pixels under white noise would find.
        """
        x, y, slopes = self._raster
        own = np.stack(slopes[:3], axis=1)
        raw = self._raw(x, y, self._explicit(x, y, slopes))
        return np.asarray(np.linalg.solve(own.T @ own, own.T @ raw))

    @property
    def wings_share(self) -> float:
        """How much of the blur least squares finds in the nearer wings."""
        return float(self._gauge[0, _BLURRED])

    def transform(self, u: Floats, v: Floats) -> Complexes:
        """Fourier transform of every direction at frequencies in cycles per pixel, (n, size)."""
        columns = np.empty((u.size, self.size), complex)
        columns[:, :_BLURRED] = self.blur.otf_slopes(u, v)
        for i, one in enumerate(self._patterns, start=_BLURRED):
            columns[:, i] = one.otf(u, v)
        first = _EXPLICIT
        for process, (scale_x, scale_y) in self._scaled():
            across = hermite(2 * np.pi * scale_x * u, process.order)
            along = hermite(2 * np.pi * scale_y * v, process.order)
            order_x, order_y = process.orders
            size = 2 * np.pi * scale_x * scale_y / math.prod(self.blur.widths_px)
            turns = (-1j) ** ((order_x + order_y) % 4) * process.sizes * size
            columns[:, first : first + order_x.size] = (across[order_x] * along[order_y]).T * turns
            first += order_x.size
        columns[:, -1] = tail_otf(np.hypot(u, v), self.half_width_px)
        own = self.blur.otf(u, v)
        gauge = self._gauge
        columns -= own[:, None] * gauge[0]
        columns -= (2j * np.pi * u * own)[:, None] * gauge[1]
        columns -= (2j * np.pi * v * own)[:, None] * gauge[2]
        return columns
