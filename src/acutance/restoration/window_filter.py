"""One window of an image, filtered: pixels without data and saturated ones apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.convolution import convolve_inside
from acutance.raster.pixels import equals_nodata
from acutance.restoration.filling import CONTEXT_PX, fill_unusable

__all__ = ["PixelCounts", "StoredType", "reach_px", "restored_window"]

Mask = NDArray[np.bool_]

_SATURATED_SHARE = 0.04
"""Share of a kernel's absolute weights on saturated pixels at which a pixel is left as it was."""
_TILE_PX = 256


@dataclass(frozen=True)
class PixelCounts:
    """What became of the pixels of a band.

    Parameters
    ----------
    pixels : int
        Of the image.
    nodata : int
        Left as they were.
    saturated : int
        Left as they were, and their neighbours nearly so.
    clipped_low, clipped_high : int
        Would have left the range of the stored type.
    off_nodata : int
        Would have become the value of nodata, and were moved by one step.
    fill : int
        Of those without data: a constant beyond the swath, which the image does not declare.
    """

    pixels: int = 0
    nodata: int = 0
    saturated: int = 0
    clipped_low: int = 0
    clipped_high: int = 0
    off_nodata: int = 0
    fill: int = 0

    def __add__(self, other: PixelCounts) -> PixelCounts:
        return PixelCounts(*(getattr(self, name) + getattr(other, name) for name in vars(self)))

    def in_words(self) -> str:
        """How many were special; what happened to none is left out."""
        words = {
            "nodata": "without data",
            "fill": "of them fill that is not declared",
            "saturated": "saturated",
            "clipped_low": "clipped below",
            "clipped_high": "clipped above",
            "off_nodata": "moved off the nodata value",
        }
        found = [
            f"{getattr(self, name)} {word}" for name, word in words.items() if getattr(self, name)
        ]
        return f"{self.pixels} pixels" + (f", {', '.join(found)}" if found else "")

    def to_dict(self) -> dict[str, int]:
        """All by name."""
        return dict(vars(self))


@dataclass(frozen=True, eq=False)
class StoredType(ShortRepr):
    """How the pixels of a band are stored.

    Parameters
    ----------
    dtype : numpy dtype
    nodata : float or None
        The stored value of pixels without data.
    largest : float or None
        The largest stored count, which saturated pixels have; ``None`` for floats.
    """

    dtype: np.dtype[Any]
    nodata: float | None
    largest: float | None

    @property
    def working(self) -> type[np.floating[Any]]:
        """The type that sums are taken in.

        Single precision errs by a fiftieth of a step of 16 bits at most, and takes half as long.
        """
        single = self.dtype.itemsize <= 2 or self.dtype == np.float32
        return np.float32 if single else np.float64


