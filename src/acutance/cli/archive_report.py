"""``acutance archive report``: everything an archive holds of a sensor, as one page."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument
from acutance.cli.archive_trend import EventOption, parse_events
from acutance.cli.output import check_output
from acutance.cli.progress import progress_bar
from acutance.cli.terminal import command_line

__all__ = ["EXAMPLE", "report"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive report campaign.db QB02 qb02.html\n"
    "  acutance archive report campaign.db QB02 qb02.html --spec spec.toml "
    '--event "2026-03-01=refocus"'
)


def report(
    place: PlaceArgument,
    sensor: Annotated[str, typer.Argument(metavar="SENSOR", help="Whose page.")],
    out: Annotated[str, typer.Argument(metavar="OUT.html", help="The file to write.")],
    metric: Annotated[
        str, typer.Option(metavar="NAME", help="What is drawn through time.")
    ] = "mtf_nyquist",
    spec: Annotated[
        str | None, typer.Option("--spec", metavar="FILE", help="Requirements to be judged, TOML.")
    ] = None,
    event: EventOption = None,
    verdict: Annotated[
        str, typer.Option(metavar="WORD", help="Measurements of this verdict or better count.")
    ] = "usable",
) -> None:
    """Write the page of a sensor: state, specification, trends, curves, images."""
    file = check_output("OUT.html", out, (".html",), keep=[place, spec])

    from acutance.archive import Archive
    from acutance.report.archive import sensor_page

    events = parse_events(event)
    with Archive(place, read_only=True) as archive, progress_bar("archive report") as progress:
        page = sensor_page(
            archive, sensor, metric=metric, specification=spec, events=events, verdict=verdict,
            command=command_line(), progress=progress,
        )  # fmt: skip
    file.deliver(page)
