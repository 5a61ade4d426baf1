"""Opening an image file: a NumPy file as it is, all others by GDAL's drivers."""

from __future__ import annotations

import operator
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from acutance.arguments import require_all
from acutance.errors import ImageError, OptionError
from acutance.raster.gsd import Gsd
from acutance.raster.image import AlongTrack, Image
from acutance.raster.linearization import LinearizeLike
from acutance.raster.nearest_name import nearest_name
from acutance.raster.pixels import (
    NpyPixels,
    is_nan,
    is_npy,
    largest_count,
    require_image_array,
    require_nodata,
    type_name,
)

__all__ = ["open_bands", "open_image", "open_unnamed"]

# Names that GDAL understands and the file system does not: "/vsizip/a.zip/b.tif",
# "https://host/a.tif", "HDF5:a.h5://band". One letter and a colon is a Windows drive.
_GDAL_NAME = re.compile(r"^(/vsi\w+/|\w+://|[A-Za-z0-9_]{2,}:)")


def open_image(
    path: str | os.PathLike[str],
    band: int | str = 1,
    gsd_m: float | Gsd | None = None,
    nodata: float | None = None,
    along_track: AlongTrack = "y",
    linearize: LinearizeLike = None,
) -> Image:
    """Open one band of an image file.

    Parameters
    ----------
    path : str or path
        Any raster that GDAL reads in rasterio's wheel (GeoTIFF, COG, JPEG 2000, NITF, HDF5,
        DIMAP, SAFE, TIFF, PNG, JPEG), a name of GDAL's own ("HDF5:file.h5://band",
        "/vsizip/a.zip/b.tif"), or a 2-D array in a ``.npy`` file.
    band : int or str
        Which band: its number, from 1, or its name as `read_statement` finds it.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres; it replaces the one of the geotransform.
    nodata : float, optional
        The stored value of unusable pixels; it replaces the one the file declares. Masks and
        alpha bands still apply. NaN: every value is data, also a constant beyond a swath's border.
    along_track : {"y", "x"}, optional
        The axis along track, after which results are called across and along: y, down the
        columns, unless the image was turned.
    linearize : str, float, Characteristic or None, optional
        The characteristic curve of the stored values, if they are not proportional to light: see
        `Image.linearized`.

    Returns
    -------
    Image

    Raises
    ------
    ImageError
        If the file is missing, empty, damaged, a directory without an image, of a kind that
        cannot be measured (complex, palette), or has no such band.
    OptionError
        If the GSD is not a positive number, the nodata value no number, or there is no such curve.
    """
    (number,) = _numbers(path, [band])
    (found,) = _named([open_unnamed(path, number, gsd_m, nodata, along_track, linearize)])
    return found


def open_unnamed(
    path: str | os.PathLike[str],
    band: int = 1,
    gsd_m: float | Gsd | None = None,
    nodata: float | None = None,
    along_track: AlongTrack = "y",
    linearize: LinearizeLike = None,
) -> Image:
    """The image of `open_image` without the name of its band, for which documents are read.

    Parameters
    ----------
    path, band, gsd_m, nodata, along_track, linearize : optional
        As of `open_image`.
    """
    gsd = Gsd.given(gsd_m)
    require_nodata(nodata)
    name = _as_name(path)
    band = _as_number(band, name)
    _require_file(name)
    if is_npy(name):
        opened = _open_npy(name, band, gsd, nodata)
    else:
        from acutance.raster.dataset import open_dataset

        opened = open_dataset(name, band, gsd, nodata)
    opened = replace(
        opened,
        along_track=along_track,
        every_value_is_data=is_nan(nodata),
        stated_nodata=None if nodata is None else float(nodata),
    )
    return opened.linearized(linearize)