def reach_px(kernel: Floats) -> int:
    """How far around a window pixels are needed: by the kernel, and by substitutes under it."""
    return int(kernel.shape[0] // 2 + 2 * CONTEXT_PX)


def restored_window(
    stored: NDArray[Any], masked: Mask, outside: Mask, kernel: Floats, kind: StoredType
) -> tuple[NDArray[Any], PixelCounts]:
    """The inner part of a window, filtered, in the type it is stored in.

    Parameters
    ----------
    stored : (rows, cols) array
        The window with `reach_px` more pixels on every side.
    masked : (rows, cols) bool array
        Pixels without data.
    outside : (rows, cols) bool array
        Places beyond the image.
    kernel : (m, m) array
    kind : StoredType

    Returns
    -------
    pixels : array
        Without the reach on its sides.
    counts : PixelCounts
    """
    reach, half = reach_px(kernel), kernel.shape[0] // 2
    inner = (slice(reach, -reach), slice(reach, -reach))
    values = stored.astype(kind.working)
    saturated = np.zeros(stored.shape, bool)
    if kind.largest is not None:
        saturated = (stored >= kind.largest) & ~masked & ~outside
    usable = ~(masked | outside | saturated)
    if not usable.all():
        fill_unusable(values, usable, reach - half)
    needed = slice(reach - half, half - reach or None)
    sharp = convolve_inside(np.ascontiguousarray(values[needed, needed]), kernel)
    own = stored[inner]
    kept = masked[inner] | saturated[inner]
    if saturated.any():
        _hold_near(sharp, own, saturated[needed, needed], kernel)
    pixels, counts = _as_stored(sharp, own, kept, kind)
    return pixels, counts + PixelCounts(
        nodata=int(np.count_nonzero(masked[inner])),
        saturated=int(np.count_nonzero(saturated[inner])),
    )


def _hold_near(
    sharp: NDArray[np.floating[Any]], own: NDArray[Any], saturated: Mask, kernel: Floats
) -> None:
    """Draw pixels near saturated ones back to what they were, in place.

    What light a saturated pixel lost is not known, so neither is what it cast on its neighbours:
    on landscapes with glints, the unfiltered pixel errs less than any that was filtered.
    """
    weights = np.abs(kernel) / np.abs(kernel).sum()
    half = kernel.shape[0] // 2
    for row in range(0, sharp.shape[0], _TILE_PX):
        for col in range(0, sharp.shape[1], _TILE_PX):
            part = np.s_[row : row + _TILE_PX, col : col + _TILE_PX]
            around = saturated[row : row + _TILE_PX + 2 * half, col : col + _TILE_PX + 2 * half]
            if around.any():
                share = convolve_inside(around.astype(np.float32), weights)
                held = np.minimum(share / _SATURATED_SHARE, 1.0)
                sharp[part] += held * (own[part] - sharp[part])


def _as_stored(
    sharp: NDArray[np.floating[Any]], own: NDArray[Any], kept: Mask, kind: StoredType
) -> tuple[NDArray[Any], PixelCounts]:
    """Rounded, within the range of the type, off the value of nodata; kept pixels as they were."""
    low = high = moved = 0
    if kind.dtype.kind in "iu":
        bounds = np.iinfo(kind.dtype)
        top = bounds.max if kind.largest is None else min(bounds.max, int(kind.largest))
        np.rint(sharp, out=sharp)
        low = int(np.count_nonzero((sharp < bounds.min) & ~kept))
        high = int(np.count_nonzero((sharp > top) & ~kept))
        if low or high or kept.any():
            np.clip(sharp, bounds.min, _not_above(top), out=sharp)
    else:
        with np.errstate(over="ignore"):
            infinite = ~np.isfinite(sharp.astype(kind.dtype)) & ~kept
        high = int(np.count_nonzero(infinite))
        if high:
            limit = float(np.finfo(kind.dtype).max)
            np.clip(sharp, -limit, limit, out=sharp)
    with np.errstate(over="ignore", invalid="ignore"):
        pixels = sharp.astype(kind.dtype)
    on_nodata = equals_nodata(pixels, kind.nodata) & ~kept
    if on_nodata.any():
        moved = int(np.count_nonzero(on_nodata))
        pixels[on_nodata] = _beside(own[on_nodata], kind)
    if kept.any():
        pixels[kept] = own[kept]
    return pixels, PixelCounts(sharp.size, 0, 0, low, high, moved)


def _not_above(top: int) -> float:
    """The largest float that is no larger than an integer of 64 bits."""
    found = float(top)
    return float(np.nextafter(found, 0.0)) if int(found) > top else found


def _beside(own: NDArray[Any], kind: StoredType) -> NDArray[Any]:
    """The value next to that of nodata, towards what a pixel was; above where it was that value.

    Pixels with data have that value where it is of fill that the image does not declare.
    """
    assert kind.nodata is not None
    nodata = kind.dtype.type(kind.nodata)
    if kind.dtype.kind in "iu":
        step = np.where((own < nodata) | (nodata == np.iinfo(kind.dtype).max), -1, 1)
        return np.asarray((int(nodata) + step).astype(kind.dtype))
    return np.asarray(np.nextafter(nodata, np.where(own == nodata, np.inf, own)).astype(kind.dtype))
