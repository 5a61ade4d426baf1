"""A filter applied: to an array, or to a file of any size."""

from __future__ import annotations

import hashlib
import math
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_flags, require_path
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ImageError, NoDataError, OptionError
from acutance.execution.partial_folder import partial_folder
from acutance.raster import Box, Image, SwathFill, find_swath_fill, open_image
from acutance.raster.pixels import (
    equals_nodata,
    is_npy,
    largest_count,
    require_image_array,
    require_nodata,
    storable_nodata,
)
from acutance.restoration.filter_match import (
    chosen_bands,
    match_notes,
    require_match,
    require_unrestored,
    restored_tags,
)
from acutance.restoration.restoration_filter import RestorationFilter, require_filter
from acutance.restoration.window_filter import PixelCounts, StoredType, reach_px, restored_window

__all__ = ["RestoredImage", "restore", "restore_array"]

_LINES = 1024
_Path = str | os.PathLike[str]


@dataclass(frozen=True, eq=False)
class RestoredImage(ShortRepr):
    """A file that a filter was applied to.

    Parameters
    ----------
    path : str
        The new file.
    bands : dict of int to PixelCounts
        What became of the pixels of each band that was filtered.
    notes : tuple of str
        What was not compared with the filter, and what was copied as it is.
    """

    path: str
    bands: dict[int, PixelCounts]
    notes: tuple[str, ...] = ()

    def summary(self) -> str:
        """The file, and how many pixels of all bands were special."""
        return f"{self.path}, {sum(self.bands.values(), PixelCounts()).in_words()}"

    def to_dict(self) -> dict[str, Any]:
        """Path, counts and notes, for JSON."""
        return {
            "path": self.path,
            "bands": {str(band): one.to_dict() for band, one in self.bands.items()},
            "notes": list(self.notes),
        }


