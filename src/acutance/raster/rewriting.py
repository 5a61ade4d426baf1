"""An image file written anew with other pixels: everything else of it is kept."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
from numpy.typing import NDArray
from rasterio.enums import ColorInterp, MaskFlags
from rasterio.shutil import copy
from rasterio.windows import Window

from acutance.execution.partial_folder import partial_folder
from acutance.raster.dataset import (
    CACHE_BYTES,
    open_quietly,
    opened_dataset,
    read_in_our_words,
)
from acutance.raster.pixels import equals_nodata
from acutance.raster.region import Box
from acutance.raster.unified_nodata import UnifiedNodata, unified_nodata
from acutance.raster.writing import written_in_our_words

__all__ = ["StoredWindow", "rewrite_image", "stored_tags"]

_WINDOW_ROWS, _WINDOW_COLS = 1024, 4096
_BLOCK_PX = 512
_ADVICE = "check that the folder exists, may be written to and has room for twice the image"
_ABOUT_PIXELS = "STATISTICS_"
"""What GDAL notes of a band's pixels; viewers stretch the image by it."""
_OWN_DOMAINS = ("IMAGE_STRUCTURE", "DERIVED_SUBDATASETS", "RPC", "IMD", "COLOR_PROFILE", "TIFF")


@dataclass(frozen=True, eq=False)
class StoredWindow:
    """A window of one band as it is stored, with the pixels around it.

    Parameters
    ----------
    band : int
        From 1.
    box : Box
        Its place; with the margin it may reach beyond the image.
    pixels : (rows, cols) array
        0 beyond the image.
    masked : (rows, cols) bool array
        Pixels without data: nodata, masked, transparent or not finite.
    outside : (rows, cols) bool array
        Places beyond the image.
    """

    band: int
    box: Box
    pixels: NDArray[Any]
    masked: NDArray[np.bool_]
    outside: NDArray[np.bool_]


def stored_tags(path: str) -> dict[str, str]:
    """Metadata items of a file, by name."""
    with opened_dataset(path) as dataset:
        return dict(dataset.tags())


