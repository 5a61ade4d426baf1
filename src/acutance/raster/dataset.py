"""Reading raster files through rasterio, a window at a time.

Loaded when the first such file is opened: a plain array needs no GDAL.
"""

from __future__ import annotations

import os
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
from numpy.typing import NDArray
from rasterio._err import CPLE_BaseError
from rasterio.enums import ColorInterp, MaskFlags
from rasterio.errors import NotGeoreferencedWarning, RasterioError
from rasterio.windows import Window

from acutance.curves.grid import Floats
from acutance.errors import ImageError, OptionError
from acutance.raster.geolocation import Geolocation
from acutance.raster.gsd import GSD_TAGS, Gsd
from acutance.raster.image import Image
from acutance.raster.packed_file import packed_names
from acutance.raster.pixels import equals_nodata, usable_values
from acutance.raster.region import Box
from acutance.raster.restored_tag import restoration_of
from acutance.raster.sensor_model import modelled_gsd

__all__ = [
    "CACHE_BYTES",
    "DatasetPixels",
    "declared_nodata",
    "open_dataset",
    "open_quietly",
    "opened_dataset",
]

CACHE_BYTES = 32 * 2**20
"""GDAL's block cache; its own default is a twentieth of the memory."""

_PACKED_TRIED, _PACKED_NAMED = 20, 5
"""Largest files of a packed file that are opened to find images, and images that are named."""

_DOCUMENTS = (".xml", ".imd", ".dim", ".json", ".txt")
"""Endings of what vendors write beside images."""

_WARNING_FILTERS = threading.Lock()


@dataclass(frozen=True)
class DatasetPixels:
    """One band of a raster file, opened for each reading.

    Parameters
    ----------
    path : str
    band : int
        From 1.
    nodata : float or None
        The stored value of unusable pixels.
    has_mask : bool
        The file carries a mask next to its bands.
    alpha_band : int or None
        The band that is 0 where a pixel is transparent.
    scale, offset : float
        What `read` gives is stored value * scale + offset.
    largest_count : float or None
        The largest stored value, which saturated pixels have; ``None`` for floats.
    """

    path: str
    band: int
    nodata: float | None
    has_mask: bool
    alpha_band: int | None
    scale: float
    offset: float
    largest_count: float | None

    def read(self, box: Box) -> Floats:
        window = Window(box.col, box.row, box.width, box.height)
        with opened_dataset(self.path) as dataset:
            raw: NDArray[Any] = dataset.read(self.band, window=window)
            masked = equals_nodata(raw, self.nodata)
            if self.has_mask:
                masked |= dataset.read_masks(self.band, window=window) == 0
            if self.alpha_band is not None:
                masked |= dataset.read(self.alpha_band, window=window) == 0
        values = usable_values(raw, masked)
        values *= self.scale
        values += self.offset
        return values


def open_dataset(path: str, band: int, gsd: Gsd | None, nodata: float | None) -> Image:
    """One band of a raster file as an image; see `open_image`.

    Raises
    ------
    ImageError
        If no driver reads the file, or the band is absent or cannot be measured.
    """
    with opened_dataset(path) as dataset:
        _require_band(dataset, path, band)
        scale, offset = float(dataset.scales[band - 1]), float(dataset.offsets[band - 1])
        if not (np.isfinite(scale) and np.isfinite(offset) and scale != 0.0):
            raise ImageError(
                f"{path} declares scale {scale:g} and offset {offset:g} for band {band}, which "
                "leave nothing to measure: correct the file's metadata"
            )
        flags = dataset.mask_flag_enums[band - 1]
        level = _largest_count(dataset, band)
        geolocation = _geolocation(dataset)
        declared = _declared_gsd(dataset, geolocation)
        return Image(
            path=path,
            band=band,
            band_count=dataset.count,
            shape=(dataset.height, dataset.width),
            dtype=dataset.dtypes[band - 1],
            source=DatasetPixels(
                path=path,
                band=band,
                nodata=declared_nodata(dataset, band) if nodata is None else nodata,
                has_mask=MaskFlags.per_dataset in flags and MaskFlags.alpha not in flags,
                alpha_band=_alpha_band(dataset, band),
                scale=scale,
                offset=offset,
                largest_count=level,
            ),
            # A negative scale makes the largest count the smallest value: no value is a limit.
            saturation_level=None if level is None or scale < 0 else level * scale + offset,
            geolocation=geolocation,
            own_gsd=declared if gsd is None else gsd,
            declared_gsd=declared,
            restored=restoration_of(dataset.tags(), band),
            modelled_gsd=modelled_gsd(dataset) if geolocation is None else None,
        )


