"""Read what an image says of itself, from its tags and from the documents beside it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from acutance.arguments import require_paths
from acutance.errors import ImageError, RegionError
from acutance.raster.gsd import Gsd
from acutance.raster.image import Image
from acutance.raster.metadata.documents import read_document
from acutance.raster.metadata.files_beside import files_beside
from acutance.raster.metadata.findings import Findings, Stated, find
from acutance.raster.metadata.gdal_tags import file_tags, read_tags
from acutance.raster.metadata.statement import ImageStatement, state
from acutance.raster.open_image import open_unnamed

__all__ = ["band_names", "band_numbers", "read_statement"]


def read_statement(
    path: str | os.PathLike[str], documents: Sequence[str | os.PathLike[str]] | None = None
) -> ImageStatement:
    """What an image says of itself: sensor, bands, time, angles, GSD and level.

    Sources are the documents beside the image (DIMAP, IMD, MTL, Sentinel-2 MTD, KOMPSAT, Gaofen,
    PlanetScope, STAC item), then the tags of its file; the GSD is that of the geotransform, if
    there is one, and that of RPC or ground control points where nothing else states it. What none
    of them says stays empty, and what they say differently is named.

    Parameters
    ----------
    path : str or path
        An image that `acutance.open_image` opens.
    documents : sequence of paths, optional
        Documents that are about this image, wherever they lie, instead of those beside it.

    Returns
    -------
    ImageStatement

    Raises
    ------
    ImageError
        If the image cannot be read, or a document that was named is not there.
    OptionError
        If the documents are no sequence of paths.
    """
    if documents is not None:
        documents = require_paths("documents", documents)
    image = open_unnamed(path)
    name = Path(str(image.path)).name
    if documents is None:
        of_files = [read_document(one, name) for one in files_beside(str(image.path))]
    else:
        of_files = [read_document(Path(one), name, stated=True) for one in documents]
    tags = read_tags(file_tags(str(image.path)), name)
    sources = _with_time([_of_geolocation(image, name), *of_files, tags, _of_model(image, name)])
    return _for_bands(state(str(image.path), sources, _place(image)), image.band_count)


def band_names(image: Image) -> tuple[str, ...] | None:
    """Names of all bands of an image's file, as of `read_statement`; None where it states none.

    Parameters
    ----------
    image : Image
        One of the bands of a file.
    """
    path = str(image.path)
    try:
        of_files = [read_document(one, Path(path).name) for one in files_beside(path)]
    except OSError:
        # A folder that cannot be listed hides documents, not the image.
        of_files = []
    tags = read_tags(file_tags(path), Path(path).name)
    found = _for_bands(state(path, [*of_files, tags]), image.band_count).bands
    return None if found is None else found.value


def band_numbers(image: Image, bands: Sequence[int | str]) -> list[int]:
    """Numbers of bands that are given by number, or by name in letters of either case.

    Of names that differ by their case alone the one that is written so is meant.

    Parameters
    ----------
    image : Image
        One of the bands of a file.
    bands : sequence of int or str

    Raises
    ------
    ImageError
        If the file has no band of a name, or several.
    """
    names = band_names(image) or ()
    return [_named(one, names, image) if isinstance(one, str) else one for one in bands]


def _named(asked: str, names: Sequence[str], image: Image) -> int:
    """The number of the band of a name."""
    alike = [i for i, name in enumerate(names, 1) if name.casefold() == asked.casefold()]
    found = [i for i in alike if names[i - 1] == asked] or alike
    if not found:
        there = ", ".join(names) or f"{image.band_count}, without names"
        raise ImageError(
            f"band {asked!r:.80} is not the number of a band, from 1 to {image.band_count}, "
            f"nor the name of one: the bands of {image.path} are {there}"
        )
    if len(found) > 1:
        numbers = " and ".join(str(one) for one in found[:3])
        raise ImageError(
            f"band {asked!r:.80} is the name of {len(found)} bands of {image.path}: give a number, "
            f"as {numbers}"
        )
    return found[0]


def _of_geolocation(image: Image, name: str) -> Findings:
    """The GSD in the middle of the image, by its geotransform or as the file declares it."""
    gsd = image.gsd() if image.states_gsd else None
    place = "geotransform" if image.own_gsd is None else "declared GSD"
    return _gsd_found(name, gsd, place)


def _of_model(image: Image, name: str) -> Findings:
    """The GSD in the middle of an image without a geotransform, by its RPC or control points."""
    return _gsd_found(name, image.modelled_gsd, "RPC or ground control points")


def _gsd_found(name: str, gsd: Gsd | None, place: str) -> Findings:
    return find(name, {"gsd_m": (None if gsd is None else (gsd.row_m, gsd.col_m), place)})


def _with_time(sources: list[Findings]) -> list[Findings]:
    """Where the time of the granule is not stated, the beginning of its datatake is the time."""
    if any("acquired" in one.values for one in sources):
        return sources
    for place, one in enumerate(sources):
        if "datatake" in one.values:
            begin: Stated[object] = one.values["datatake"]
            note = f"{begin.source} is when the datatake began, up to some minutes earlier"
            values = {**one.values, "acquired": begin}
            sources[place] = replace(one, values=values, notes=(*one.notes, note))
            break
    return sources


def _place(image: Image) -> tuple[float, float] | None:
    """Longitude and latitude of the middle of the image."""
    if image.geolocation is None:
        return None
    rows, cols = image.shape
    try:
        lon, lat = image.geolocation.to_lonlat((rows - 1) / 2, (cols - 1) / 2)
    except RegionError:
        return None
    return (float(lon), float(lat)) if abs(float(lat)) <= 90.0 else None


def _for_bands(found: ImageStatement, count: int) -> ImageStatement:
    """Names of bands only where there is one for each."""
    if found.bands is None or len(found.bands.value) == count:
        return found
    names = ", ".join(found.bands.value)
    note = (
        f"{found.bands.source} names {len(found.bands.value)} bands ({names}), and the image has "
        f"{count}: names are left out"
    )
    return replace(found, bands=None, notes=(*found.notes, note))
