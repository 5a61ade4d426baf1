"""``acutance archive correct``: what is known of images that are kept already."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument
from acutance.cli.options import JsonOption
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
_Angle = Annotated[float | None, typer.Option(metavar="DEG", help="Degrees.")]


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
    acquired: Annotated[
        str | None, typer.Option(metavar="DATE", help="When the image was taken; UTC.")
    ] = None,
    gsd_m: Annotated[
        str | None,
        typer.Option("--gsd", metavar="M[,M]", help="From row to row, and from column to column."),
    ] = None,
    view_zenith_deg: _Angle = None,
    view_azimuth_deg: _Angle = None,
    sun_elevation_deg: _Angle = None,
    sun_azimuth_deg: _Angle = None,
    reason: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Kept with the correction.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only tell what would change.")
    ] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Correct date, sensor, level, GSD or angles of images that are kept already.

    All corrections are made, or none. What was known before is kept with the image; measurements
    stay as they are, and a batch does not make them again.
    """
    from acutance.archive import Archive, ImageCorrection
    from acutance.archive.exchange.image_statements import read_image_corrections
    from acutance.report import json_text

    values = {
        "sensor": sensor, "level": level, "acquired": acquired, "gsd_m": _gsd(gsd_m),
        "view_zenith_deg": view_zenith_deg, "view_azimuth_deg": view_azimuth_deg,
        "sun_elevation_deg": sun_elevation_deg, "sun_azimuth_deg": sun_azimuth_deg,
        "reason": reason,
    }  # fmt: skip
    corrections: list[ImageCorrection]
    if file is not None:
        if image or any(one is not None for one in values.values()):
            raise OptionError("--from has images and values of its own: give it alone")
        corrections = read_image_corrections(file)
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
        for one in found:
            typer.echo(one.summary)
        typer.echo(f"{len(found)} images {'would be ' if dry_run else ''}corrected")
    other = sum(one.other_gsd for one in found)
    if other:
        say(
            f"{other} directions have numbers in metres by another GSD: they stay as they were "
            "measured"
        )


def _gsd(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        sides = [float(part) for part in text.split(",")]
    except ValueError:
        sides = []
    if len(sides) not in (1, 2):
        raise OptionError(f"--gsd {text}: write metres, .7, or two of them, .72,.70")
    return sides[0], sides[-1]