def open_quietly(path: str, mode: str = "r", **profile: Any) -> Any:
    """``rasterio.open`` without its warning of an image that has no geotransform.

    rasterio warns of each; to us it is an ordinary image. The filters of `warnings` belong to the
    whole process, so only one thread at a time changes them.
    """
    with _WARNING_FILTERS, warnings.catch_warnings():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        return rasterio.open(path, mode, **profile)


@contextmanager
def opened_dataset(path: str) -> Iterator[Any]:
    """A dataset open for reading, with a small block cache and errors in our own words."""
    with (
        read_in_our_words(path),
        rasterio.Env(GDAL_CACHEMAX=CACHE_BYTES),
        open_quietly(path) as dataset,
    ):
        yield dataset


@contextmanager
def read_in_our_words(path: str) -> Iterator[None]:
    """What GDAL cannot read, as an error that tells what to do.

    Raises
    ------
    ImageError
        If the file cannot be read in there: what GDAL says, in a sentence.
    """
    try:
        yield
    except (RasterioError, CPLE_BaseError) as error:
        reason = str(error.__cause__ or error)
        raise ImageError(f"{path} cannot be read ({reason}): {_advice(path)}") from error
    except UnicodeEncodeError as error:
        # Linux keeps names as bytes, of any encoding; GDAL takes text alone.
        shown = os.fsencode(path).decode("utf-8", "replace")
        raise ImageError(f"the name {shown} is no UTF-8: rename the file") from error
    except UnicodeDecodeError as error:
        # GDAL reads documents of the same name, too, and quotes what it does not understand.
        raise ImageError(
            f"{path} cannot be read (GDAL's words of it are no UTF-8): a document of metadata "
            f"beside it, such as {Path(path).stem}.xml, may be damaged; move it away, or mend it"
        ) from error


def _advice(path: str) -> str:
    if Path(path).is_dir():
        return "it is a directory; give the image file inside it"
    if Path(path).suffix.lower() == ".npz":
        return "it holds several arrays of NumPy: save the image by itself, with numpy.save"
    if Path(path).suffix.lower() in _DOCUMENTS:
        return (
            "it seems to be a document of metadata: give the image that it is of; acutance image "
            "IMAGE --metadata FILE reads both"
        )
    packed = packed_names(path) if Path(path).is_file() else None
    if packed is not None:
        return _packed_advice(packed)
    return "check that the file is whole and of a format that `rio env --formats` lists"


def _packed_advice(names: tuple[str, ...]) -> str:
    """How to open what a packed file holds; the largest files are the likely images."""
    images = [name for name in names[:_PACKED_TRIED] if _is_image(name)]
    if not images:
        return "no image was found in the packed file; unpack it and give the image file"
    if len(images) == 1:
        return f"it is a packed file; open {images[0]}"
    return f"it is a packed file; open one of {', '.join(images[:_PACKED_NAMED])}"


def _is_image(name: str) -> bool:
    try:
        with open_quietly(name):
            return True
    except (RasterioError, CPLE_BaseError):
        return False


