"""How the pixels of a low image lie on those of a high one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_optional
from acutance.curves.grid import Floats
from acutance.errors import OptionError, RegionError
from acutance.raster import Image
from acutance.targets.pair.tile import TapAxis

__all__ = ["PairAxis", "PairGrid", "pair_grid"]

_MAX_SAMPLES: Final = 4
_MAX_DRIFT_PX: Final = 0.02
"""Difference from a whole ratio over the image, in high pixels, below which it is one."""
_MIN_RATIO: Final = 1.2
_MAX_RATIO: Final = 64.0
_MAX_CONTRADICTION: Final = 0.005
_MAX_ROTATION_PX: Final = 0.1
_SINC_LOBES: Final = 10


@dataclass(frozen=True)
class PairAxis:
    """One axis of a pair: the high image's index of a low pixel's centre is
    ``origin + ratio * index``.

    Parameters
    ----------
    ratio : float
        High pixels in a low one.
    origin : float
        Index in the high image of the first low pixel's centre.
    low_size, high_size : int
        Pixels of either image along the axis.
    shift_px : float, optional
        Displacement of the low image's content that the taps follow, in low pixels.
    """

    ratio: float
    origin: float
    low_size: int
    high_size: int
    shift_px: float = 0.0

    @cached_property
    def is_native(self) -> bool:
        """Whether the high image's own samples are used, equally placed in every low pixel."""
        nearest = round(self.ratio)
        drift = abs(self.ratio - nearest) * self.low_size
        return nearest <= _MAX_SAMPLES and nearest >= 2 and drift < _MAX_DRIFT_PX

    @cached_property
    def per_px(self) -> int:
        """Samples in a low pixel that the kernel acts on."""
        if self.is_native:
            return round(self.ratio)
        return max(2, min(_MAX_SAMPLES, math.ceil(self.ratio)))

    @cached_property
    def base(self) -> int:
        """Index of the middle sample of the first low pixel, native samples."""
        return round(self.origin - self.shift_px * self.ratio)

    @cached_property
    def offset_px(self) -> float:
        """Place of the middle sample against the low pixel's centre, in low pixels."""
        if self.is_native:
            return (self.base - self.origin) / self.ratio
        return -round(self.shift_px * self.per_px) / self.per_px

    def taps(self, reach_px: float) -> TapAxis:
        """Taps out to `reach_px` low pixels."""
        return TapAxis(self.per_px, self.offset_px, round(reach_px * self.per_px))

    def places(self, first: int, count: int) -> Floats:
        """Indices in the high image of samples counted from the first low pixel's middle one."""
        order = np.arange(first, first + count)
        if self.is_native:
            return np.asarray(self.base + order, float)
        return np.asarray(self.origin + self.ratio * (order / self.per_px + self.offset_px))

    def window(self, first: int, count: int) -> tuple[int, int]:
        """First index and number of the high pixels that give samples, inside the image."""
        places = self.places(first, count)
        lobes = 0 if self.is_native else math.ceil(_SINC_LOBES * self._stretch)
        start = min(max(math.floor(places[0]) - lobes, 0), self.high_size - 1)
        stop = max(min(math.ceil(places[-1]) + lobes + 1, self.high_size), start + 1)
        return start, stop - start

    def leaves_image(self, first: int, count: int) -> bool:
        """Whether some of the samples lie beyond the image."""
        places = self.places(first, count)
        return bool(places[0] < -0.5 or places[-1] > self.high_size - 0.5)

    def weights(
        self, first: int, count: int, *, mirrored: bool = False
    ) -> Floats | NDArray[np.intp]:
        """How samples follow from the pixels of `window`: indices, or a matrix (samples, pixels).

        Beyond the image the outermost pixel is repeated, or the image mirrored. Samples between
        pixels, or fewer than pixels, are band-limited: a sinc of ten lobes under a Kaiser window.
        """
        start, size = self.window(first, count)
        places = self.places(first, count) - start
        if mirrored:
            places = np.abs(places)
            places = np.minimum(places, 2 * (size - 1) - places)
        if self.is_native:
            return np.clip(np.round(places).astype(np.intp), 0, size - 1)
        reach = _SINC_LOBES * self._stretch
        middle = np.clip(places, 0, size - 1)
        apart = middle[:, None] - np.arange(size)
        inside = np.maximum(1 - (apart / reach) ** 2, 0.0)
        kernel = np.sinc(apart / self._stretch) * np.i0(6.0 * np.sqrt(inside)) * (inside > 0)
        return np.asarray(kernel / kernel.sum(axis=1, keepdims=True))

    @cached_property
    def _stretch(self) -> float:
        """Width of the resampling sinc in high pixels."""
        return max(1.0, self.ratio / self.per_px)

    def inner(self, reach_px: float) -> tuple[int, int]:
        """First low pixel, and one beyond the last, whose taps all lie in the high image."""
        margin = reach_px + 0.5 / self.per_px
        low = (0 - self.origin) / self.ratio + self.shift_px + margin
        high = (self.high_size - 1 - self.origin) / self.ratio + self.shift_px - margin
        return max(0, math.ceil(low)), min(self.low_size, math.floor(high) + 1)

    @property
    def band_cpp(self) -> float:
        """The highest frequency at which the pair is measured, in cycles per low pixel."""
        return min(self.per_px, self.ratio) / 2


