"""``acutance archive compare``: do across and along differ, do methods agree."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.archive.comparison_margin import MARGIN
from acutance.cli.archive_selection import PlaceArgument, SelectionOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.terminal import NOTHING_MEASURED, fail

__all__ = ["EXAMPLE", "compare"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive compare campaign.db --sensor QB02\n"
    "  acutance archive compare campaign.db --by method --kind edge --metric rer\n"
    "  acutance archive compare campaign.db --by kind --margin .1 --json"
)


@with_groups
def compare(
    *,
    place: PlaceArgument,
    by: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What is compared: orientation, method, kind, band, level, sensor, site, target.",
        ),
    ] = "orientation",
    metric: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Which numbers; mtf_nyquist without; repeatable."),
    ] = None,
    margin: Annotated[
        float,
        typer.Option(
            metavar="PART", help="Relative difference below which groups are said to agree."
        ),
    ] = MARGIN,
    selected: SelectionOptions,
    as_json: JsonOption = False,
) -> None:
    """Tell whether across and along differ, or methods, kinds, bands agree.

    Groups that were measured in the same images are compared there; others by their means, with a
    drift of the sensor allowed for. Measurements count whose verdict is usable or good (--verdict).
    """
    from acutance.archive import Archive
    from acutance.report import json_text

    with Archive(place, read_only=True) as archive:
        found = [
            archive.compare(name, by, margin=margin, **selected.words)
            for name in metric or ("mtf_nyquist",)
        ]
    if as_json:
        document = {"schema": "acutance/archive-comparisons/1",
                    "comparisons": [one.to_dict() for one in found]}  # fmt: skip
        typer.echo(json_text(document))
    if not any(one.differences for one in found):
        fail(found[0].summary, NOTHING_MEASURED)
    if not as_json:
        for one in found:
            typer.echo(one.summary)
