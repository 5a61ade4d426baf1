"""``acutance archive correct``: what is known of images that are kept already."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument
from acutance.cli.options import JsonOption, parse_gsd
from acutance.cli.terminal import say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.archive import ImageCorrection

__all__ = ["EXAMPLE", "correct"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive correct campaign.db --image scene.tif --acquired 2026-05-01T10:20:00Z\n"
    '  acutance archive correct campaign.db --image "K3_*.tif" --sensor KOMPSAT-3 --dry-run\n'
    "  acutance archive correct campaign.db --from corrections.csv"
)


def correct(
    place: PlaceArgument,
    image: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Path, file name, SHA-256, or a pattern of names; repeatable."
        ),
    ] = None,
    file: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="FILE",
            help="A row an image: CSV with the columns image, sensor, acquired, ..., or JSON.",
        ),
    ] = None,
    sensor: Annotated[str | None, typer.Option(metavar="NAME", help="Which sensor it is.")] = None,
    level: Annotated[str | None, typer.Option(metavar="LEVEL", help="The product's level.")] = None,
    band: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="The band of rows that were added without its name."),
    ] = None,
    acquired: Annotated[
        str | None, typer.Option(metavar="DATE", help="When the image was taken; UTC.")
    ] = None,
    gsd_m: Annotated[
        str | None,
        typer.Option("--gsd", metavar="M[,M]", help="From row to row, and from column to column."),
    ] = None,
    view_zenith_deg: Annotated[
        float | None, typer.Option(metavar="DEG", help="Degrees of the view from the vertical.")
    ] = None,
    view_azimuth_deg: Annotated[
        float | None, typer.Option(metavar="DEG", help="Degrees of the view, clockwise from north.")
    ] = None,
    sun_elevation_deg: Annotated[
        float | None, typer.Option(metavar="DEG", help="Degrees of the sun above the horizon.")
    ] = None,
    sun_azimuth_deg: Annotated[
        float | None, typer.Option(metavar="DEG", help="Degrees of the sun, clockwise from north.")
    ] = None,
    reason: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Kept with the correction.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Change nothing, list what would change.")
    ] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Correct date, sensor, level, band, GSD or angles of images that are kept already.

    All corrections are made, or none. What was known before is kept with the image; measurements
    stay as they are, and a batch does not make them again.
    """
    from acutance.archive import Archive, ImageCorrection
    from acutance.archive.counted import counted
    from acutance.archive.exchange.correction_files import read_correction_file
    from acutance.archive.natural_order import natural_key
    from acutance.report import json_text

    values = {
        "sensor": sensor, "level": level, "band": band, "acquired": acquired, "gsd_m": _gsd(gsd_m),
        "view_zenith_deg": view_zenith_deg, "view_azimuth_deg": view_azimuth_deg,
        "sun_elevation_deg": sun_elevation_deg, "sun_azimuth_deg": sun_azimuth_deg,
        "reason": reason,
    }  # fmt: skip
    corrections: list[ImageCorrection]
    if file is not None:
        if image or any(one is not None for one in values.values()):
            raise OptionError("--from has images and values of its own: give it alone")
        corrections = read_correction_file(file)
    elif not image:
        raise OptionError("give --image NAME and what is to be corrected, or --from FILE")
    else:
        corrections = [ImageCorrection(image=one, **values) for one in image]  # type: ignore[arg-type]
    with Archive(place, read_only=dry_run) as archive:
        found = archive.correct_images(corrections, dry_run=dry_run)
    if as_json:
        document = {"schema": "acutance/archive-corrections/1", "dry_run": dry_run,
                    "images": [one.to_dict() for one in found]}  # fmt: skip
        typer.echo(json_text(document))
    else:
        for one in sorted(found, key=lambda one: natural_key(one.image)):
            typer.echo(one.summary)
        typer.echo(f"{counted(len(found), 'image')} {'would be ' if dry_run else ''}corrected")
    other = sum(one.other_gsd for one in found)
    if other:
        say(
            f"{counted(other, 'direction')} with numbers in metres by another GSD: they stay as "
            "they were measured"
        )


def _gsd(text: str | None) -> tuple[float, float] | None:
    from acutance.raster import Gsd

    sides = Gsd.given(parse_gsd(text))
    return None if sides is None else (sides.row_m, sides.col_m)
