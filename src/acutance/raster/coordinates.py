"""From coordinates in a file to pixels of an image, and what they mean where the file is silent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.raster.geolocation import LONLAT_CRS
from acutance.raster.image import Image

__all__ = ["PIXELS", "crs_without_declaration", "lies_in_image", "to_pixels"]

PIXELS = "pixel"
"""The "crs" of coordinates in pixels: x the column, y the row, an integer being a centre."""


def to_pixels(points: Floats, crs: str, image: Image) -> Floats:
    """Points (x, y) in a CRS, or in pixels, as (row, col).

    Parameters
    ----------
    points : (n, 2) array
    crs : str
        As rasterio understands it, or "pixel".
    image : Image

    Returns
    -------
    (n, 2) array

    Raises
    ------
    RegionError
        If the image has no CRS, or the points cannot be carried into it.
    """
    if crs.lower() == PIXELS:
        return points[:, ::-1]
    if image.geolocation is None:
        raise RegionError(
            f"the coordinates are in {crs}, but the image has no CRS to find them by: "
            "give them in pixels, ROW,COL,HEIGHT,WIDTH"
        )
    row, col = image.geolocation.from_crs(points[:, 0], points[:, 1], crs)
    if not (np.isfinite(row).all() and np.isfinite(col).all()):
        raise RegionError(
            f"the coordinates cannot be carried from {crs} to the image's CRS: they lie too far "
            "away; choose a place inside the image"
        )
    return np.column_stack([row, image.geolocation.nearest_turn(col, image.shape[1])])


def crs_without_declaration(parts: Sequence[Floats], image: Image, name: str) -> str:
    """What the coordinates of a file mean that declares no CRS.

    Pixels for an image without a CRS; else longitude and latitude (RFC 7946), unless they cannot
    be, or lie outside the image so read and inside it when read as pixels.

    Parameters
    ----------
    parts : sequence of (n, 2) arrays
        Outlines, or single points, as (x, y).
    image : Image
    name : str
        Of the file, for messages.

    Returns
    -------
    str
        "pixel" or the CRS of longitude and latitude.

    Raises
    ------
    RegionError
        If longitude and latitude are not what the file holds, or they are exchanged; the message
        names the reading that lies in the image and how to declare it.
    """
    if image.geolocation is None:
        return PIXELS
    possible = all(_are_degrees(part) for part in parts)
    if possible and lies_in_image(parts, LONLAT_CRS, image):
        return LONLAT_CRS
    x, y = parts[0][0]
    found = f'{name} has no "crs" member, and its first corner {x:.9g}, {y:.9g}'
    as_degrees = (
        "is outside the image when read as longitude and latitude (as RFC 7946 has it)"
        if possible
        else "is no longitude and latitude"
    )
    swapped = [part[:, ::-1] for part in parts]
    if all(map(_are_degrees, swapped)) and lies_in_image(swapped, LONLAT_CRS, image):
        raise RegionError(
            f"{found} {as_degrees} but inside when latitude is read first: longitude comes first, "
            f"write [{y:.9g}, {x:.9g}]"
        )
    if lies_in_image(parts, PIXELS, image):
        raise RegionError(
            f"{found} {as_degrees} but inside when read as pixels (column, row): add "
            '"crs": "pixel" to the file if pixels are meant, "crs": "OGC:CRS84" if degrees are'
        )
    if lies_in_image(parts, image.geolocation.crs, image):
        raise RegionError(
            f"{found} {as_degrees} but inside when read in the image's own CRS: add "
            f'"crs": "{image.geolocation.crs}" to the file'
        )
    if not possible:
        raise RegionError(
            f"{found} {as_degrees}: add the CRS of the coordinates to the file, "
            '"crs": "EPSG:32631", or "crs": "pixel" for column and row'
        )
    return LONLAT_CRS


def _are_degrees(points: Floats) -> bool:
    x, y = np.abs(points).T
    return bool((x <= 180.0).all() and (y <= 90.0).all())


def lies_in_image(parts: Sequence[Floats], crs: str, image: Image) -> bool:
    """Whether the rectangle around any of the parts touches the image.

    Parameters
    ----------
    parts : sequence of (n, 2) arrays
    crs : str
    image : Image
    """
    size = np.array(image.shape)
    for part in parts:
        try:
            places = to_pixels(part, crs, image)
        except RegionError:
            continue
        if (places.max(axis=0) >= -0.5).all() and (places.min(axis=0) < size - 0.5).all():
            return True
    return False
