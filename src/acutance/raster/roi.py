"""Regions as a person writes them: four numbers, a box of longitudes, a GeoJSON file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from acutance.arguments import require_kind
from acutance.errors import RegionError
from acutance.raster.coordinates import (
    PIXELS,
    crs_without_declaration,
    lies_in_image,
    to_pixels,
)
from acutance.raster.geojson import declared_crs, load_geojson, polygons
from acutance.raster.geolocation import LONLAT_CRS
from acutance.raster.image import Image, require_image
from acutance.raster.region import Box, Region

__all__ = ["parse_features", "parse_roi", "parse_rois"]

_RECTANGLE = re.compile(r"^\s*-?\d+(\.0*)?\s*(,\s*-?\d+(\.0*)?\s*){3}$")
_NUMBERS = re.compile(r"^[\d\s.,+-]+$")
_NUMBERED = re.compile(r"^(polygon|feature \d+)?( ?(geometry|part) \d+)*$")
"""What the only region of a file is called that was given no name: nothing."""
_FORMS = (
    "write ROW,COL,HEIGHT,WIDTH (pixels), lonlat:WEST,SOUTH,EAST,NORTH (degrees) "
    "or the path of a GeoJSON file"
)

_UNDECLARED_PIXELS = (
    ". The coordinates of {} were read as pixels (x the column, y the row), as neither the file "
    "nor the image has a CRS: if they are longitudes and latitudes, use an image that has one"
)


def parse_roi(text: str, image: Image) -> Region:
    """The one region of a text, in the pixels of an image.

    Parameters
    ----------
    text : str
        As `parse_rois` reads it; a file holds one polygon.
    image : Image

    Returns
    -------
    Region
        With at least one pixel centre inside the image. A polygon may reach beyond it.

    Raises
    ------
    RegionError
        As by `parse_rois`, or if the file has several polygons.
    """
    regions = parse_rois(text, image)
    if len(regions) > 1:
        raise RegionError(
            f"{text} holds {len(regions)} polygons ({', '.join(list(regions)[:10])}), and a region "
            "is one target: keep one polygon in a file, or read them all with parse_rois"
        )
    return next(iter(regions.values()))


def parse_rois(text: str, image: Image) -> dict[str, Region]:
    """All regions of a text, in the pixels of an image, each by its name.

    Parameters
    ----------
    text : str
        One of

        - ``ROW,COL,HEIGHT,WIDTH``: whole pixels, all inside the image; row and column from 0;
        - ``lonlat:WEST,SOUTH,EAST,NORTH``: degrees on WGS 84, carried into the image's CRS;
        - the path of a GeoJSON file of polygons, bare or as Feature, FeatureCollection,
          GeometryCollection or MultiPolygon. Its coordinates are in the CRS of its "crs" member
          (``"crs": "EPSG:32631"``, or the object of the 2008 standard); ``"crs": "pixel"`` means
          pixels. With no such member they are longitude and latitude (RFC 7946) if the image has
          a CRS, and pixels if it has none; degrees that lie outside the image and would lie
          inside as pixels are refused. In pixels x is the column and y the row, from 0, an
          integer being a pixel centre. Corners are carried over and joined by straight lines in
          the image.
    image : Image

    Returns
    -------
    dict of str to Region
        In the order of the file, by the name of each feature (``properties.name``, else ``id``,
        else "feature 2"); other texts name their only region themselves. Features that hold
        something else are passed over. A polygon, and a box in degrees, may reach beyond the
        image: the pixels inside are read. Some of several may lie outside it: to read those is
        refused.

    Raises
    ------
    RegionError
        If the text is none of these, the file has no polygon, its coordinates cannot be related
        to the image, or no region holds any of the image's pixels.
    OptionError
        If it is no text, or there is no image.
    """
    require_kind(str, text=text)
    require_image(image)
    found = parse_features(text, image)
    return {name: one for name, one in found.items() if isinstance(one, Region)}


def parse_features(text: str, image: Image) -> dict[str, Region | str]:
    """The regions of `parse_rois`, and of features without a polygon why they are none.

    Raises
    ------
    RegionError
        As by `parse_rois`.
    """
    if _RECTANGLE.match(text):
        box = Box(*(int(float(number)) for number in text.split(",")))
        box.require_inside(image.shape)
        return {text.strip(): Region.from_box(box)}
    if text.startswith("lonlat:"):
        region = _lonlat_region(text.removeprefix("lonlat:"), image)
        try:
            region.box(image.shape)
        except RegionError as error:
            west, south, east, north = text.removeprefix("lonlat:").split(",")
            swapped = f"{south},{west},{north},{east}"
            if not _is_inside(swapped, image):
                raise
            raise RegionError(
                f"{error}. It lies inside when latitude is read first: longitude comes first, "
                f"write lonlat:{swapped}"
            ) from None
        return {text.strip(): region}
    if not Path(text).is_file():
        found = (
            "not four whole numbers of pixels, rows and columns counted from 0"
            if _NUMBERS.match(text)
            else "neither numbers nor a file that exists"
        )
        raise RegionError(f"the region {text!r} is {found}: {_FORMS}")
    return _geojson_regions(text, image)


def _is_inside(text: str, image: Image) -> bool:
    """Whether a box of longitudes and latitudes holds pixels of an image."""
    try:
        _lonlat_region(text, image).box(image.shape)
    except RegionError:
        return False
    return True


def _lonlat_region(text: str, image: Image) -> Region:
    try:
        west, south, east, north = (float(number) for number in text.split(","))
    except ValueError:
        raise RegionError(f"the region 'lonlat:{text}' is not four numbers: {_FORMS}") from None
    if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
        raise RegionError(
            f"the region 'lonlat:{text}' is no box on the Earth: "
            "give -180 <= WEST < EAST <= 180 and -90 <= SOUTH < NORTH <= 90"
        )
    corners = np.array([[west, north], [east, north], [east, south], [west, south]])
    return Region(to_pixels(corners, LONLAT_CRS, image))


def _geojson_regions(name: str, image: Image) -> dict[str, Region | str]:
    document = load_geojson(name)
    found = polygons(document, name)
    drawn = [rings for rings in found.values() if not isinstance(rings, str)]
    crs = declared_crs(document, name)
    if crs is None:
        meant = crs_without_declaration([rings[0] for rings in drawn], image, name)
    else:
        meant = crs
    regions: dict[str, Region | str] = {}
    outside: dict[str, RegionError] = {}
    reading = _UNDECLARED_PIXELS.format(name) if crs is None and meant == PIXELS else ""
    for label, rings in found.items():
        if isinstance(rings, str):
            regions[label] = f"it has {rings}"
            continue
        of_which = f"{label}: " if len(drawn) > 1 else ""
        try:
            outline, *holes = (to_pixels(ring, meant, image) for ring in rings)
            name_of_it = "" if len(found) == 1 and _NUMBERED.match(label) else label
            region = regions[label] = Region(outline, tuple(holes), name=name_of_it)
        except RegionError as error:
            raise RegionError(f"{of_which}{error}{reading}") from None
        try:
            region.box(image.shape)
        except RegionError as error:
            outside[label] = RegionError(f"{of_which}{error}{reading}")
    if len(outside) == len(drawn):
        first = next(iter(outside.values()))
        outlines = [rings[0] for rings in drawn]
        if meant != PIXELS and lies_in_image(outlines, PIXELS, image):
            raise RegionError(
                f"{first}. Read as pixels (column, row) it lies inside: if pixels are meant, write "
                f'"crs": "pixel" in {name}'
            )
        raise first
    return regions
