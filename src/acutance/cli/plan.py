"""``acutance plan``: which accuracy to expect of a target, before it is bought."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from acutance.cli.choices import parse_numbers
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.output import check_optional
from acutance.cli.progress import progress_bar
from acutance.cli.sensor import SensorName, named_sensor
from acutance.cli.study import WorkersOption, execution_of
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.optics import Sensor

__all__ = ["EDGE_EXAMPLE", "EDGE_LINE", "PULSE_EXAMPLE", "PULSE_LINE", "plan_edge", "plan_pulse"]

EDGE_LINE = "  acutance plan edge --gsd 0.7 --snr 100 --rows 40 --angle 6 --sensor generic-2005"
PULSE_LINE = "  acutance plan pulse --width-m 8.83 --gsd 2.8 --snr 70 --accuracy 0.005"
EDGE_EXAMPLE = f"\b\nExample:\n{EDGE_LINE}"
PULSE_EXAMPLE = f"\b\nExample:\n{PULSE_LINE}"


@dataclass(frozen=True)
class DesignOptions:
    """What is planned with, of an edge and of a pulse."""

    sensor: SensorName = "generic-2005"
    gsd: Annotated[
        float | None,
        typer.Option(metavar="M", help="Ground sampling distance, if not the sensor's own."),
    ] = None
    snr: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Contrast over noise; 100 unless given."),
    ] = None
    contrast: Annotated[
        float | None, typer.Option(metavar="DN", help="Height of the target; needs --noise.")
    ] = None
    noise: Annotated[
        float | None,
        typer.Option(metavar="DN", help="Standard deviation of the noise; needs --contrast."),
    ] = None
    rows: Annotated[
        str,
        typer.Option(
            metavar="N,...",
            help="Image rows across the target; several are compared, the first is the plan.",
        ),
    ] = "40"
    angle: Annotated[
        str,
        typer.Option(
            metavar="DEG,...",
            help="Tilt against the columns; several are compared, the first is the plan.",
        ),
    ] = "6"
    accuracy: Annotated[
        float | None,
        typer.Option(metavar="STD", help="Wanted for the MTF at Nyquist: how many rows?"),
    ] = None
    draws: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, help="Simulated images a design, 2 or more; 0 for bounds."
        ),
    ] = 200
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 2005
    workers: WorkersOption = None
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the table: .csv.")] = None
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the table: .png, .svg or .pdf.")
    ] = None
    as_json: JsonOption = False


# Of an edge they are no options, and whoever types them is told why.
_NoWidth = Annotated[str | None, typer.Option(hidden=True)]


@with_groups
def plan_edge(
    *, width_px: _NoWidth = None, width_m: _NoWidth = None, design: DesignOptions
) -> None:
    """Plan an edge: the standard deviations to expect, by theory and by simulation.

    How many rows, which angle.
    """
    if width_px is not None or width_m is not None:
        raise OptionError("--width-px and --width-m belong to a pulse: an edge has no width")
    _plan("edge", design)


@with_groups
def plan_pulse(
    *,
    width_px: Annotated[
        str | None,
        typer.Option(
            metavar="PX,...",
            help="Width of the pulse; 3 if not given. Several are compared, and the one with the "
            "least bound is the plan.",
        ),
    ] = None,
    width_m: Annotated[
        str | None,
        typer.Option(metavar="M,...", help="The same in metres, at --gsd or the sensor's own GSD."),
    ] = None,
    design: DesignOptions,
) -> None:
    """Plan a pulse: the standard deviations to expect, by theory and by simulation.

    Which width of tarp, how many rows, which angle.
    """
    _plan("pulse", design, width_px, width_m)


def _plan(
    target: Literal["edge", "pulse"],
    design: DesignOptions,
    width_px: str | None = None,
    width_m: str | None = None,
) -> None:
    """Plan a target and deliver what is asked for."""
    from acutance.report import figure_bytes, json_text, plan_text, study_figure
    from acutance.studies import PlanOptions, plan_target

    kept = (design.sensor,)
    table = check_optional("--csv", design.csv, (".csv",), keep=kept)
    drawing = check_optional("--figure", design.figure, (".png", ".svg", ".pdf"), keep=kept)
    system = named_sensor(design.sensor, design.gsd)
    options = PlanOptions(
        target=target, sensor=system, snr=_snr(design.snr, design.contrast, design.noise),
        rows=_whole_numbers("--rows", design.rows),
        angles_deg=parse_numbers("--angle", design.angle),
        widths_px=_widths(width_px, width_m, system, design), draws=design.draws,
        accuracy=design.accuracy, sensor_name=Path(design.sensor).stem,
    )  # fmt: skip
    with progress_bar(f"plan {target}") as progress:
        result: Any = plan_target(
            options, execution_of(design.seed, design.workers, None, progress)
        )
    if table is not None:
        table.deliver(result.table.to_csv())
    if drawing is not None:
        drawing.deliver(figure_bytes(study_figure(result), drawing.ending))
    typer.echo(json_text(result.to_dict()) if design.as_json else plan_text(result))


def _snr(snr: float | None, contrast: float | None, noise: float | None) -> float:
    if contrast is None and noise is None:
        return 100.0 if snr is None else snr
    if contrast is None or noise is None or snr is not None:
        raise OptionError("give --contrast and --noise together, or --snr without them")
    if not (contrast > 0 and noise > 0):
        raise OptionError(f"--contrast {contrast:g} and --noise {noise:g}: both have to be above 0")
    return contrast / noise


def _widths(
    width_px: str | None, width_m: str | None, sensor: Sensor, design: DesignOptions
) -> tuple[float, ...]:
    """Widths in pixels along the normal of the planned angle, whose GSD they are divided by."""
    if width_px is not None and width_m is not None:
        raise OptionError("--width-px and --width-m were both given: give one of them")
    from acutance.studies.plan_options import MAX_WIDTH_PX, MIN_WIDTH_PX

    if width_m is None:
        return parse_numbers("--width-px", width_px or "3")
    gsd_m = sensor.gsd_along_normal_m(parse_numbers("--angle", design.angle)[0])
    if gsd_m is None:
        raise OptionError(f"--width-m {width_m} needs the ground sampling distance: add --gsd")
    widths_px = tuple(width / gsd_m for width in parse_numbers("--width-m", width_m))
    if not all(MIN_WIDTH_PX <= width <= MAX_WIDTH_PX for width in widths_px):
        whose = f"that of {design.sensor}; --gsd is another" if design.gsd is None else "--gsd"
        found = ", ".join(f"{width:.4g}" for width in widths_px)
        raise OptionError(
            f"--width-m {width_m} at a GSD of {gsd_m:.4g} m ({whose}) is {found} px: a pulse "
            f"is {MIN_WIDTH_PX:g} to {MAX_WIDTH_PX:g} px wide, 3 is best"
        )
    return widths_px


def _whole_numbers(option: str, text: str) -> tuple[int, ...]:
    numbers = parse_numbers(option, text)
    if not all(number.is_integer() for number in numbers):
        raise OptionError(f"{option} {text}: write whole numbers with commas, as in 20,40")
    return tuple(int(number) for number in numbers)
