"""The options that select measurements of an archive, shared by its commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.archive.selection import SelectionWords

__all__ = ["PlaceArgument", "SelectionOptions"]

PlaceArgument = Annotated[
    str,
    typer.Argument(
        metavar="ARCHIVE",
        help="A file, or a URL of PostgreSQL: postgresql+psycopg://USER@HOST/DATABASE.",
    ),
]


@dataclass(frozen=True)
class SelectionOptions:
    """Which measurements are meant: all filters have to pass, of a repeated one any."""

    sensor: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Of this sensor; repeatable.")
    ] = None
    band: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Of this band, '' of those without a name; repeatable."),
    ] = None
    level: Annotated[
        list[str] | None, typer.Option(metavar="LEVEL", help="Of this product level; repeatable.")
    ] = None
    site: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="At this site; repeatable.")
    ] = None
    target: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Of this target; repeatable.")
    ] = None
    kind: Annotated[
        list[str] | None,
        typer.Option(metavar="KIND", help="Of this kind: edge, pulse, points, ...; repeatable."),
    ] = None
    method: Annotated[
        list[str] | None, typer.Option(metavar="METHOD", help="By this method; repeatable.")
    ] = None
    orientation: Annotated[
        str | None, typer.Option(metavar="across|along", help="In this direction.")
    ] = None
    since: Annotated[
        str | None, typer.Option(metavar="DATE", help="Acquired on this day (UTC) or later.")
    ] = None
    until: Annotated[
        str | None, typer.Option(metavar="DATE", help="Acquired on this day (UTC) or earlier.")
    ] = None
    verdict: Annotated[
        str | None,
        typer.Option(metavar="WORD", help="At least good, usable, doubtful or invalid."),
    ] = None
    image: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Of the image of this file name, path or SHA-256."),
    ] = None
    run: Annotated[int | None, typer.Option(metavar="N", help="Written by this run.")] = None
    minimum: Annotated[
        list[str] | None,
        typer.Option("--min", metavar="METRIC=VALUE", help="At least this value; repeatable."),
    ] = None
    maximum: Annotated[
        list[str] | None,
        typer.Option("--max", metavar="METRIC=VALUE", help="At most this value; repeatable."),
    ] = None

    @property
    def words(self) -> SelectionWords:
        """The keywords of `acutance.Archive.measurements`.

        Raises
        ------
        OptionError
            If a limit is no number.
        """
        low, high = _numbers("--min", self.minimum or ()), _numbers("--max", self.maximum or ())
        limits = {name: (low.get(name), high.get(name)) for name in (*low, *high)}
        words: SelectionWords = {
            "sensor": self.sensor, "band": self.band, "level": self.level, "site": self.site,
            "target": self.target, "kind": self.kind, "method": self.method,
            "orientation": self.orientation, "since": self.since, "until": self.until,
            "verdict": self.verdict, "image": self.image, "run": self.run, "limits": limits or None,
        }  # fmt: skip
        return words


def _numbers(option: str, texts: Sequence[str]) -> dict[str, float]:
    found = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            found[name] = float(number)
        except ValueError as error:
            raise OptionError(f"{option} {text}: write METRIC=VALUE, as in rer=0.4") from error
    return found
