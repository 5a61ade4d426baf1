"""``acutance plan trend``: how many images, over how long, until a drift is noticed."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from acutance.cli.archive_selection import SelectionOptions
from acutance.cli.choices import parse_numbers, parse_share
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.output import check_optional
from acutance.cli.progress import progress_bar
from acutance.cli.study import WorkersOption
from acutance.errors import OptionError

__all__ = ["TREND_EXAMPLE", "TREND_LINES", "plan_trend"]

TREND_LINES = (
    "  acutance plan trend --images 6,12,24 --years 1,2,3,5 --scatter 4% --drift 1%\n"
    "  acutance plan trend --archive campaign.db --sensor QB02 --orientation across --drift 1%"
)
TREND_EXAMPLE = f"\b\nExamples:\n{TREND_LINES}"


@with_groups
def plan_trend(
    *,
    images: Annotated[
        str | None,
        typer.Option(
            metavar="N,...",
            help="Images a year that show the target in clear sky; several are compared. 12, or "
            "the archive's.",
        ),
    ] = None,
    years: Annotated[
        str, typer.Option(metavar="YEARS,...", help="How long they are taken from now on.")
    ] = "1,2,3,5",
    drift: Annotated[
        str,
        typer.Option(metavar="SHARE", help="A year, of the level: to be noticed (1% or 0.01)."),
    ] = "1%",
    scatter: Annotated[
        str | None,
        typer.Option(
            metavar="SHARE",
            help="Between images beyond their deviations, of the level. 4%, or the archive's.",
        ),
    ] = None,
    std: Annotated[
        str | None,
        typer.Option(
            metavar="SHARE",
            help="Standard deviation of the mean of one image, of the level. 2%, or the archive's.",
        ),
    ] = None,
    archive: Annotated[
        str | None,
        typer.Option(
            metavar="ARCHIVE",
            help="Go on with the images of this archive: the options below select its trend.",
        ),
    ] = None,
    metric: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Of the archive: mtf_nyquist, rer, fwhm_m, ...; mtf_nyquist without it.",
        ),
    ] = None,
    selected: SelectionOptions,
    draws: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, help="Simulated series a design, 10 or more; 0 for theory alone."
        ),
    ] = 40,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 2005,
    workers: WorkersOption = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the table: .csv.")] = None,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the table: .png, .svg or .pdf.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Plan a watch over a sensor: how many images, over how long, until a drift is noticed.

    A drift is noticed where the 95 % interval of the trend leaves out 0.
    """
    from acutance.archive.trends import plan_trend as plan
    from acutance.report import figure_bytes, json_text
    from acutance.report.archive import trend_plan_figure, trend_plan_text
    from acutance.report.paper import FIGURE_ENDINGS

    kept = () if archive is None else (archive,)
    table = check_optional("--csv", csv, (".csv",), keep=kept)
    drawing = check_optional("--figure", figure, FIGURE_ENDINGS, keep=kept)
    given: dict[str, Any] = {
        "years": tuple(parse_numbers("--years", years)),
        "drift_per_year": parse_share("--drift", drift, "the level"),
        "draws": draws,
        "seed": seed,
    }
    if images is not None:
        given["images_per_year"] = tuple(parse_numbers("--images", images))
    for option, text in (("scatter", scatter), ("std", std)):
        if text is not None:
            given[option] = parse_share(f"--{option}", text, "the level")
    options = _options(archive, metric, selected, given)
    with progress_bar("plan trend") as progress:
        found = plan(options, workers=workers, progress=progress)
    if table is not None:
        table.deliver(found.to_csv())
    if drawing is not None:
        drawing.deliver(figure_bytes(trend_plan_figure(found), drawing.ending))
    typer.echo(json_text(found.to_dict()) if as_json else trend_plan_text(found))


def _options(
    archive: str | None, metric: str | None, selected: SelectionOptions, given: dict[str, Any]
) -> Any:
    """What is planned: from the words alone, or with what an archive shows."""
    from acutance.archive import Archive
    from acutance.archive.trends import TrendPlanOptions

    if archive is None:
        if metric is not None or selected != SelectionOptions():
            raise OptionError("options that select measurements need the archive: add --archive")
        return TrendPlanOptions(**given)
    with Archive(archive, read_only=True) as kept:
        return TrendPlanOptions.of_trend(
            kept.trend(metric or "mtf_nyquist", **selected.words), **given
        )
