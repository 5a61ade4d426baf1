"""``acutance archive check``: do the sensors meet a specification."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument, SelectionOptions
from acutance.cli.archive_trend import EventOption, parse_events
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.terminal import FAILED_CHECK

__all__ = ["EXAMPLE", "check"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive check campaign.db --spec spec.toml\n"
    "  acutance archive check campaign.db --spec spec.toml --sensor QB02 --json"
)


@with_groups
def check(
    *,
    place: PlaceArgument,
    spec: Annotated[str, typer.Option("--spec", metavar="FILE", help="The requirements, in TOML.")],
    selected: SelectionOptions,
    event: EventOption = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="What cannot be told yet ends with exit code 3, too.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Judge each requirement: met, not met, or cannot be told yet, with its probability.

    What is judged is the mean of the sensor on the day of its last image. Exit code 3 where a
    requirement is not met.
    """
    from acutance.archive import Archive
    from acutance.archive.specification import read_specification
    from acutance.report import json_text

    specification, events = read_specification(spec), parse_events(event)
    words = {name: value for name, value in selected.words.items() if value is not None}
    with Archive(place, read_only=True) as archive:
        found = archive.check(specification, events=events, **words)  # type: ignore[arg-type]
    if as_json:
        typer.echo(json_text(found.to_dict()))
    else:
        for answer in found.answers:
            name = answer.requirement.name
            typer.echo(f"{f'{name}: ' if name else ''}{answer.judgement}")
        if found.notes:
            typer.echo("\n" + "\n".join(f"note: {note}" for note in found.notes))
        typer.echo(f"\n{found.summary}")
    if found.word == "not met" or (strict and found.word != "met"):
        raise typer.Exit(FAILED_CHECK)
