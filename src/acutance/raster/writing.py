"""Writing images as GeoTIFF."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.errors import ImageError
from acutance.raster.gsd import Gsd

__all__ = ["write_geotiff"]

_TILE_PX = 256


def write_geotiff(
    path: str | os.PathLike[str],
    array: ArrayLike,
    *,
    transform: tuple[float, float, float, float, float, float] | None = None,
    crs: str | None = None,
    nodata: float | None = None,
    gsd_m: float | Gsd | None = None,
) -> None:
    """Write an image as a tiled, compressed GeoTIFF, whole or not at all.

    The file is written under another name in the same folder and renamed when it is complete.

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
        image that has no CRS to derive it from.

    Raises
    ------
    ImageError
        If the array is no image, or the file cannot be written.
    OptionError
        If the GSD is not a positive number.
    """
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import RasterioError
    from rasterio.transform import Affine

    from acutance.raster.dataset import GSD_TAGS, open_quietly

    target = Path(path)
    bands = _as_bands(np.asarray(array))
    gsd = Gsd.given(gsd_m)
    profile = {
        "driver": "GTiff",
        "count": bands.shape[0],
        "height": bands.shape[1],
        "width": bands.shape[2],
        "dtype": bands.dtype.name,
        "nodata": nodata,
        "crs": crs,
        "transform": None if transform is None else Affine(*transform),
        "tiled": True,
        "blockxsize": _TILE_PX,
        "blockysize": _TILE_PX,
        "compress": "deflate",
        "predictor": 3 if bands.dtype.kind == "f" else 2,
        "bigtiff": "if_safer",
    }
    try:
        with tempfile.TemporaryDirectory(prefix=".acutance-", dir=target.parent) as folder:
            partial = os.path.join(folder, "image.tif")
            with open_quietly(partial, "w", **profile) as dataset:
                dataset.write(bands)
                if gsd is not None:
                    values = (repr(gsd.row_m), repr(gsd.col_m))
                    dataset.update_tags(**dict(zip(GSD_TAGS, values, strict=True)))
            os.replace(partial, target)
    except (RasterioError, CPLE_BaseError, OSError, ValueError, TypeError) as error:
        raise ImageError(
            f"{target} cannot be written ({error.__cause__ or error}): check that the folder "
            f"exists and may be written to, and that GeoTIFF has the type {bands.dtype.name}"
        ) from error


def _as_bands(array: NDArray[Any]) -> NDArray[Any]:
    """The array with its bands first."""
    bands = array[np.newaxis] if array.ndim == 2 else array
    if bands.ndim != 3 or bands.size == 0 or bands.dtype.kind not in "iuf":
        raise ImageError(
            f"an array of shape {array.shape} and type {array.dtype} cannot be written as an "
            "image: give integers or floats as (rows, columns) or (bands, rows, columns)"
        )
    return bands
