"""The options that say which pixels are meant, shared by every measuring command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.raster import Gsd, Image, Region
    from acutance.raster.image import AlongTrack

__all__ = [
    "AlongTrackOption",
    "BandOption",
    "GsdOption",
    "ImageArgument",
    "NodataOption",
    "RoiOption",
    "SiteOption",
    "open_target",
    "parse_gsd",
]

_AXES: dict[str, AlongTrack] = {"x": "x", "y": "y"}

ImageArgument = Annotated[
    str, typer.Argument(metavar="IMAGE", help="Any raster GDAL reads, or a .npy array.")
]
RoiOption = Annotated[
    str | None,
    typer.Option(
        metavar="ROI",
        help="Region: ROW,COL,HEIGHT,WIDTH in pixels, lonlat:WEST,SOUTH,EAST,NORTH in degrees, "
        "or a GeoJSON file. The whole image without it.",
    ),
]
SiteOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="Region: a known site (see acutance sites).")
]
BandOption = Annotated[int, typer.Option(metavar="N", help="Which band, from 1.")]
GsdOption = Annotated[
    str | None,
    typer.Option(
        metavar="M",
        help="Ground sampling distance in metres, or ROW,COL distances where they differ. "
        "That of the file without it.",
    ),
]
NodataOption = Annotated[
    float | None,
    typer.Option(
        metavar="VALUE", help="The stored value of unusable pixels; that of the file without it."
    ),
]

AlongTrackOption = Annotated[
    str,
    typer.Option(metavar="x|y", help="The image axis along track: y, down the columns, or x."),
]


def parse_gsd(text: str | None) -> float | Gsd | None:
    """The value of ``--gsd``: one number, or the spacing of rows and that of columns.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if text is None:
        return None
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2):
        raise OptionError(
            f"--gsd {text} is not a distance: write metres (0.7), or those between rows and "
            "between columns (0.72,0.70)"
        )
    if len(numbers) == 1:
        return numbers[0]
    from acutance.raster import Gsd

    return Gsd(*numbers)


def open_target(
    path: str,
    *,
    band: int,
    gsd: str | None,
    roi: str | None,
    site: str | None,
    nodata: float | None = None,
    along_track: str = "y",
) -> tuple[Image, Region | None]:
    """Open the image and find the region the options ask for.

    Raises
    ------
    OptionError, ImageError, RegionError
        If the options contradict each other, or the image or the region cannot be had.
    """
    if roi is not None and site is not None:
        raise OptionError("--roi and --site both name a region: give one of them")
    if along_track not in _AXES:
        raise OptionError(f"--along-track {along_track}: it has to be x or y")
    gsd_m = parse_gsd(gsd)
    from acutance.raster import find_site, open_image, parse_roi, site_region

    place = None if site is None else find_site(site)
    image = open_image(path, band, gsd_m, nodata, along_track=_AXES[along_track])
    if place is not None:
        return image, site_region(place, image)
    return image, None if roi is None else parse_roi(roi, image)