def open_bands(
    path: str | os.PathLike[str],
    bands: Sequence[int | str] | None = None,
    gsd_m: float | Gsd | None = None,
    nodata: float | None = None,
    along_track: AlongTrack = "y",
    linearize: LinearizeLike = None,
) -> tuple[Image, ...]:
    """Open several bands of an image file.

    Parameters
    ----------
    path : str or path
    bands : sequence of (int or str), optional
        Numbers, from 1, or names, each band once; without it all but a band of transparency.
    gsd_m, nodata, along_track, linearize : optional
        As of `open_image`, the same for all bands.

    Raises
    ------
    ImageError
        As of `open_image`.
    OptionError
        If no band is asked for, or one twice.
    """
    if isinstance(bands, str | bytes) or not isinstance(bands, Iterable | None):
        raise OptionError(f"bands are {bands!r:.80}: give a list of numbers, from 1, or of names")
    if bands is not None:
        bands = require_all((Integral, str), "bands", bands)
    numbers = _all_bands(open_unnamed(path)) if bands is None else _numbers(path, bands)
    if not numbers:
        raise OptionError("no band is asked for: give numbers, from 1, or leave bands out for all")
    if len(set(numbers)) < len(numbers):
        raise OptionError(f"bands are {numbers}: give the number of every band once")
    found = [open_unnamed(path, one, gsd_m, nodata, along_track, linearize) for one in numbers]
    return tuple(_named(found))


def _numbers(path: str | os.PathLike[str], bands: Sequence[int | str]) -> list[int]:
    """Numbers of bands; documents are read for names alone."""
    # What is no number at all is refused where the band is opened.
    if not any(isinstance(one, str) for one in bands):
        return list(bands)  # type: ignore[arg-type]
    from acutance.raster.metadata.read_statement import band_numbers

    return band_numbers(open_unnamed(path), bands)


def _named(images: Sequence[Image]) -> list[Image]:
    """Bands of one file with their names, as the file or the documents beside it state them."""
    from acutance.raster.metadata.read_statement import band_names

    names = band_names(images[0])
    return [replace(one, band_name=names[one.band - 1] if names else None) for one in images]


def _all_bands(first: Image) -> list[int]:
    """The bands of a file but that of transparency."""
    transparent = getattr(first.source, "alpha_band", None)
    return [one for one in range(1, first.band_count + 1) if one != transparent]


def _as_name(path: Any) -> str:
    """The name of a file as text."""
    try:
        name = os.fspath(path)
    except TypeError:
        raise ImageError(
            f"open_image was given a {type(path).__name__}: give the name of a file; an array is "
            "measured as it is, or made an image by Image.from_array"
        ) from None
    return os.fsdecode(name)


def _as_number(band: Any, name: str) -> int:
    """The number of a band, whatever kind of integer it was given as."""
    try:
        return operator.index(band)
    except TypeError:
        raise ImageError(
            f"band {band!r:.80} of {name} was requested: give its number, from 1, or its name"
        ) from None


def _open_npy(path: str, band: int, gsd: Gsd | None, nodata: float | None) -> Image:
    try:
        path.encode()
    except UnicodeEncodeError as error:
        # As of a file that GDAL reads: no document and no archive takes such a name.
        shown = os.fsencode(path).decode("utf-8", "replace")
        raise ImageError(f"the name {shown} is no UTF-8: rename the file") from error
    source = NpyPixels(path, nodata)
    array: NDArray[Any] = source.map()
    require_image_array(array, path)
    if band != 1:
        raise ImageError(f"{path} has one band, band {band} was requested: use band 1")
    return Image(
        path=path,
        band=1,
        band_count=1,
        shape=(int(array.shape[0]), int(array.shape[1])),
        dtype=type_name(array.dtype),
        source=source,
        saturation_level=largest_count(array.dtype),
        own_gsd=gsd,
    )


def _require_file(name: str) -> None:
    """Check what the file system shows before a driver opens the file."""
    # To the file system no name at all is the folder one stands in.
    if not name.strip():
        raise ImageError("the name of the image is empty: give the path of a file")
    path = Path(name)
    try:
        is_file, is_folder = path.is_file(), path.is_dir()
        is_empty = is_file and path.stat().st_size == 0
    except OSError as error:
        raise ImageError(f"{name} cannot be reached ({error.strerror}): check the path") from error
    if is_empty:
        raise ImageError(f"{name} is empty (0 bytes): write or copy it again")
    if not is_file and not is_folder and path.is_symlink():
        raise ImageError(
            f"{name} does not exist (it is a link to {os.readlink(path)}): correct the link"
        )
    if not is_file and not is_folder and not _GDAL_NAME.match(name):
        found = "its folder exists" if path.parent.is_dir() else "nor does its folder"
        near = nearest_name(path)
        advice = "check the path" if near is None else f"is {path.with_name(near)} meant?"
        raise ImageError(f"{name} does not exist ({found}): {advice}")