@dataclass(frozen=True)
class PairGrid:
    """How the low image lies on the high one.

    Parameters
    ----------
    down, across : PairAxis
        Along rows and columns.
    source : str
        Where the ratio is from: "geotransform", "shapes" or "given".
    """

    down: PairAxis
    across: PairAxis
    source: str

    def shifted(self, shift_px: tuple[float, float]) -> PairGrid:
        """The grid whose taps follow a displacement (rows, columns) of the low content."""
        rows, cols = shift_px
        return replace(
            self,
            down=replace(self.down, shift_px=rows),
            across=replace(self.across, shift_px=cols),
        )


def pair_grid(low: Image, high: Image, ratio: float | None) -> PairGrid:
    """Find how two images lie on each other.

    Geotransforms decide; a given ratio has to agree with them. Without them, the images' first
    corners coincide, and the ratio is the given one or that of their shapes.

    Raises
    ------
    OptionError
        If the ratio is missing, makes no sense, or contradicts the geotransforms.
    RegionError
        If the images do not overlap, or are turned against each other.
    """
    require_optional(Real, ratio=ratio)
    if ratio is not None and not (math.isfinite(ratio) and _MIN_RATIO <= ratio <= _MAX_RATIO):
        raise OptionError(
            f"a ratio of {ratio:g} was asked: the low image's GSD has to be {_MIN_RATIO:g} to "
            f"{_MAX_RATIO:g} times that of the high one"
        )
    if low.geolocation is not None and high.geolocation is not None:
        return _by_geotransforms(low, high, ratio)
    found, source = (_by_shapes(low, high), "shapes") if ratio is None else (ratio, "given")
    if ratio is not None:
        _require_size(low, high, ratio)
    axes = [
        PairAxis(found, 0.5 * found - 0.5, low.shape[i], high.shape[i]) for i in (0, 1)
    ]  # fmt: skip
    return PairGrid(axes[0], axes[1], source)


def _require_size(low: Image, high: Image, ratio: float) -> None:
    """Refuse a plain pair whose shapes have another ratio: it shows different ground."""
    shares = [high.shape[i] / low.shape[i] for i in (0, 1)]
    whole = [max(1.0, 0.02 * high.shape[i]) for i in (0, 1)]
    away = [abs(high.shape[i] - ratio * low.shape[i]) for i in (0, 1)]
    if any(gap > room for gap, room in zip(away, whole, strict=True)):
        raise OptionError(
            f"a ratio of {ratio:g} was given, but {_sizes(low, high)}, which show the same ground "
            f"unless they are georeferenced, have {shares[0]:.3g} and {shares[1]:.3g}: cut both to "
            "the same ground, or give files with geotransforms"
        )