def _require_band(dataset: Any, path: str, band: int) -> None:
    if dataset.count == 0:
        parts = ", ".join(dataset.subdatasets[:12])
        found = f"the images inside are: {parts}" if parts else "it holds no image"
        raise ImageError(f"{path} holds no band of its own; {found}")
    if not 1 <= band <= dataset.count:
        raise ImageError(
            f"band {band} of {path} was requested, but it has {dataset.count}: "
            f"choose a band from 1 to {dataset.count}"
        )
    dtype = dataset.dtypes[band - 1]
    if dtype.startswith("complex"):
        raise ImageError(
            f"band {band} of {path} holds complex values ({dtype}), not real numbers: "
            "write its modulus to a file first"
        )
    if _color_meanings(dataset)[band - 1] == ColorInterp.palette and not _is_grey(dataset, band):
        raise ImageError(
            f"band {band} of {path} holds palette indices, not grey levels: "
            "expand it first, for example with gdal_translate -expand gray"
        )


def _is_grey(dataset: Any, band: int) -> bool:
    """Whether every entry of a palette is the grey of its index, as in BMP without colours."""
    return all(color == (i, i, i, 255) for i, color in dataset.colormap(band).items())


def _color_meanings(dataset: Any) -> tuple[ColorInterp, ...]:
    """What the bands mean in a picture.

    A document beside the image that GDAL could not parse left its error behind, which rasterio
    raises at this question. The image is none the worse: asked again it answers.
    """
    try:
        meanings: tuple[ColorInterp, ...] = dataset.colorinterp
    except CPLE_BaseError:
        meanings = dataset.colorinterp
    return meanings


def _alpha_band(dataset: Any, band: int) -> int | None:
    """The band of transparency, unless it is the one to be measured."""
    for number, meaning in enumerate(_color_meanings(dataset), start=1):
        if meaning == ColorInterp.alpha and number != band:
            return number
    return None


def declared_nodata(dataset: Any, band: int) -> float | None:
    """The nodata value of a band, from 1, of an open file, or of the product (Sentinel-2)."""
    value: float | None = dataset.nodatavals[band - 1]
    return _whole_number(dataset.tags().get("SPECIAL_VALUE_NODATA")) if value is None else value


def _largest_count(dataset: Any, band: int) -> float | None:
    """The largest stored count: declared by the file, or that of its integer type."""
    dtype = np.dtype(dataset.dtypes[band - 1])
    if dtype.kind not in "iu":
        return None
    largest = float(np.iinfo(dtype).max)
    bits = dataset.tags(band, ns="IMAGE_STRUCTURE").get("NBITS")
    depth = _whole_number(bits or dataset.tags().get("NITF_ABPP"))
    saturated = _whole_number(dataset.tags().get("SPECIAL_VALUE_SATURATED"))
    if depth:
        largest = min(largest, 2.0 ** (depth - (dtype.kind == "i")) - 1.0)
    return min(largest, float(saturated)) if saturated else largest


def _whole_number(text: str | None) -> int | None:
    """A metadata item as a number of 0 or more; ``None`` if it is absent or not one."""
    return int(text) if text is not None and text.strip().isdecimal() else None


def _geolocation(dataset: Any) -> Geolocation | None:
    """The affine geotransform, if the image has one and a CRS for it to lead to."""
    if dataset.crs is None or dataset.transform.is_identity:
        return None
    a, b, c, d, e, f = dataset.transform[:6]
    return Geolocation((a, b, c, d, e, f), dataset.crs.to_string())


def _declared_gsd(dataset: Any, geolocation: Geolocation | None) -> Gsd | None:
    """The GSD that `write_geotiff` was given, of an image whose map says none.

    What resamples an image keeps its metadata, and states its new pixels by the map.
    """
    tags = dataset.tags()
    try:
        declared = Gsd(*(float(tags[name]) for name in GSD_TAGS))
    except (KeyError, ValueError, OptionError):
        return None
    middle = (dataset.height - 1) / 2, (dataset.width - 1) / 2
    has_own = geolocation is not None and geolocation.gsd(*middle) is not None
    return None if has_own else declared
