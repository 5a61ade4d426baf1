"""``acutance image``: what an image says of itself."""

from __future__ import annotations

import json
from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.options import ImageArgument, JsonOption

if TYPE_CHECKING:
    from acutance.raster import Image
    from acutance.raster.metadata import ImageStatement, Stated

__all__ = ["EXAMPLE", "image"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance image IMG_PHR1A_P_202108271549303_SEN_R1C1.JP2\n"
    "  acutance image scene.tif --metadata LC08_MTL.txt --json"
)

_WORDS = {
    "sensor": "sensor",
    "level": "level",
    "acquired": "acquired",
    "gsd_m": "GSD [m], row and column",
    "view_zenith_deg": "view zenith [deg]",
    "view_azimuth_deg": "view azimuth [deg]",
    "sun_elevation_deg": "sun elevation [deg]",
    "sun_azimuth_deg": "sun azimuth [deg]",
}


def image(
    image: ImageArgument,
    metadata: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE",
            help="Read this document instead of those beside the image; repeatable.",
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Show what an image says of itself: bands, sensor, time, angles, GSD, level, each with its
    source.

    Read are the documents beside it (DIMAP, IMD, MTL, Sentinel-2 MTD, KOMPSAT, Gaofen,
    PlanetScope, STAC item) and its tags. What none of them says stays empty; what they say
    differently is named.
    """
    from acutance.raster.metadata import read_statement
    from acutance.raster.open_image import open_unnamed

    found, pixels = read_statement(image, metadata), open_unnamed(image)
    if as_json:
        shape = {"band_count": pixels.band_count, "shape": list(pixels.shape),
                 "dtype": pixels.dtype}  # fmt: skip
        document = {"schema": "acutance/image/1", **found.to_dict(), **shape}
        typer.echo(json.dumps(document, indent=2, ensure_ascii=False))
    else:
        typer.echo(_text(found, pixels))


def _text(found: ImageStatement, pixels: Image) -> str:
    from acutance.archive.counted import counted

    rows, cols = pixels.shape
    values = {
        "bands": _bands(found, pixels.band_count),
        "pixels": f"{counted(rows, 'row')}, {counted(cols, 'column')}, {pixels.dtype}",
        **{words: _shown(getattr(found, name)) for name, words in _WORDS.items()},
    }
    width = max(map(len, values))
    lines = [f"{words:<{width}}  {value}" for words, value in values.items()]
    lines += [f"contradiction: {one}" for one in found.conflicts]
    lines += [f"note: {one}" for one in found.notes]
    return "\n".join(lines)


def _bands(found: ImageStatement, count: int) -> str:
    """Numbers and names of the bands."""
    from acutance.raster.band_label import label_band

    if found.bands is None:
        return "1, without a name" if count == 1 else f"{count}, without names (1 to {count})"
    named = ", ".join(
        label_band(number, name) for number, name in enumerate(found.bands.value, start=1)
    )
    return f"{named}   ({found.bands.source})"


def _shown(stated: Stated[Any] | None) -> str:
    """A value with its source."""
    if stated is None:
        return "–"
    value = stated.value
    if isinstance(value, tuple):
        shown = ", ".join(one if isinstance(one, str) else f"{one:.6g}" for one in value)
    elif isinstance(value, float):
        shown = f"{value:.6g}"
    elif isinstance(value, str):
        shown = value
    elif not isinstance(value, datetime):
        shown = value.isoformat()
    else:
        shown = value.isoformat(timespec="milliseconds").replace("+00:00", "Z")
    return f"{shown}   ({stated.source})"
