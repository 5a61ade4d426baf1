"""The pixels around point sources, each with its nearest source and the others that light it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.noise import robust_scale, rounding_std
from acutance.targets.points import tuned

__all__ = ["Stamps", "cut_stamps"]

_Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Stamps:
    """Pixels of all sources, one source after the other, (n,) each.

    Parameters
    ----------
    row, col : (n,) arrays
        Integers at pixel centres.
    value : (n,) array
    owner : (n,) int array
        Which source a pixel belongs to, ascending.
    pair_pixel, pair_source : (p,) int arrays
        Which pixel is lit by which other source.
    """

    row: Floats
    col: Floats
    value: Floats
    owner: _Indices
    pair_pixel: _Indices
    pair_source: _Indices

    @cached_property
    def least_noise(self) -> float:
        """What rounding to the step of the image's numbers alone leaves: a standard deviation.

        Where most pixels of an even background have one number, their median deviation is nothing.
        """
        return rounding_std(self.value)

    def noise_of(self, residual: Floats) -> float:
        """Standard deviation of the bulk of residuals, (n,): that of rounding at least.

        Their median is no measure where it is less than the step of the image's numbers: then it is
        the root mean square of those within three steps.
        """
        scale, step = robust_scale(residual), math.sqrt(12) * self.least_noise
        if scale < step:
            bulk = residual[np.abs(residual) < 3 * step]
            scale = math.sqrt(float(np.mean(bulk**2))) if bulk.size else step
        return max(scale, self.least_noise)

    @cached_property
    def starts(self) -> _Indices:
        """Where each source's pixels start, and the end, (sources + 1,)."""
        return np.searchsorted(self.owner, np.arange(self.owner[-1] + 2))

    @cached_property
    def lit_pixel(self) -> _Indices:
        """Which pixel every one of `all_offsets` belongs to, (n + p,)."""
        return np.concatenate([np.arange(self.value.size), self.pair_pixel])

    def lights(self, fluxes: Floats) -> Floats:
        """Flux of the source of every one of `all_offsets`, (n + p,), from those of all, (k,)."""
        return np.concatenate([fluxes[self.owner], fluxes[self.pair_source]])

    def offsets(self, places: Floats) -> tuple[Floats, Floats]:
        """Distances x, y of every pixel from its own source at `places` (row, col), (n,)."""
        return self.col - places[self.owner, 1], self.row - places[self.owner, 0]

    def levels(self, places: Floats, backgrounds: Floats) -> Floats:
        """The background of every pixel, (n,), by its own source's level and slopes, (k, 3)."""
        x, y = self.offsets(np.rint(places))
        level, down, right = backgrounds[self.owner].T
        return np.asarray(level + down * y + right * x)

    def all_offsets(self, places: Floats) -> tuple[Floats, Floats]:
        """Distances x, y of every pixel from its own source, then those of all pairs, (n + p,)."""
        x, y = self.offsets(places)
        pixel, source = self.pair_pixel, self.pair_source
        pair_x, pair_y = self.col[pixel] - places[source, 1], self.row[pixel] - places[source, 0]
        return np.concatenate([x, pair_x]), np.concatenate([y, pair_y])

    def summed(self, fluxes: Floats, values: Floats) -> Floats:
        """What all sources add to every pixel, (n,), from values for unit flux at `all_offsets`."""
        light = self.lights(fluxes) * values
        return np.asarray(np.bincount(self.lit_pixel, light, self.value.size), float)


def cut_stamps(image: Floats, places: Floats, radius_px: float) -> Stamps:
    """The finite pixels within `radius_px` of a source, each given to the nearest one.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where there is no data.
    places : (n, 2) array
        Sources as (row, col).
    radius_px : float

    Raises
    ------
    TargetError
        If a source has no pixel of its own.
    """
    reach = np.arange(-int(radius_px) - 1, int(radius_px) + 2)
    down, right = (grid.ravel() for grid in np.meshgrid(reach, reach, indexing="ij"))
    middle = np.rint(places).astype(np.intp)
    rows, cols = middle[:, :1] + down, middle[:, 1:] + right
    inside = (rows >= 0) & (cols >= 0) & (rows < image.shape[0]) & (cols < image.shape[1])
    inside &= np.hypot(rows - places[:, :1], cols - places[:, 1:]) <= radius_px
    source = np.broadcast_to(np.arange(places.shape[0])[:, None], rows.shape)[inside]
    pixels = np.stack([rows[inside], cols[inside]], axis=1)
    tree = cKDTree(places)
    kept = (tree.query(pixels)[1] == source) & np.isfinite(image[pixels[:, 0], pixels[:, 1]])
    pixels, source = pixels[kept], source[kept]
    _require_pixels(places, np.bincount(source, minlength=len(places)), radius_px)
    lit = cKDTree(pixels).query_ball_point(places, tuned.LIT_PX)
    pair_source = np.repeat(np.arange(len(places)), [len(one) for one in lit])
    pair_pixel = np.concatenate([np.asarray(one, np.intp) for one in lit])
    others = pair_source != source[pair_pixel]
    return Stamps(
        pixels[:, 0].astype(float),
        pixels[:, 1].astype(float),
        image[pixels[:, 0], pixels[:, 1]],
        source,
        pair_pixel[others],
        pair_source[others],
    )


def _require_pixels(places: Floats, own: _Indices, radius_px: float) -> None:
    """Refuse sources around which all pixels are missing or nearer to another one."""
    if own.all():
        return
    row, col = places[int(np.argmin(own))].tolist()
    raise TargetError(
        f"the source at row {row:.1f}, column {col:.1f} has no pixel of its own: all within "
        f"{radius_px:g} px of it are missing or nearer to another source; such are no points: "
        "leave it out of the positions, or choose a region of separate points"
    )
