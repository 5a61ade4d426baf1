"""Writing images as GeoTIFF."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from acutance.arguments import require_optional, require_path
from acutance.errors import ImageError, OptionError
from acutance.execution.partial_folder import partial_folder
from acutance.raster.geolocation import Geolocation
from acutance.raster.gsd import GSD_TAGS, Gsd
from acutance.raster.pixels import require_nodata
from acutance.raster.region import Box

__all__ = ["write_geotiff", "write_geotiff_tiles", "written_in_our_words"]

Transform = tuple[float, float, float, float, float, float]
"""Geotransform (a, b, c, d, e, f)."""

_TILE_PX = 256


def write_geotiff(
    path: str | os.PathLike[str],
    array: ArrayLike,
    *,
    transform: Transform | None = None,
    crs: str | None = None,
    nodata: float | None = None,
    gsd_m: float | Gsd | None = None,
    tags: Mapping[str, str] | None = None,
) -> None:
    """Write an image as a tiled, compressed GeoTIFF, whole or not at all.

    The file is written in a hidden folder beside it and renamed when it is complete. What a killed
    process left of one, the next that writes there removes.

    Parameters
    ----------
    path : str or path
        An existing file is replaced.
    array : (rows, columns) or (bands, rows, columns) array_like
        Integers or floats of a type that GeoTIFF has; written in that type.
    transform : tuple of 6 floats, optional
        Geotransform (a, b, c, d, e, f) as in `Geolocation`.
    crs : str, optional
        As rasterio understands it.
    nodata : float, optional
        The value of unusable pixels.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, kept as metadata that `open_image` reads, for an
        image that has no CRS to derive it from; with one, the geotransform counts.
    tags : mapping of str to str, optional
        Metadata of the file, by name: "ACQUISITION_DATETIME", "SENSOR".

    Raises
    ------
    ImageError
        If the array is no image, or the file cannot be written.
    OptionError
        If the GSD is not a positive number, or an argument of the wrong kind.
    """
    _require_place(path, transform, crs, nodata)
    require_optional(Mapping, tags=tags)
    bands = _as_bands(np.asarray(array))
    place = (transform, crs, nodata, {**(tags or {}), **_gsd_tags(Gsd.given(gsd_m))})
    whole = Box.whole((bands.shape[1], bands.shape[2]))
    _write(Path(path), bands.shape[0], whole.shape, bands.dtype, [(whole, bands)], *place)


def write_geotiff_tiles(
    path: str | os.PathLike[str],
    shape: tuple[int, int],
    tiles: Iterable[tuple[Box, NDArray[Any]]],
    *,
    dtype: DTypeLike = np.float32,
    transform: Transform | None = None,
    crs: str | None = None,
    nodata: float | None = None,
    gsd_m: float | Gsd | None = None,
) -> None:
    """Write an image of one band that comes in parts, with the memory of a part.

    The file is as `write_geotiff` writes it, whole or not at all: an error or an interruption
    while the parts come leaves nothing behind.

    Parameters
    ----------
    path : str or path
        An existing file is replaced.
    shape : (rows, cols)
        Of the whole image.
    tiles : iterable of (Box, (height, width) array)
        Every pixel once, in any order. Parts that begin and end at multiples of 256 pixels are
        compressed once.
    dtype : dtype_like, optional
        The type that is written. For one of integers fractions are rounded.
    transform, crs, nodata, gsd_m : optional
        As in `write_geotiff`.

    Raises
    ------
    ImageError
        If the parts do not make the image, hold values that the type does not, or the file cannot
        be written.
    OptionError
        If the GSD is not a positive number, or an argument of the wrong kind.
    """
    _require_place(path, transform, crs, nodata)
    shape = Box.whole(shape).shape
    if isinstance(tiles, str) or not hasattr(tiles, "__iter__"):
        raise OptionError(f"tiles are {tiles!r:.80}: give pairs of a Box and its pixels")
    try:
        stored = np.dtype(dtype)
    except TypeError:
        raise OptionError(f"dtype is {dtype!r:.80}: give a type of numpy, numpy.float32") from None
    bands = ((box, _tile(box, pixels, shape, stored)) for box, pixels in tiles)
    place = (transform, crs, nodata, _gsd_tags(Gsd.given(gsd_m)))
    _write(Path(path), 1, shape, stored, bands, *place)


def _require_place(
    path: Any, transform: Transform | None, crs: str | None, nodata: float | None
) -> None:
    require_path(path=path)
    require_nodata(nodata)
    require_optional(str, crs=crs)
    if transform is not None:
        Geolocation(transform, "EPSG:4326")


def _write(
    target: Path,
    count: int,
    shape: tuple[int, int],
    dtype: np.dtype[Any],
    parts: Iterable[tuple[Box, NDArray[Any]]],
    transform: Transform | None,
    crs: str | None,
    nodata: float | None,
    tags: Mapping[str, str],
) -> None:
    """Write `count` bands of a `shape`, part by part, under another name; then rename the file."""
    from rasterio import Env
    from rasterio.transform import Affine
    from rasterio.windows import Window

    from acutance.raster.dataset import CACHE_BYTES, open_quietly

    profile = {
        "driver": "GTiff",
        "count": count,
        "height": shape[0],
        "width": shape[1],
        "dtype": dtype.name,
        "nodata": nodata,
        "crs": crs,
        "transform": None if transform is None else Affine(*transform),
        "tiled": True,
        "blockxsize": _TILE_PX,
        "blockysize": _TILE_PX,
        "compress": "deflate",
        "predictor": 3 if dtype.kind == "f" else 2,
        "bigtiff": "if_safer",
    }
    written = 0
    with ExitStack() as stack:
        # Errors of what makes the parts are its own, so the loop stands outside.
        with written_in_our_words(target, _advice(dtype)):
            folder = stack.enter_context(partial_folder(target))
            stack.enter_context(Env(GDAL_CACHEMAX=CACHE_BYTES))
            partial = os.path.join(folder, "image.tif")
            dataset = stack.enter_context(open_quietly(partial, "w", **profile))
            dataset.update_tags(**tags)
        for box, bands in parts:
            written += box.height * box.width
            with written_in_our_words(target, _advice(dtype)):
                dataset.write(bands, window=Window(box.col, box.row, box.width, box.height))
        if written != shape[0] * shape[1]:
            raise ImageError(
                f"{target} is not written: its parts hold {written} pixels, the image of "
                f"{shape[0]} by {shape[1]} has {shape[0] * shape[1]}; give each of them once"
            )
        with written_in_our_words(target, _advice(dtype)):
            dataset.close()
            os.replace(partial, target)


def _gsd_tags(gsd: Gsd | None) -> dict[str, str]:
    """The GSD as metadata that `open_image` reads."""
    return {} if gsd is None else {GSD_TAGS[0]: repr(gsd.row_m), GSD_TAGS[1]: repr(gsd.col_m)}


def _advice(dtype: np.dtype[Any]) -> str:
    return (
        "check that the folder exists and may be written to, and that GeoTIFF has the type "
        f"{dtype.name}"
    )


@contextmanager
def written_in_our_words(target: Path, advice: str) -> Iterator[None]:
    """What cannot be written, as an error that tells what to do.

    Raises
    ------
    ImageError
        If the file cannot be written in there: what GDAL says, in a sentence.
    """
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import RasterioError

    try:
        yield
    except (RasterioError, CPLE_BaseError, OSError, ValueError, TypeError) as error:
        raise ImageError(
            f"{target} cannot be written ({error.__cause__ or error}): {advice}"
        ) from error


def _tile(
    box: Box, pixels: NDArray[Any], shape: tuple[int, int], stored: np.dtype[Any]
) -> NDArray[Any]:
    """A part with its band first, if it fits."""
    box.require_inside(shape)
    if pixels.shape != box.shape:
        raise ImageError(
            f"a part of shape {pixels.shape} was given for a box of {box.height} by {box.width} "
            "pixels: give (rows, columns) of that size"
        )
    if stored.kind in "iu" and pixels.dtype.kind == "f":
        # GDAL cuts fractions off: half a step darker in the mean.
        pixels = np.rint(pixels)
    _require_values(pixels, stored)
    return pixels[np.newaxis]


def _require_values(pixels: NDArray[Any], stored: np.dtype[Any]) -> None:
    """Refuse values that would become infinite, or others, in the type that is written."""
    if np.can_cast(pixels.dtype, stored) or {pixels.dtype.kind, stored.kind} - set("iuf"):
        return
    known = pixels[np.isfinite(pixels)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 0.0)
    limits = np.finfo(stored) if stored.kind == "f" else np.iinfo(stored)
    missing = stored.kind != "f" and known.size < pixels.size
    if missing or low < limits.min or high > limits.max:
        raise ImageError(
            f"values from {low:g} to {high:g}{' and NaN' if missing else ''} do not fit "
            f"{stored.name}, which holds {float(limits.min):g} to {float(limits.max):g}: "
            "scale them, or give another type (dtype)"
        )


def _as_bands(array: NDArray[Any]) -> NDArray[Any]:
    """The array with its bands first."""
    bands = array[np.newaxis] if array.ndim == 2 else array
    if bands.ndim != 3 or bands.size == 0 or bands.dtype.kind not in "iuf":
        raise ImageError(
            f"an array of shape {array.shape} and type {array.dtype} cannot be written as an "
            "image: give integers or floats as (rows, columns) or (bands, rows, columns)"
        )
    return bands
