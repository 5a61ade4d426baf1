"""Small raster files, written where a test asks for them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from numpy.typing import NDArray
from rasterio.errors import NotGeoreferencedWarning

from acutance.raster import Image, open_image

WriteRaster = Callable[..., str]


@pytest.fixture
def utm() -> dict[str, Any]:
    """Where an image of 0.5 m pixels lies: zone 31 north, upper left corner 600000, 5000000."""
    return {
        "crs": "EPSG:32631",
        "transform": rasterio.Affine(0.5, 0, 600000, 0, -0.5, 5000000),
    }


@pytest.fixture
def lonlat() -> dict[str, Any]:
    """Where an image of 0.00001 degree pixels lies: upper left corner 5 E 60 N."""
    return {"crs": "EPSG:4326", "transform": rasterio.Affine(1e-5, 0, 5.0, 0, -1e-5, 60.0)}


@pytest.fixture
def pixels() -> NDArray[np.uint16]:
    """40 rows x 50 columns of counts from 1 to 2000: no two are equal."""
    rng = np.random.default_rng(5)
    return rng.permutation(np.arange(1, 2001, dtype=np.uint16)).reshape(40, 50)


@pytest.fixture
def write_raster(tmp_path: Path) -> WriteRaster:
    """Write an array as a raster file of the test's own; returns its path."""

    def write(
        name: str,
        array: NDArray[Any],
        driver: str = "GTiff",
        edit: Callable[[Any], None] | None = None,
        **profile: Any,
    ) -> str:
        bands = array[np.newaxis] if array.ndim == 2 else array
        path = str(tmp_path / name)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(
                path,
                "w",
                driver=driver,
                count=bands.shape[0],
                height=bands.shape[1],
                width=bands.shape[2],
                dtype=bands.dtype.name,
                **profile,
            ) as dataset:
                if edit is not None:
                    edit(dataset)
                dataset.write(bands)
        return path

    return write


@pytest.fixture
def plain() -> Image:
    """40 rows x 50 columns without a place on the ground."""
    return Image.from_array(np.zeros((40, 50)))


@pytest.fixture
def located(pixels: NDArray[np.uint16], write_raster: WriteRaster, utm: dict[str, Any]) -> Image:
    """The same size, in a file of 0.5 m pixels on the map."""
    return open_image(write_raster("located.tif", pixels, **utm))
