"""The pixels a measurement starts from, read from a region of an image."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import ImageError, NoDataError, RegionError
from acutance.numerics.clipping import NOT_CLIPPED, ClipLevels
from acutance.raster import Box, Fill, Gsd, Image, Region, find_fill
from acutance.raster.gsd import gsd_in_words
from acutance.raster.pixels import PartPixels
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.processing_traces import (
    ProcessingTraces,
    surroundings,
    traces_of_pixels,
    with_surroundings,
)
from acutance.targets.record import ImageInfo

__all__ = [
    "RegionPixels",
    "RoiLike",
    "chosen_region",
    "image_info",
    "read_data",
    "read_region",
    "stated_gsd",
    "undeclared_fill",
]

_MAX_PIXELS = 9_000_000
_MIN_SIDE_PX = 8
_MAX_SIZE = 1e75
"""Largest value of an image, and one over the smallest: curvatures are fourth powers."""
_MAX_GSD_ROUNDING = 0.05

RoiLike = Region | Box | tuple[int, int, int, int] | Floats | None


@dataclass(frozen=True, eq=False)
class RegionPixels:
    """Pixels of a region.

    Attributes
    ----------
    pixels : (rows, cols) array
        NaN outside the region and where there is no data.
    box : Box
        Where they lie in the image.
    saturation_level : float or None
        The largest value the detector can give.
    gsd : Gsd or None
    image : Image
    fill : Fill or None
        Undeclared fill that was left out: NaN in `pixels`.
    clipped : ClipLevels
        Values at which the image around the region was found to be clipped.
    name : str
        Of the region, where it has one.
    is_polygon : bool
        Whether the region leaves out pixels of the box.
    """

    pixels: Floats
    box: Box
    saturation_level: float | None
    gsd: Gsd | None
    image: Image
    fill: Fill | None = None
    clipped: ClipLevels = NOT_CLIPPED
    name: str = ""
    is_polygon: bool = False

    @cached_property
    def info(self) -> ImageInfo:
        """What a measurement records of its image: the same for every kind of target."""
        found = image_info(self.image, self.box, self.gsd, self.name)
        return replace(found, is_polygon=self.is_polygon)

    @property
    def curve_advice(self) -> str | None:
        """What to do where values are not proportional to light, of an image that was linearised.

        ``None`` of others: the advice of the check.
        """
        curve = self.image.characteristic
        if curve is None:
            return None
        return (
            f"values that are not proportional to light change RER and MTF, and the image was "
            f"linearised ({curve.words}): is this its curve, with the right white and power? A "
            "linear image needs none"
        )

    @cached_property
    def traces(self) -> ProcessingTraces:
        """What processing left in the pixels and around: the same for all edges of a region."""
        return with_surroundings(traces_of_pixels(self.pixels), self.image, self.box)

    def apart(self) -> RegionPixels:
        """The same, apart from its image: what a measurement reads of it later is read now."""
        frame = surroundings(self.image.shape, self.box)
        kept = (
            PartPixels(self.box, self.pixels)
            if frame is None
            else PartPixels(frame, self.image.read(frame))
        )
        return replace(self, image=replace(self.image, source=kept))


def image_info(image: Image, box: Box, gsd: Gsd | None, region: str = "") -> ImageInfo:
    """What a measurement records of a part of an image."""
    of_file = image.gsd_of_file(box.row + box.height / 2, box.col + box.width / 2)
    return ImageInfo(
        image.path, image.band, box.as_tuple(), image.crs, image.along_track,
        None if gsd is None else (gsd.row_m, gsd.col_m),
        None if image.characteristic is None else image.characteristic.words,
        (of_file.row_m, of_file.col_m) if gsd and of_file and _is_another(gsd, of_file) else None,
        image.band_name,
        None if image.path is None else image.band_count,
        region or None,
        restored=image.restored, stated_nodata=image.stated_nodata,
    )  # fmt: skip


def _is_another(stated: Gsd, of_file: Gsd) -> bool:
    """Whether a stated GSD is no rounding of the image's own."""
    ratios = (stated.row_m / of_file.row_m, stated.col_m / of_file.col_m)
    return max(abs(math.log(one)) for one in ratios) > _MAX_GSD_ROUNDING


def read_region(
    image: Image | ArrayLike, roi: RoiLike = None, gsd_m: float | Gsd | None = None
) -> RegionPixels:
    """Read a region of an image, and only that.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        None reads the whole image.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.

    Raises
    ------
    ImageError, OptionError
        If there is no image, or the GSD is no positive number.
    RegionError
        If the region is none, lies outside the image, is too small, or far larger than any target;
        `NoDataError` if it holds too few pixels with data.
    """
    source = Image.of(image)
    where = Box.whole(source.shape) if roi is None else chosen_region(roi)
    if isinstance(where, Region):
        box, region = where.box(source.shape), where
    else:
        box, region = where, None
        box.require_inside(source.shape)
    if box.height * box.width > _MAX_PIXELS:
        raise RegionError(
            f"the region has {box.height} x {box.width} pixels, more than any target: choose "
            "a region around the target (row, column, height, width, a polygon or a site)"
        )
    if min(box.height, box.width) < _MIN_SIDE_PX:
        raise RegionError(
            f"the region has {box.height} x {box.width} pixels: a target needs at least "
            f"{_MIN_SIDE_PX} both ways"
        )
    pixels, fill = read_data(source, box)
    is_polygon = False
    if region is not None:
        inside = region.mask(box)
        is_polygon = not bool(inside.all())
        pixels = np.where(inside, pixels, np.nan)
        fill = None if fill is None else fill.within(inside)
    usable = int(np.count_nonzero(np.isfinite(pixels)))
    if usable < _MIN_SIDE_PX**2:
        last = "NaN or infinite"
        if fill is not None:
            last = f"NaN, infinite or a constant fill of {fill.value:.9g}"
        raise NoDataError(
            f"only {usable} of the region's {pixels.size} pixels hold data: the rest is nodata, "
            f"masked, {last}; choose another region, or correct the nodata value if pixels that "
            "have it are data (nodata, --nodata; nan: every value is data)"
        )
    gsd = source.gsd(box.row + box.height / 2, box.col + box.width / 2)
    if gsd_m is not None:
        gsd = Gsd.given(gsd_m)
    return RegionPixels(
        pixels, box, source.saturation_level, gsd, source, fill,
        name="" if region is None else region.name, is_polygon=is_polygon,
    )  # fmt: skip