def rewrite_image(
    path: str,
    out: str | os.PathLike[str],
    change: Callable[[StoredWindow], NDArray[Any]],
    *,
    bands: Sequence[int],
    margin_px: int,
    nodata: float | None = None,
    tags: dict[str, str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[str, ...]:
    """Write a cloud optimized GeoTIFF with other pixels, whole or not at all.

    Type, georeference, RPC, ground control points, metadata, scales, colour interpretation, nodata
    and masks are those of the original; bands that are not named are copied. An image description
    of DigitalGlobe's (IMD) goes into a file next to the image. Memory depends on the size of a
    window alone.

    Parameters
    ----------
    path : str
    out : str or path
        An existing file is replaced when the new one is complete.
    change : function of a StoredWindow
        Gives the pixels of the window, without its margin, in the type they are stored in; those
        with data do not get the value of nodata.
    bands : sequence of int
        Those that are changed, from 1.
    margin_px : int
        How many pixels around a window are read.
    nodata : float, optional
        The stored value of pixels without data, instead of the one the file declares.
    tags : dict of str, optional
        Metadata items that are added; those of the same names are replaced.
    progress : function of (done, total), optional
        Called with numbers of pixels.

    Returns
    -------
    tuple of str
        What could not be kept, in sentences.

    Raises
    ------
    ImageError
        If the file cannot be read, or the new one not be written.
    """
    target = Path(os.path.realpath(out))
    with ExitStack() as stack:
        stack.enter_context(rasterio.Env(GDAL_CACHEMAX=CACHE_BYTES, GDAL_TIFF_INTERNAL_MASK=True))
        with read_in_our_words(path):
            source = stack.enter_context(open_quietly(path))
            values = unified_nodata(source, nodata)
        with written_in_our_words(target, _ADVICE):
            folder = stack.enter_context(partial_folder(target))
            plain = os.path.join(folder, "plain.tif")
            made = open_quietly(plain, "w", **_profile(source, values.common))
            stack.callback(made.close)
            _copy_descriptions(source, made, tags or {}, bands)
        boxes = list(_boxes((source.height, source.width)))
        done, total = 0, source.height * source.width
        moved = dict.fromkeys(range(1, source.count + 1), 0)
        for box in boxes:
            _rewrite_box(source, made, box, change, bands, margin_px, values, moved, (path, target))
            done += box.height * box.width
            if progress is not None:
                progress(done, total)
        with written_in_our_words(target, _ADVICE):
            made.close()
            finished = os.path.join(folder, "finished.tif")
            copy(plain, finished, driver="COG", **_cog_options(source))
            description = Path(folder, "finished.IMD")
            if description.exists():
                os.replace(description, target.with_suffix(".IMD"))
            os.replace(finished, target)
    return values.notes(moved)


def _rewrite_box(
    source: Any,
    made: Any,
    box: Box,
    change: Callable[[StoredWindow], NDArray[Any]],
    bands: Sequence[int],
    margin_px: int,
    values: UnifiedNodata,
    moved: dict[int, int],
    names: tuple[str, Path],
) -> None:
    """One window of all bands: changed, or copied; pixels moved off nodata are counted."""
    path, target = names
    own = Window(box.col, box.row, box.width, box.height)
    for band in range(1, source.count + 1):
        if band in bands:
            with read_in_our_words(path):
                window = _stored_window(source, band, box, margin_px, values)
            pixels = change(window)
        else:
            with read_in_our_words(path):
                pixels = source.read(band, window=own)
        pixels, count = values.unified(pixels, band)
        moved[band] += count
        with written_in_our_words(target, _ADVICE):
            made.write(pixels, band, window=own)
    if _has_mask(source):
        with read_in_our_words(path):
            mask = source.read_masks(1, window=own)
        with written_in_our_words(target, _ADVICE):
            made.write_mask(mask, window=own)


def _stored_window(
    source: Any, band: int, box: Box, margin_px: int, values: UnifiedNodata
) -> StoredWindow:
    whole, grown = Box.whole((source.height, source.width)), box.grown(margin_px)
    inside = grown.intersection(whole)
    assert inside is not None
    window = Window(inside.col, inside.row, inside.width, inside.height)
    raw = source.read(band, window=window)
    masked = equals_nodata(raw, values.own[band - 1])
    if _has_mask(source):
        masked |= source.read_masks(band, window=window) == 0
    for number, meaning in enumerate(source.colorinterp, start=1):
        if meaning == ColorInterp.alpha and number != band:
            masked |= source.read(number, window=window) == 0
    if raw.dtype.kind == "f":
        masked |= ~np.isfinite(raw)
    return _padded(band, raw, masked, grown, inside)


def _padded(
    band: int, raw: NDArray[Any], masked: NDArray[np.bool_], grown: Box, inside: Box
) -> StoredWindow:
    """The window with places beyond the image around it."""
    before = inside.row - grown.row, inside.col - grown.col
    widths = [
        (first, size - first - own)
        for first, size, own in zip(before, grown.shape, inside.shape, strict=True)
    ]
    outside = np.pad(np.zeros(inside.shape, bool), widths, constant_values=True)
    return StoredWindow(band, grown, np.pad(raw, widths), np.pad(masked, widths), outside)


def _boxes(shape: tuple[int, int]) -> Iterator[Box]:
    """Windows of a whole image, row after row."""
    for row in range(0, shape[0], _WINDOW_ROWS):
        for col in range(0, shape[1], _WINDOW_COLS):
            height, width = min(_WINDOW_ROWS, shape[0] - row), min(_WINDOW_COLS, shape[1] - col)
            yield Box(row, col, height, width)


def _has_mask(source: Any) -> bool:
    """Whether a mask of its own lies next to the bands."""
    flags = source.mask_flag_enums[0]
    return MaskFlags.per_dataset in flags and MaskFlags.alpha not in flags


def _profile(source: Any, nodata: float | None) -> dict[str, Any]:
    types = set(source.dtypes)
    if len(types) > 1:
        raise ValueError(f"its bands have different types ({', '.join(sorted(types))})")
    gcps, _ = source.gcps
    return {
        "driver": "GTiff",
        "count": source.count,
        "height": source.height,
        "width": source.width,
        "dtype": types.pop(),
        "nodata": nodata,
        "crs": None if gcps else source.crs,
        "transform": None if gcps or source.transform.is_identity else source.transform,
        "tiled": True,
        "blockxsize": _BLOCK_PX,
        "blockysize": _BLOCK_PX,
        "bigtiff": "if_safer",
        **({"photometric": "rgb"} if _is_rgb(source) else {}),
        **({"nbits": _bits(source)} if _bits(source) else {}),
    }


def _is_rgb(source: Any) -> bool:
    return tuple(source.colorinterp[:3]) == (ColorInterp.red, ColorInterp.green, ColorInterp.blue)


def _bits(source: Any) -> str | None:
    """Bits of a pixel, where the file declares fewer than its type has."""
    bits: str | None = source.tags(1, ns="IMAGE_STRUCTURE").get("NBITS")
    return bits


def _cog_options(source: Any) -> dict[str, Any]:
    bits = _bits(source)
    return {
        "compress": "deflate",
        "predictor": "no" if bits else "yes",
        "overview_resampling": "average",
        "num_threads": "all_cpus",
        "bigtiff": "if_safer",
        **({"nbits": bits} if bits else {}),
    }


def _copy_descriptions(
    source: Any, made: Any, tags: dict[str, str], changed: Sequence[int]
) -> None:
    """Everything of a file that is no pixel, nor about pixels that are changed."""
    gcps, crs = source.gcps
    if gcps:
        made.gcps = (gcps, crs)
    if source.rpcs is not None:
        made.rpcs = source.rpcs
    made.colorinterp = source.colorinterp
    made.descriptions = source.descriptions
    made.scales, made.offsets = source.scales, source.offsets
    made.units = [unit or "" for unit in source.units]
    if "IMD" in source.tag_namespaces():
        made.update_tags(ns="IMD", **source.tags(ns="IMD"))
    made.update_tags(**(_items(source) | tags))
    for band in range(1, source.count + 1):
        items = _items(source, band)
        stale = [name for name in items if band in changed and name.startswith(_ABOUT_PIXELS)]
        made.update_tags(band, **{name: items[name] for name in items if name not in stale})


def _items(source: Any, band: int = 0) -> dict[str, str]:
    """Metadata of a file or a band; items of vendors' own domains are named DOMAIN.NAME.

    A cloud optimized GeoTIFF has no other place for them.
    """
    items: dict[str, str] = dict(source.tags(band))
    for domain in source.tag_namespaces(band):
        if domain and not domain.startswith("xml:") and domain not in _OWN_DOMAINS:
            named = source.tags(band, ns=domain).items()
            items |= {f"{domain}.{name}": value for name, value in named}
    return items