def _by_shapes(low: Image, high: Image) -> float:
    rows, cols = (high.shape[i] / low.shape[i] for i in (0, 1))
    found = 0.5 * (rows + cols)
    nearest = round(found)
    longest = max(low.shape)
    if abs(rows - nearest) * longest <= 1 and abs(cols - nearest) * longest <= 1 and nearest >= 2:
        return float(nearest)
    if abs(rows - cols) * longest <= 1 and found >= _MIN_RATIO:
        return found
    if max(rows, cols) < 1:
        advice = "they are exchanged, the low one comes first"
    else:
        advice = f"both have to show the same ground, at a ratio of at least {_MIN_RATIO:g}"
    raise OptionError(
        f"{_sizes(low, high)}, without geotransforms, have ratios of {rows:.3g} down the rows and "
        f"{cols:.3g} along them: {advice}; or give the ratio"
    )


def _sizes(low: Image, high: Image) -> str:
    """Both images with their sizes, in words."""
    return (
        f"a low image of {low.shape[0]} x {low.shape[1]} and a high one of {high.shape[0]} x "
        f"{high.shape[1]} pixels"
    )


def _by_geotransforms(low: Image, high: Image, ratio: float | None) -> PairGrid:
    assert low.geolocation is not None
    assert high.geolocation is not None
    rows, cols = (float(size - 1) for size in low.shape)
    at_row, at_col = np.array([0.0, 0.0, rows, rows]), np.array([0.0, cols, 0.0, cols])
    x, y = low.geolocation.to_map(at_row, at_col)
    down, across = high.geolocation.from_crs(x, y, low.geolocation.crs)
    # All corners turn together: a low image of the whole Earth has them on both sides.
    middle = float(across.mean())
    across = across + (high.geolocation.nearest_turn(middle, high.shape[1]) - middle)
    if not (np.isfinite(down).all() and np.isfinite(across).all()):
        raise RegionError(
            "the low image's corners have no place in the high image's CRS: the two show "
            "different ground"
        )
    rotation_px = max(abs(down[1] - down[0]), abs(across[2] - across[0]), abs(down[3] - down[2]),
               abs(across[3] - across[1]))  # fmt: skip
    if rotation_px > _MAX_ROTATION_PX:
        raise RegionError(
            f"the images are turned or sheared against each other by {rotation_px:.2g} high pixels "
            "over the low image: resample the high one onto a grid parallel to the low one's first"
        )
    ratios = (
        (down[2] - down[0]) / max(rows, 1.0),
        (across[1] - across[0]) / max(cols, 1.0),
    )  # fmt: skip
    if min(ratios) < _MIN_RATIO or max(ratios) > _MAX_RATIO:
        raise OptionError(
            f"by the geotransforms the first image's pixels are {ratios[0]:.3g} by {ratios[1]:.3g} "
            f"times as large as the second's: {_MIN_RATIO:g} to {_MAX_RATIO:g} is needed, and "
            "the low image comes first"
        )
    if ratio is not None and any(abs(ratio / own - 1) > _MAX_CONTRADICTION for own in ratios):
        raise OptionError(
            f"a ratio of {ratio:g} was given, but the geotransforms have {ratios[0]:.6g} by "
            f"{ratios[1]:.6g}: leave the ratio out, or correct the files"
        )
    axes = [
        PairAxis(float(r), float(first), low.shape[i], high.shape[i])
        for i, (r, first) in enumerate(zip(ratios, (down[0], across[0]), strict=True))
    ]
    for axis, name in zip(axes, ("rows", "columns"), strict=True):
        start, stop = axis.inner(0.0)
        if stop <= start:
            raise RegionError(
                f"the images do not overlap along {name}: by the geotransforms the low image lies "
                f"at {axis.origin:.0f} to {axis.origin + axis.ratio * axis.low_size:.0f} of the "
                f"high image's {axis.high_size} {name}"
            )
    return PairGrid(axes[0], axes[1], "geotransform")
