"""Places of point sources as a person writes them: CSV or GeoJSON, in pixels or on the map."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from acutance.arguments import require_path
from acutance.curves.grid import Floats
from acutance.errors import RegionError
from acutance.raster.coordinates import PIXELS, crs_without_declaration, to_pixels
from acutance.raster.geojson import declared_crs, load_geojson, points
from acutance.raster.geolocation import LONLAT_CRS
from acutance.raster.image import Image, require_image

__all__ = ["read_positions"]

_TRUTH = "acutance/truth/1"

_COLUMNS = {
    PIXELS: (("row", "col"), ("row", "column"), ("y_px", "x_px")),
    "map": (("y", "x"), ("northing", "easting"), ("north", "east")),
    "lonlat": (("lat", "lon"), ("latitude", "longitude")),
}


def read_positions(path: str, image: Image) -> Floats:
    """Places as (row, col) in the pixels of an image, (n, 2), in the order of the file.

    Parameters
    ----------
    path : str
        One of

        - a CSV file with a header that names two columns: ``row,col`` (pixels, integers being
          pixel centres), ``lon,lat`` (degrees on WGS 84) or ``x,y``, ``easting,northing`` (the
          image's own map); a file without a header holds row and column. Other columns are
          ignored;
        - a GeoJSON file of Points (or MultiPoints). Its coordinates are in the CRS of its "crs"
          member; "pixel" there means pixels (x the column, y the row). With no such member they
          are longitude and latitude if the image has a CRS, and pixels if not; degrees that lie
          outside the image and would lie inside as pixels are refused;
        - the truth that `acutance simulate points` writes beside its image.
    image : Image

    Returns
    -------
    (n, 2) array

    Raises
    ------
    RegionError
        If the file is neither, holds no places, or they cannot be related to the image.
    OptionError
        If it is no path, or there is no image.
    """
    require_path(path=path)
    require_image(image)
    name = Path(path)
    if not name.is_file():
        raise RegionError(f"{path}: there is no such file; positions come as .csv or .geojson")
    try:
        text = name.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise RegionError(f"{path} cannot be read as text: give a .csv or .geojson file") from error
    if text.lstrip().startswith("{"):
        places = _of_geojson(path, image)
    else:
        places = _of_csv(path, text, image)
    if places.shape[0] == 0:
        raise RegionError(f"{path} holds no positions: write at least one")
    if not np.isfinite(places).all():
        raise RegionError(
            f"{path} holds positions that are not finite, or off the map: remove them"
        )
    return places


def _of_csv(path: str, text: str, image: Image) -> Floats:
    rows = [row for row in csv.reader(text.splitlines()) if any(cell.strip() for cell in row)]
    if not rows:
        return np.empty((0, 2))
    header = [cell.strip().lower() for cell in rows[0]]
    found = _columns(header)
    if found is None:
        if not _are_numbers(rows[0][:2]):
            raise RegionError(
                f"{path} has the columns {', '.join(header)}: name two of them row,col (pixels), "
                "lon,lat (degrees) or x,y (the image's map)"
            )
        kind, places, body = PIXELS, (0, 1), rows
    else:
        (kind, places), body = found, rows[1:]
    numbers = []
    for line, row in enumerate(body, start=len(rows) - len(body) + 1):
        try:
            numbers.append([float(row[place]) for place in places])
        except (ValueError, IndexError) as error:
            raise RegionError(
                f"{path}, line {line}: {','.join(row)} holds no two numbers there: correct it"
            ) from error
    down, right = np.array(numbers).reshape(-1, 2).T
    return _in_pixels(path, kind, right, down, image)


def _columns(header: list[str]) -> tuple[str, tuple[int, int]] | None:
    """What kind of coordinates a header names, and where the vertical and horizontal ones are."""
    for kind, pairs in _COLUMNS.items():
        for down, right in pairs:
            if down in header and right in header:
                return kind, (header.index(down), header.index(right))
    return None


def _are_numbers(cells: list[str]) -> bool:
    try:
        return len([float(cell) for cell in cells]) == 2
    except ValueError:
        return False


def _of_truth(path: str, document: Mapping[str, Any]) -> Floats:
    """Row and column of every source that was simulated."""
    try:
        return np.array(document.get("positions", ()), float).reshape(-1, 2)
    except (TypeError, ValueError) as error:
        raise RegionError(
            f"{path} holds a truth whose positions are no rows and columns: write it again"
        ) from error


def _of_geojson(path: str, image: Image) -> Floats:
    document = load_geojson(path)
    if document.get("schema") == _TRUTH:
        return _of_truth(path, document)
    found = points(document, path)
    if found.shape[0] == 0:
        return found
    crs = declared_crs(document, path)
    if crs is None:
        crs = crs_without_declaration(list(found[:, np.newaxis]), image, path)
    return to_pixels(found, crs, image)


def _in_pixels(path: str, kind: str, right: Floats, down: Floats, image: Image) -> Floats:
    if kind == PIXELS:
        return np.column_stack([down, right])
    if image.geolocation is None:
        raise RegionError(
            f"{path} holds coordinates on the ground, and the image has no CRS: give row and "
            "column in pixels"
        )
    if kind == "map":
        row, col = image.geolocation.from_map(right, down)
        return np.column_stack([row, image.geolocation.nearest_turn(col, image.shape[1])])
    return to_pixels(np.column_stack([right, down]), LONLAT_CRS, image)
