"""``acutance archive trend``: what years of measurements say of a sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.archive_selection import PlaceArgument, SelectionOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.output import check_optional
from acutance.cli.terminal import command_line
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.archive.trends import Event, Trend

__all__ = ["EXAMPLE", "EventOption", "parse_events", "trend"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive trend campaign.db --metric mtf_nyquist --sensor QB02 --orientation across\n"
    "  acutance archive trend campaign.db --sensor QB02 --orientation along "
    '--event "2026-03-01=refocus" --limit .09 --report trend.html'
)
EventOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="DATE=NAME",
        help="Something that may have changed the sensor on this day; repeatable. The drift stays "
        "the same; DATE=NAME+drift lets it change, too.",
    ),
]
_DRIFT = "+drift"


@with_groups
def trend(
    *,
    place: PlaceArgument,
    metric: Annotated[
        str, typer.Option(metavar="NAME", help="Which number: mtf_nyquist, rer, fwhm_m, ...")
    ] = "mtf_nyquist",
    selected: SelectionOptions,
    event: EventOption = None,
    limit: Annotated[
        float | None, typer.Option(metavar="VALUE", help="Tell when this value will be passed.")
    ] = None,
    report: Annotated[str | None, typer.Option(metavar="FILE", help="Write a page: .html.")] = None,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a drawing: .png, .svg or .pdf.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Tell level, drift, steps, season and scatter of one metric of one sensor.

    Measurements count whose verdict is usable or good (--verdict). Intervals hold 95 %.
    """
    from acutance.archive import Archive
    from acutance.report import figure_bytes, json_text
    from acutance.report.archive import trend_figure, trend_page
    from acutance.report.paper import FIGURE_ENDINGS

    page = check_optional("--report", report, (".html",), keep=[place])
    drawing = check_optional("--figure", figure, FIGURE_ENDINGS, keep=[place])
    events = parse_events(event)
    with Archive(place, read_only=True) as archive:
        found = archive.trend(metric, events=events, **selected.words)
    crossing = None if limit is None else found.crosses(limit)
    if page is not None:
        page.deliver(trend_page(found, limit=limit, command=command_line()))
    if drawing is not None:
        drawing.deliver(figure_bytes(trend_figure(found, limit=limit), drawing.ending))
    if as_json:
        document = found.to_dict()
        if crossing is not None:
            document["crossing"] = crossing.to_dict()
        typer.echo(json_text(document))
        return
    typer.echo(_text(found))
    if crossing is not None:
        typer.echo(f"\nThe sensor's mean {crossing.summary()}.")


def parse_events(texts: list[str] | None) -> list[Event]:
    """Events as they were typed.

    Raises
    ------
    OptionError
        If one is not of the form DATE=NAME.
    """
    from acutance.archive.trends import Event

    found = []
    for text in texts or ():
        day, sign, name = text.partition("=")
        if not (sign and name.removesuffix(_DRIFT)):
            raise OptionError(f"--event {text}: write DATE=NAME, as in 2026-03-01=refocus")
        event = Event(day, name.removesuffix(_DRIFT), name.endswith(_DRIFT))
        _ = event.year
        found.append(event)
    return found


def _text(found: Trend) -> str:
    from acutance.archive.trends.words import (
        new_drift_words,
        part_words,
        percent,
        rate_interval,
        signed,
        since_words,
        size_words,
        unsought_words,
    )
    from acutance.curves.aligned_columns import align_columns
    from acutance.report.labels import MISSING

    rate, relative = found.rate_per_year, found.relative_rate_per_year
    in_percent = f"{percent(relative)}, " if found.has_scale else ""
    rows = [
        (f"level on {found.last}", str(found.level), ""),
        (f"drift a year{since_words(found)}", signed(rate),
         f"{in_percent}{rate_interval(found)}"),
        ("scatter between images", str(found.scatter),
         part_words(found.relative_scatter).strip(" ()")),
        ("season, amplitude", str(found.season_amplitude),
         f"probability of a season {found.season_probability:.2f}"),
        ("steps", *((MISSING, unsought) if (unsought := unsought_words(found)) else
                    (str(len(found.changes)),
                     f"probability of any {found.step_probability:.2f}"))),
        *((f"  {change.date}", signed(change.size),
           f"{size_words(change)}, {change.since} to {change.until}, "
           f"probability {change.probability:.2f}") for change in found.changes),
        *((f"  {effect.date} {effect.name}", signed(effect.size),
           ", ".join(filter(None, (size_words(effect), "stated", new_drift_words(effect)))))
          for effect in found.events),
    ]  # fmt: skip
    table = align_columns(rows, "lll", indent="  ")
    return f"{found.title}\n\n{table}\n\n{found.summary()}"
