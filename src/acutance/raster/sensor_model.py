"""Where the ground lies in an image that has no geotransform: by its RPC or ground control points.

RPC are the rational polynomial coefficients a vendor gives with an image in sensor geometry.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import OptionError, RegionError
from acutance.raster.geolocation import LONLAT_CRS, Geolocation, ground_gsd, transform_points
from acutance.raster.gsd import Gsd
from acutance.raster.image import Image
from acutance.raster.pixels import is_npy

__all__ = ["SensorModel", "georeference_of", "modelled_gsd"]

ControlPoint = tuple[float, float, float, float, float]
"""Row and column from the outer corner, x, y, height."""


@dataclass(frozen=True)
class SensorModel:
    """Where the ground lies in an image, at a height.

    Parameters
    ----------
    crs : str
        Of the model: longitude and latitude of RPC, that of the points otherwise.
    rpc : object or None
        As rasterio has them.
    control_points : tuple of (row, col, x, y, height)
        Used where there are no RPC.
    height_m : float or None
        Of the ground above the ellipsoid. RPC need it: a view from the side moves by its tangent.
    """

    crs: str
    rpc: Any = None
    control_points: tuple[ControlPoint, ...] = ()
    height_m: float | None = None

    @property
    def needs_height(self) -> bool:
        """Whether it has no answer because the height of the ground is not known."""
        return self.rpc is not None and self.height_m is None

    @property
    def at_extremes(self) -> tuple[SensorModel, SensorModel]:
        """The model for the lowest and the highest ground that its RPC are made for."""
        low = self.rpc.height_off - self.rpc.height_scale
        high = self.rpc.height_off + self.rpc.height_scale
        return replace(self, height_m=low), replace(self, height_m=high)

    def from_crs(self, x: ArrayLike, y: ArrayLike, crs: str) -> tuple[Floats, Floats]:
        """Pixel positions (row, col) of coordinates in any CRS; integers are pixel centres.

        Raises
        ------
        RegionError
            If the height is not known, or the coordinates cannot be carried into the image.
        """
        east, north = transform_points(x, y, crs, self.crs)
        with self._transformer() as transformer:
            row, col = transformer.rowcol(
                east.ravel().tolist(), north.ravel().tolist(), op=np.asarray
            )
        shape = np.shape(east)
        return np.reshape(row, shape) - 0.5, np.reshape(col, shape) - 0.5

    def to_lonlat(self, row: ArrayLike, col: ArrayLike) -> tuple[Floats, Floats]:
        """Longitude and latitude in degrees (WGS 84) of pixel positions.

        Raises
        ------
        RegionError
            If the height is not known, or the model has no answer there.
        """
        rows, cols = np.broadcast_arrays(np.asarray(row, float), np.asarray(col, float))
        with self._transformer() as transformer:
            x, y = transformer.xy(rows.ravel().tolist(), cols.ravel().tolist(), offset="center")
        x, y = np.reshape(x, rows.shape), np.reshape(y, rows.shape)
        return transform_points(x, y, self.crs, LONLAT_CRS)

    def gsd(self, row: float, col: float) -> Gsd | None:
        """Ground sampling distance at a pixel, on ground of the stated height."""
        return ground_gsd(self.to_lonlat, row, col)

    @contextmanager
    def _transformer(self) -> Iterator[Any]:
        from rasterio._err import CPLE_BaseError
        from rasterio.control import GroundControlPoint
        from rasterio.errors import RasterioError
        from rasterio.transform import GCPTransformer, RPCTransformer

        if self.needs_height:
            raise RegionError(
                "the image is located by RPC, which need the height of the ground: give the "
                "target's height above the ellipsoid (height_m)"
            )
        try:
            if self.rpc is not None:
                with RPCTransformer(self.rpc, rpc_height=self.height_m) as found:
                    yield found
            else:
                points = [
                    GroundControlPoint(row, col, x, y, z)
                    for row, col, x, y, z in self.control_points
                ]
                with GCPTransformer(points) as found:
                    yield found
        except (CPLE_BaseError, RasterioError, ValueError) as error:
            raise RegionError(
                f"coordinates cannot be carried by the image's sensor model ({str(error)[:120]}): "
                "give the target in pixels"
            ) from error


def georeference_of(
    image: Image, height_m: float | None = None
) -> Geolocation | SensorModel | None:
    """The geotransform of an image; without one its sensor model, for ground of a height.

    Parameters
    ----------
    image : Image
    height_m : float, optional
        Above the ellipsoid.

    Returns
    -------
    Geolocation, SensorModel or None
        ``None`` if the file has neither a geotransform with a CRS, RPC nor ground control points.

    Raises
    ------
    ImageError
        If the file cannot be read.
    """
    if image.geolocation is not None or image.path is None or is_npy(image.path):
        return image.geolocation
    from acutance.raster.dataset import opened_dataset

    with opened_dataset(image.path) as dataset:
        model = _model_of(dataset)
    return None if model is None else replace(model, height_m=height_m)


def modelled_gsd(dataset: Any) -> Gsd | None:
    """The GSD in the middle of an open file by its sensor model, on ground of the middle height.

    Half a kilometre of height is a thousandth of what a satellite sees: no other height is needed.

    Returns
    -------
    Gsd or None
        ``None`` without a sensor model, or if it has no answer there that could be an image's.
    """
    model = _model_of(dataset)
    if model is None:
        return None
    if model.rpc is not None:
        model = replace(model, height_m=model.rpc.height_off)
    found = model.gsd((dataset.height - 1) / 2, (dataset.width - 1) / 2)
    try:
        return None if found is None else found.required_in_range()
    except OptionError:
        return None


def _model_of(dataset: Any) -> SensorModel | None:
    points, crs = dataset.gcps
    if dataset.rpcs is not None:
        return SensorModel(LONLAT_CRS, rpc=dataset.rpcs)
    if len(points) >= 3 and crs is not None:
        known = tuple((p.row, p.col, p.x, p.y, p.z or 0.0) for p in points)
        return SensorModel(crs.to_string(), control_points=known)
    return None
