"""Where pixels lie on the Earth, and how large they are there.

GDAL's geotransform counts from pixel corners, acutance from pixel centres: this module is the
one place with both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_floats, require_kind, require_numbers, require_types
from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.geometry.angles import wrap_direction
from acutance.raster.gsd import Gsd

__all__ = [
    "LONLAT_CRS",
    "Geolocation",
    "ground_gsd",
    "is_geographic",
    "require_known_crs",
    "transform_points",
]

LONLAT_CRS = "OGC:CRS84"

_MAP_DISTORTION = 0.01
"""Share by which a map's lengths may differ from the ground's before the ground's are used."""

_WGS84_RADIUS_M = 6378137.0
_WGS84_ECCENTRICITY2 = 6.69437999014e-3


@dataclass(frozen=True)
class Geolocation:
    """The affine geotransform of an image and the CRS it leads to.

    Parameters
    ----------
    transform : tuple of 6 floats
        (a, b, c, d, e, f): map x = a col + b row + c and y = d col + e row + f, where col and row
        count from the outer corner of the first pixel, as rasterio's ``Affine`` has them.
    crs : str
        The coordinate reference system as rasterio understands it: "EPSG:32631", WKT.

    Raises
    ------
    OptionError
        If the transform is no tuple of 6 numbers, or the CRS no text.
    """

    transform: tuple[float, float, float, float, float, float]
    crs: str

    def __post_init__(self) -> None:
        require_types(self)

    def to_map(self, row: ArrayLike, col: ArrayLike) -> tuple[Floats, Floats]:
        """Map coordinates (x, y) of pixel positions; integers are pixel centres."""
        a, b, c, d, e, f = self.transform
        along = require_floats("col", col) + 0.5
        down = require_floats("row", row) + 0.5
        return a * along + b * down + c, d * along + e * down + f

    def from_map(self, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
        """Pixel positions (row, col) of map coordinates; integers are pixel centres.

        Raises
        ------
        RegionError
            If the geotransform has no inverse.
        """
        a, b, c, d, e, f = self.transform
        determinant = a * e - b * d
        if determinant == 0.0:
            raise RegionError(
                f"the image's geotransform {self.transform} cannot be inverted: "
                "give the region in pixels, ROW,COL,HEIGHT,WIDTH"
            )
        east = require_floats("x", x) - c
        north = require_floats("y", y) - f
        row = (a * north - d * east) / determinant - 0.5
        return row, (e * east - b * north) / determinant - 0.5

    def to_lonlat(self, row: ArrayLike, col: ArrayLike) -> tuple[Floats, Floats]:
        """Longitude and latitude in degrees (WGS 84) of pixel positions.

        Raises
        ------
        RegionError
            If the CRS has no known relation to longitude and latitude.
        """
        return transform_points(*self.to_map(row, col), self.crs, LONLAT_CRS)

    def from_lonlat(self, lon_deg: ArrayLike, lat_deg: ArrayLike) -> tuple[Floats, Floats]:
        """Pixel positions (row, col) of longitudes and latitudes in degrees (WGS 84).

        Raises
        ------
        RegionError
            If the CRS has no known relation to longitude and latitude.
        """
        return self.from_crs(lon_deg, lat_deg, LONLAT_CRS)

    def from_crs(self, x: ArrayLike, y: ArrayLike, crs: str) -> tuple[Floats, Floats]:
        """Pixel positions (row, col) of coordinates in any CRS.

        Parameters
        ----------
        x, y : array_like
            Easting and northing, or longitude and latitude: x comes first whatever axis order
            the authority gives.
        crs : str
            As rasterio understands it.

        Raises
        ------
        RegionError
            If the CRS is unknown or cannot be related to the image's.
        """
        return self.from_map(*transform_points(x, y, crs, self.crs))

    def nearest_turn(self, col: ArrayLike, width: int) -> Floats:
        """Columns of an image of a width in degrees, on the turn of the Earth on which it lies.

        Longitudes of 179.9 and -180.1 degrees are one place, and 360 degrees of columns apart.
        """
        cols = np.asarray(col, dtype=np.float64)
        step, shear = self.transform[:2]
        if step == 0.0 or shear != 0.0 or not is_geographic(self.crs):
            return cols
        turn_px = 360.0 / abs(step)
        return np.asarray(cols - np.round((cols - (width - 1) / 2) / turn_px) * turn_px)

    def gsd(self, row: float, col: float) -> Gsd | None:
        """Ground sampling distance at a pixel.

        The lengths of the geotransform's two column vectors, so a rotated image has the GSD of
        its own rows and columns. Projected CRS: in metres whatever its unit, as the map has them,
        so that a 30 m product has 30 m; where the map's scale is off by more than 1 % (Web
        Mercator, the far side of a zone), as the ground has them. Geographic CRS: at the pixel's
        latitude.

        Returns
        -------
        Gsd or None
            ``None`` if the CRS defines no length, or the place has none.

        Raises
        ------
        OptionError
            If the place is no pair of numbers.
        """
        require_numbers(row=row, col=col)
        on_map = self._gsd_on_map()
        on_ground = ground_gsd(self.to_lonlat, row, col)
        if on_map is None or on_ground is None:
            return on_map or on_ground
        distortion = max(
            abs(on_map.row_m / on_ground.row_m - 1.0), abs(on_map.col_m / on_ground.col_m - 1.0)
        )
        return on_map if distortion <= _MAP_DISTORTION else on_ground

    def _gsd_on_map(self) -> Gsd | None:
        """Lengths of the geotransform's vectors in the metres of a CRS that counts lengths."""
        crs = _parse_crs(self.crs)
        if crs.is_geographic:
            return None
        unit, metres = crs.units_factor
        if unit == "unknown":
            return None
        a, b, _, d, e, _ = self.transform
        return _gsd_or_none(math.hypot(b, e) * metres, math.hypot(a, d) * metres)


def ground_gsd(
    to_lonlat: Callable[[ArrayLike, ArrayLike], tuple[Floats, Floats]], row: float, col: float
) -> Gsd | None:
    """Lengths on the WGS 84 ellipsoid of one pixel's steps, by central difference.

    Parameters
    ----------
    to_lonlat : function of (rows, cols)
        Longitudes and latitudes in degrees.
    row, col : float

    Returns
    -------
    Gsd or None
        ``None`` where the place has no longitude and latitude.
    """
    rows = np.array([row - 0.5, row + 0.5, row, row])
    cols = np.array([col, col, col - 0.5, col + 0.5])
    try:
        lon, lat = to_lonlat(rows, cols)
    except RegionError:
        return None
    if not (np.isfinite(lon).all() and np.isfinite(lat).all() and abs(lat).max() <= 90.0):
        return None
    latitude = math.radians(float(lat.mean()))
    squashed = 1.0 - _WGS84_ECCENTRICITY2 * math.sin(latitude) ** 2
    to_north = _WGS84_RADIUS_M * (1.0 - _WGS84_ECCENTRICITY2) / squashed**1.5
    to_east = _WGS84_RADIUS_M / math.sqrt(squashed) * math.cos(latitude)
    turn_deg: Floats = wrap_direction(lon[1::2] - lon[::2])
    step_deg = np.hypot(to_east * turn_deg, to_north * (lat[1::2] - lat[::2]))
    step_m = np.radians(step_deg)
    return _gsd_or_none(float(step_m[0]), float(step_m[1]))


def transform_points(
    x: ArrayLike, y: ArrayLike, source_crs: str, target_crs: str
) -> tuple[Floats, Floats]:
    """Coordinates of points in another CRS.

    Parameters
    ----------
    x, y : array_like
        Same shape; easting or longitude comes first.
    source_crs, target_crs : str
        As rasterio understands them.

    Returns
    -------
    x, y : arrays of the shape given

    Raises
    ------
    RegionError
        If a CRS is unknown, or the two cannot be related.
    """
    from rasterio._err import CPLE_BaseError
    from rasterio.warp import transform

    xs, ys = np.broadcast_arrays(require_floats("x", x), require_floats("y", y))
    source, target = _parse_crs(source_crs), _parse_crs(target_crs)
    try:
        moved = transform(source, target, xs.ravel().tolist(), ys.ravel().tolist())
    except (CPLE_BaseError, ValueError) as error:
        raise RegionError(
            f"coordinates cannot be carried from {_short(source_crs)} to {_short(target_crs)} "
            f"({str(error)[:120]}): give the region in pixels, ROW,COL,HEIGHT,WIDTH"
        ) from error
    return np.reshape(moved[0], xs.shape), np.reshape(moved[1], xs.shape)


def require_known_crs(crs: str) -> None:
    """Refuse a CRS that is not known.

    Raises
    ------
    RegionError
        Names it.
    """
    _parse_crs(crs)


def is_geographic(crs: str) -> bool:
    """Whether the coordinates of a CRS are longitude and latitude.

    Raises
    ------
    RegionError
        If the CRS is unknown.
    """
    return bool(_parse_crs(crs).is_geographic)


def _parse_crs(crs: str) -> Any:
    from rasterio import Env
    from rasterio.crs import CRS

    require_kind(str, crs=crs)
    try:
        # Outside of an Env GDAL prints its errors by itself.
        with Env():
            return CRS.from_user_input(crs)
    except ValueError as error:
        raise RegionError(
            f"the coordinate reference system {_short(crs)!r} is not known ({error}): "
            'write it as "EPSG:32631", or "pixel" for pixel coordinates'
        ) from error


def _gsd_or_none(row_m: float, col_m: float) -> Gsd | None:
    lengths = (row_m, col_m)
    usable = all(math.isfinite(length) and length > 0.0 for length in lengths)
    return Gsd(row_m, col_m) if usable else None


def _short(crs: str) -> str:
    return crs if len(crs) <= 60 else crs[:57] + "..."
