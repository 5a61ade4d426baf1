"""``acutance plan mirrors``: where to put convex mirrors, and which."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.options import JsonOption
from acutance.cli.output import check_optional
from acutance.cli.plan import (
    EDGE_EXAMPLE,
    EDGE_LINE,
    PULSE_EXAMPLE,
    PULSE_LINE,
    plan_edge,
    plan_pulse,
)
from acutance.cli.plan_trend import TREND_EXAMPLE, TREND_LINES, plan_trend
from acutance.cli.progress import progress_bar
from acutance.cli.sensor import SensorName, named_sensor
from acutance.cli.study import WorkersOption, execution_of
from acutance.errors import OptionError

__all__ = ["EXAMPLE", "app", "plan_mirrors"]

EXAMPLE = (
    "\b\nExample:\n"
    "  acutance plan mirrors --count 20 --gsd 0.7 --sensor quickbird-like --csv mirrors.csv"
)

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Plan a target, or a watch over years: the accuracy to expect, where parts have to stand.",
    epilog=f"\b\nExamples:\n{EDGE_LINE}\n{PULSE_LINE}\n{EXAMPLE.splitlines()[-1]}\n{TREND_LINES}",
)
app.command(
    "edge", short_help="How many rows, which angle: the accuracy to expect.", epilog=EDGE_EXAMPLE
)(plan_edge)
app.command(
    "pulse",
    short_help="How many rows, which angle and width: the accuracy to expect.",
    epilog=PULSE_EXAMPLE,
)(plan_pulse)
app.command(
    "trend",
    short_help="How many images, over how long, until a drift is noticed.",
    epilog=TREND_EXAMPLE,
)(plan_trend)


@app.command("mirrors", epilog=EXAMPLE)
def plan_mirrors(
    count: Annotated[int, typer.Option(metavar="N", help="Number of mirrors.")] = 20,
    arrangement: Annotated[
        str, typer.Option(metavar="columns|square", help="Slanted columns, or a square.")
    ] = "columns",
    columns: Annotated[
        int | None, typer.Option(metavar="N", help="Number of columns: 2, of a single mirror 1.")
    ] = None,
    spacing: Annotated[
        float | None,
        typer.Option(
            metavar="PX", help="Least distance of neighbours: 10 in columns, 5 in a square."
        ),
    ] = None,
    sensor: SensorName = "generic-2005",
    gsd: Annotated[
        float | None,
        typer.Option(metavar="M", help="Ground sampling distance, if not the sensor's own."),
    ] = None,
    snr: Annotated[
        float, typer.Option(metavar="RATIO", help="Peak over the background's noise.")
    ] = 80.0,
    level: Annotated[
        float,
        typer.Option(
            metavar="R", help="Brightest pixel, as the reflectance of ground as bright as it."
        ),
    ] = 0.5,
    ground: Annotated[float, typer.Option(metavar="R", help="Reflectance of the ground.")] = 0.1,
    mirror: Annotated[float, typer.Option(metavar="R", help="Reflectance of the mirrors.")] = 0.85,
    sun_zenith: Annotated[float, typer.Option(metavar="DEG", help="Of the sun.")] = 40.0,
    view_zenith: Annotated[float, typer.Option(metavar="DEG", help="Of the satellite.")] = 10.0,
    accuracy: Annotated[
        float | None,
        typer.Option(metavar="ERROR", help="Wanted for the MTF at Nyquist: how many images?"),
    ] = None,
    draws: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, help="Simulated images, 2 or more; 0 for the layout alone."
        ),
    ] = 20,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 2005,
    workers: WorkersOption = None,
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the mirrors' places, from the first one: .csv."),
    ] = None,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the layout: .png, .svg or .pdf.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Lay out convex mirrors: spacing, angle, phases, radius, and the accuracy to expect.

    Mirrors spread over the sub-pixel phases sample the PSF finer than the pixels do.
    """
    from acutance.report import figure_bytes, json_text, mirror_plan_figure, mirror_plan_text
    from acutance.studies import MirrorPlanOptions
    from acutance.studies import plan_mirrors as lay_out

    if arrangement not in ("columns", "square"):
        raise OptionError(f"--arrangement {arrangement}: it has to be columns or square")
    table = check_optional("--csv", csv, (".csv",), keep=(sensor,))
    drawing = check_optional("--figure", figure, (".png", ".svg", ".pdf"), keep=(sensor,))
    options = MirrorPlanOptions(
        sensor=named_sensor(sensor, gsd), count=count,
        arrangement="square" if arrangement == "square" else "columns", columns=columns,
        spacing_px=spacing, snr=snr, level=level, ground=ground, mirror=mirror,
        sun_zenith_deg=sun_zenith, view_zenith_deg=view_zenith, draws=draws,
        accuracy=accuracy,
    )  # fmt: skip
    with progress_bar("plan mirrors") as progress:
        result = lay_out(options, execution_of(seed, workers, None, progress))
    if table is not None:
        table.deliver(result.to_csv())
    if drawing is not None:
        drawing.deliver(figure_bytes(mirror_plan_figure(result), drawing.ending))
    typer.echo(json_text(result.to_dict()) if as_json else mirror_plan_text(result))