def read_data(image: Image, box: Box) -> tuple[Floats, Fill | None]:
    """The pixels of a box that hold data, (height, width), NaN elsewhere.

    Undeclared fill is no data, and is returned beside them where there is some.

    Raises
    ------
    ImageError
        If the values are so large or so small that powers of them cannot be represented.
    """
    pixels = image.read(box)
    fill = find_fill(image, box, pixels)
    if fill is not None:
        pixels[fill.mask] = np.nan
    _require_units(pixels)
    return pixels, fill


def _require_units(pixels: Floats) -> None:
    """Refuse an image in absurd units; a few absurd values among others are the fits' to find."""
    size = np.abs(pixels[np.isfinite(pixels)])
    largest = float(size.max(initial=0.0))
    if 0 < largest < 1 / _MAX_SIZE:
        found = f"the largest value of the region is {largest:.3g}"
    elif largest > _MAX_SIZE and (usual := float(np.median(size[size > 0]))) > _MAX_SIZE:
        found = f"the values of the region are about {usual:.3g}"
    else:
        return
    raise ImageError(
        f"{found}, where only {1 / _MAX_SIZE:g} to {_MAX_SIZE:g} can be measured, as powers of the "
        "contrast have to be represented: multiply the image by a constant, or check its units, "
        "its scale factor and its nodata value"
    )


def undeclared_fill(fills: Sequence[Fill | None], limits: Limits) -> Check:
    """The check that names undeclared fill of the pixels read.

    Parameters
    ----------
    fills : sequence of Fill or None
        One of every reading.
    limits : mapping of str to float
        Limits the caller changed.
    """
    count = sum(one.count for one in fills if one is not None)
    values = sorted({one.value for one in fills if one is not None})
    named = " or ".join(f"{value:.9g}" for value in values)
    found = "no fill was found that is not declared"
    if count:
        found = (
            f"{count} pixels are fill without data, the value {named} up to the image's border, "
            "which ends more sharply than any sensor's image"
        )
    return answer("undeclared_fill", count, found, limits)


def stated_gsd(info: ImageInfo, limits: Limits) -> Check:
    """The check that names a stated GSD far from the image's own.

    Parameters
    ----------
    info : ImageInfo
    limits : mapping of str to float
        Limits the caller changed.
    """
    stated, own = info.pixel_gsd_m, info.file_gsd_m
    if stated is None or own is None:
        return answer("stated_gsd", 1.0, "no GSD is stated that the image has otherwise", limits)
    factor = max(max(one / other, other / one) for one, other in zip(stated, own, strict=True))
    found = (
        f"the stated GSD is {gsd_in_words(stated)}, the image's own {gsd_in_words(own)}: another "
        f"by a factor of {factor:.3g}"
    )
    return answer("stated_gsd", min(factor, MAX_RATIO), found, limits)


def chosen_region(roi: Any) -> Region | Box:
    """A region, a box, the box of four numbers, or the polygon of an array of corners.

    Raises
    ------
    RegionError
        If it is none of these.
    """
    if isinstance(roi, Region | Box):
        return roi
    if isinstance(roi, str | bytes):
        raise RegionError(
            f"roi is the text {roi!r}: read it with acutance.raster.parse_roi(text, image), or "
            "give (row, column, height, width)"
        )
    if isinstance(roi, Mapping):
        raise RegionError(
            f"roi is {roi!r:.80}: give (row, column, height, width), a Box or a Region; the "
            "polygon of a GeoJSON file is read by acutance.raster.parse_roi(path, image)"
        )
    try:
        numbers: Sequence[Any] = tuple(roi)
    except TypeError:
        raise RegionError(
            f"roi is of type {type(roi).__name__}: give (row, column, height, width), a Box or a "
            "Region"
        ) from None
    if any(isinstance(one, slice) for one in numbers):
        raise RegionError(
            f"roi is {roi!r:.80}, which holds slices: give (row, column, height, width), of "
            "slices (start, start, stop - start, stop - start)"
        )
    if np.ndim(roi) == 2 and np.shape(roi)[1] == 2:
        # Corners as a survey of simulated edges has them.
        return Region(np.asarray(roi))
    if len(numbers) != 4:
        raise RegionError(
            f"roi has {len(numbers)} numbers: give four, (row, column, height, width), in pixels"
        )
    return Box(*numbers)
