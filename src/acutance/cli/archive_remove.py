"""``acutance archive remove``: images that are to count no longer."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument

__all__ = ["EXAMPLE", "remove"]

EXAMPLE = (
    "\b\nExamples:\n"
    '  acutance archive remove campaign.db --image "images/test_*.tif" --dry-run\n'
    "  acutance archive remove campaign.db --image scene.tif"
)


def remove(
    place: PlaceArgument,
    image: Annotated[
        list[str],
        typer.Option(
            metavar="NAME", help="Path, file name, SHA-256, or a pattern of names; repeatable."
        ),
    ],
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Change nothing, count what would go.")
    ] = False,
) -> None:
    """Remove images with all their measurements and rejections, as of a file that was replaced.

    A name that several images have is refused: a batch names the SHA-256 of what a changed file
    was before.
    """
    from acutance.archive import Archive
    from acutance.archive.counted import counted

    with Archive(place, read_only=dry_run) as archive:
        count = archive.remove_images(image, dry_run=dry_run)
    typer.echo(f"{counted(count, 'row')} {'would be ' if dry_run else ''}removed")
