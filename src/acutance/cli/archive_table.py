"""``acutance archive table``: means across and along by sensor, band, site, date."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument, SelectionOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption

__all__ = ["EXAMPLE", "table"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive table campaign.db --by site,date\n"
    "  acutance archive table campaign.db --by sensor,band --metric mtf_nyquist --metric fwhm_m"
)


@with_groups
def table(
    *,
    place: PlaceArgument,
    by: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help="Groups: sensor, band, level, site, target, date, kind, method, image, verdict.",
        ),
    ] = "site,date",
    metric: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Which numbers; rer, fwhm_px and mtf_nyquist without."),
    ] = None,
    selected: SelectionOptions,
    as_json: JsonOption = False,
) -> None:
    """Print means across and along, with the averages of leading groups.

    Means are over images and have their scatter in their deviation; a star is before the numbers
    of one measurement, which have their own. Measurements count whose verdict is usable or good
    (--verdict).
    """
    from acutance.archive import Archive
    from acutance.report import json_text

    groups = [name.strip() for name in by.split(",") if name.strip()]
    with Archive(place, read_only=True) as archive:
        chosen = tuple(metric or ("rer", "fwhm_px", "mtf_nyquist"))
        found = archive.table(groups, chosen, **selected.words)
    if as_json:
        typer.echo(json_text(found.to_dict()))
        return
    typer.echo(str(found))