@overload
def restore(
    image: _Path,
    filter: RestorationFilter,
    *,
    out: _Path,
    bands: int | Sequence[int] | Literal["all"] | None = None,
    nodata: float | None = None,
    saturation: float | None = None,
    accept_mismatch: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> RestoredImage: ...
@overload
def restore(
    image: ArrayLike,
    filter: RestorationFilter,
    *,
    nodata: float | None = None,
    saturation: float | None = None,
) -> NDArray[Any]: ...
def restore(
    image: Any,
    filter: RestorationFilter,
    *,
    out: _Path | None = None,
    bands: int | Sequence[int] | Literal["all"] | None = None,
    nodata: float | None = None,
    saturation: float | None = None,
    accept_mismatch: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Any:
    """Sharpen an image: an array, or a file of any size into another.

    The stored type is kept: results are rounded, and clipped to its range. Pixels without data stay
    so, and their neighbours are filtered as if the image went on smoothly there, as at its border.
    A constant beyond a swath counts as no data even where the file does not declare it. Saturated
    pixels stay as they are, and so nearly do those next to them, which would ring.

    Parameters
    ----------
    image : path or (rows, columns) array
        Any raster GDAL reads, or an array of integers or floats, masked or not.
    filter : RestorationFilter
    out : path, optional
        Of a file the new one, a cloud optimized GeoTIFF with everything else of the original;
        an existing one is replaced once the new one is complete.
    bands : int, sequence of int or "all", optional
        Bands of a file, from 1: without it the one that was measured, or the only one. The
        others are copied.
    nodata : float, optional
        The stored value of pixels without data, instead of the one the file declares. NaN: every
        value is data, also a constant beyond a swath.
    saturation : float, optional
        The stored value from which pixels are saturated, instead of the largest of their type.
    accept_mismatch : bool, optional
        Filter although pixel size or band are not those that were measured, or although the image
        was restored before.
    progress : function of (done, total), optional
        Called with numbers of pixels.

    Returns
    -------
    array or RestoredImage
        Of an array one of the same shape and type, of a file what became of its pixels.

    Raises
    ------
    OptionError
        If the filter was made for other pixels or another band, `out` is the input, or an argument
        is of the wrong kind.
    ImageError
        If the image cannot be read or the new one not be written.
    NoDataError
        If no pixel of a file has data, or all that have are saturated; an array of such pixels,
        the tile of an image, stays as it is.
    """
    require_filter(filter)
    require_nodata(nodata)
    require_flags(accept_mismatch=accept_mismatch)
    if isinstance(image, Image):
        raise OptionError(
            "the image is an Image, which is one band as it is measured: give its pixels, "
            "image.read(), or the path of its file and the new one's (out)"
        )
    if not isinstance(image, str | os.PathLike):
        if out is not None:
            raise OptionError("out was given with an array: the result is returned")
        if bands is not None:
            raise OptionError("bands were given with an array, which is one band: leave them out")
        array, counts = restore_array(image, filter, nodata=nodata, saturation=saturation)
        if counts.clipped_low or counts.clipped_high or counts.fill:
            warnings.warn(f"restored {counts.in_words()}", stacklevel=2)
        return array
    if out is None:
        raise OptionError(f"{os.fspath(image)} is a file: name the one to be written (out)")
    require_path(out=out)
    return _restore_file(
        os.fspath(image), os.fspath(out), filter, bands, nodata, saturation, accept_mismatch,
        progress,
    )  # fmt: skip


def restore_array(
    image: ArrayLike,
    filter: RestorationFilter,
    *,
    nodata: float | None = None,
    saturation: float | None = None,
) -> tuple[NDArray[Any], PixelCounts]:
    """An array, sharpened, and what became of its pixels; arguments are those of `restore`.

    Raises
    ------
    OptionError, ImageError
        If an argument is of the wrong kind, or the image smaller than the kernel.
    """
    require_filter(filter)
    require_nodata(nodata)
    array = np.asanyarray(image)
    require_image_array(array, "the array")
    raw, mask = np.ma.getdata(array), np.ma.getmaskarray(array)
    masked = mask | equals_nodata(raw, nodata)
    if raw.dtype.kind == "f":
        masked |= ~np.isfinite(raw)
    _require_fitting(raw.shape, filter)
    view = Image.from_array(array, nodata=nodata)
    fill = find_swath_fill(view)
    kind = _stored_type(
        raw.dtype,
        _left_alone(view, storable_nodata(raw.dtype, nodata), fill),
        saturation,
        largest_count(raw.dtype),
    )
    counts = PixelCounts()
    if fill is not None:
        own = fill.mask(Box.whole(view.shape)) & ~masked
        masked |= own
        counts += PixelCounts(fill=int(np.count_nonzero(own)))
    result = np.empty_like(raw)
    reach = reach_px(filter.kernel)
    for row in range(0, raw.shape[0], _LINES):
        last = min(row + _LINES, raw.shape[0])
        rows = slice(max(0, row - reach), min(last + reach, raw.shape[0]))
        around = [(max(0, reach - row), max(0, last + reach - raw.shape[0])), (reach, reach)]
        beyond = np.pad(np.zeros(raw[rows].shape, bool), around, constant_values=True)
        result[row:last], found = restored_window(
            np.pad(raw[rows], around), np.pad(masked[rows], around), beyond, filter.kernel, kind
        )
        counts += found
    if isinstance(array, np.ma.MaskedArray):
        return np.ma.MaskedArray(result, mask=mask, fill_value=array.fill_value), counts
    return result, counts


def _restore_file(
    path: str,
    out: str,
    filter: RestorationFilter,
    bands: int | Sequence[int] | Literal["all"] | None,
    nodata: float | None,
    saturation: float | None,
    accept_mismatch: bool,
    progress: Callable[[int, int], None] | None,
) -> RestoredImage:
    first = open_image(path, nodata=nodata)
    _require_other_file(path, out)
    if is_npy(path):
        return _restore_npy(out, filter, first, nodata, saturation)
    from acutance.raster.rewriting import StoredWindow, rewrite_image, stored_tags

    if not out.lower().endswith((".tif", ".tiff")):
        raise OptionError(f"out is {out}: the image is written as GeoTIFF, name a .tif")
    chosen = chosen_bands(first, filter, bands)
    images = {band: open_image(path, band, nodata=nodata) for band in chosen}
    _require_fitting(first.shape, filter)
    earlier = stored_tags(path)
    if not accept_mismatch:
        require_match(first, filter, chosen, isinstance(bands, str))
        require_unrestored(path, earlier)
    fills = {band: find_swath_fill(one) for band, one in images.items()}
    kinds = {
        band: _stored_type(
            np.dtype(one.dtype),
            _left_alone(one, _stored_nodata(one), fills[band]),
            saturation,
            getattr(one.source, "largest_count", None),
        )
        for band, one in images.items()
    }
    counts = dict.fromkeys(chosen, PixelCounts())
    reach = reach_px(filter.kernel)

    def change(window: StoredWindow) -> NDArray[Any]:
        masked, fill = window.masked, fills[window.band]
        if fill is not None:
            own = fill.mask(window.box) & ~masked
            masked = masked | own
            inner = own[reach:-reach, reach:-reach]
            counts[window.band] += PixelCounts(fill=int(np.count_nonzero(inner)))
        pixels, found = restored_window(
            window.pixels, masked, window.outside, filter.kernel, kinds[window.band]
        )
        counts[window.band] += found
        _require_data(counts, first)
        return pixels

    tags = restored_tags(_tag(filter, chosen), earlier)
    notes = rewrite_image(
        path, out, change, bands=chosen, margin_px=reach, nodata=nodata,
        tags=tags, progress=progress,
    )  # fmt: skip
    return RestoredImage(out, counts, match_notes(first, filter, chosen) + notes)


def _restore_npy(
    out: str,
    filter: RestorationFilter,
    image: Image,
    nodata: float | None,
    saturation: float | None,
) -> RestoredImage:
    """An array in a NumPy file, into another."""
    if not is_npy(out):
        raise OptionError(f"out is {out}: an image in a .npy file is written as one, name a .npy")
    source: Any = image.source
    pixels, counts = restore_array(source.map(), filter, nodata=nodata, saturation=saturation)
    _require_data({1: counts}, image)
    place = Path(os.path.realpath(out))
    try:
        # Also where the run is interrupted no part of an image stays: it is of no use.
        with partial_folder(place) as folder:
            part = Path(folder, place.name)
            with part.open("wb") as file:
                np.save(file, pixels)
            os.replace(part, place)
    except OSError as error:
        raise ImageError(f"{out} cannot be written ({error.strerror or error})") from error
    return RestoredImage(out, {1: counts}, match_notes(image, filter, [1]))


def _require_data(counts: dict[int, PixelCounts], image: Image) -> None:
    """Refuse an image without any data, once all of it was read and before it gets its name.

    Raises
    ------
    NoDataError
        If no pixel of any band has data, or all that have are saturated.
    """
    whole = image.shape[0] * image.shape[1]
    if any(one.pixels != whole or one.nodata + one.saturated != whole for one in counts.values()):
        return
    if any(one.saturated for one in counts.values()):
        raise NoDataError(
            f"every pixel of {image.path} that has data is saturated: nothing was written; state "
            "the stored value of saturated pixels (saturation, --saturation)"
        )
    raise NoDataError(f"no pixel of {image.path} has data: nothing was written")


def _stored_type(
    dtype: np.dtype[Any], nodata: float | None, saturation: float | None, largest: float | None
) -> StoredType:
    if saturation is not None:
        if not isinstance(saturation, Real) or not math.isfinite(saturation):
            raise OptionError(f"saturation is {saturation!r}: give a finite stored value")
        return StoredType(dtype, nodata, float(saturation))
    return StoredType(dtype, nodata, largest)


def _stored_nodata(image: Image) -> float | None:
    """The nodata value of an image of a file, as its pixels have it."""
    return storable_nodata(np.dtype(image.dtype), getattr(image.source, "nodata", None))


def _left_alone(image: Image, nodata: float | None, fill: SwathFill | None) -> float | None:
    """The stored value that no pixel with data becomes: that of nodata, else that of fill."""
    if nodata is not None or fill is None:
        return nodata
    return (
        round(_stored(image, fill.value)) if image.dtype[0] in "iu" else _stored(image, fill.value)
    )


def _stored(image: Image, value: float) -> float:
    """How a value, in the units an image is read in, is stored."""
    source = image.source
    return float((value - getattr(source, "offset", 0.0)) / getattr(source, "scale", 1.0))


def _require_fitting(shape: tuple[int, ...], filter: RestorationFilter) -> None:
    if min(shape) < filter.size:
        raise OptionError(
            f"the image has {shape[0]} by {shape[1]} pixels, fewer than the kernel of "
            f"{filter.size} by {filter.size}: design a smaller one (size), or give a larger image"
        )


def _require_other_file(path: str, out: str) -> None:
    if os.path.exists(out) and os.path.exists(path) and os.path.samefile(path, out):
        raise OptionError(f"out is {out}, the input itself: name another file")
    if os.path.isdir(out):
        raise OptionError(f"out is {out}, a folder: name a file in it")


def _tag(filter: RestorationFilter, bands: Sequence[int]) -> str:
    """What was applied, in a line: the kernel is known by the first digits of its hash."""
    digest = hashlib.sha256(np.ascontiguousarray(filter.kernel).tobytes()).hexdigest()[:16]
    across, along = filter.after.across.mtf_nyquist, filter.after.along.mtf_nyquist
    return (
        f"{filter.method} kernel {filter.size}x{filter.size} sha256:{digest}; bands "
        f"{','.join(map(str, bands))}; noise gain {filter.noise_gain:.4g}; MTF at Nyquist "
        f"{across.value:.4f} across, {along.value:.4f} along"
    )
