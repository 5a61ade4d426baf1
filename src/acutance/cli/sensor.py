"""Naming a sensor on the command line, and ``acutance simulate sensor-budget``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.output import check_optional
from acutance.cli.terminal import say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.optics import Sensor

__all__ = ["BUDGET_EXAMPLE", "SensorName", "named_sensor", "sensor_budget"]

BUDGET_EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate sensor-budget generic-2005\n"
    "  acutance simulate sensor-budget my-sensor.toml --figure budget.svg --json"
)

SensorName = Annotated[
    str,
    typer.Option(
        "--sensor",
        metavar="FILE|NAME",
        help="A sensor in a .toml file, or generic-2005, ikonos-like, quickbird-like, or one of "
        "the ready systems of simulate edge --system.",
    ),
]


def named_sensor(name: str) -> Sensor:
    """The sensor of a TOML file, a preset, or a reference system.

    Raises
    ------
    OptionError
        If it is none of them.
    ModelError
        If the file describes no sensor.
    """
    from acutance.optics import presets, read_sensor
    from acutance.simulate import reference_systems

    ready = {key: sheet.sensor for key, sheet in presets().items()} | reference_systems()
    if name in ready:
        return ready[name]
    if Path(name).suffix.lower() == ".toml":
        return read_sensor(name)
    raise OptionError(f"the sensor {name} is no .toml file and none of {', '.join(ready)}")


def sensor_budget(
    sensor: Annotated[
        str, typer.Argument(metavar="FILE|NAME", help="A .toml file or the name of a preset.")
    ],
    freq: Annotated[
        float, typer.Option(metavar="CPP", help="Frequency in cycles per pixel.")
    ] = 0.5,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the curves: .png, .svg or .pdf.")
    ] = None,
    toml: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the sensor as .toml, to be changed and read."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> None:
    """What every block of a sensor leaves of the contrast, across and along."""
    drawing = check_optional("--figure", figure, (".png", ".svg", ".pdf"), keep=(sensor,))
    sheet = check_optional("--toml", toml, (".toml",), keep=(sensor,))
    from acutance.optics import SensorFile, budget, presets, sensor_file_to_toml
    from acutance.report.budget import budget_document, budget_figure, budget_text
    from acutance.report.documents import json_text
    from acutance.report.page import figure_bytes

    system = named_sensor(sensor)
    table = budget(system, freq)
    if drawing is not None:
        drawing.write(figure_bytes(budget_figure(table), drawing.ending))
        say(f"wrote {drawing.path}")
    if sheet is not None:
        sheet.write(sensor_file_to_toml(presets().get(sensor, SensorFile(system))))
        say(f"wrote {sheet.path}")
    typer.echo(json_text(budget_document(table)) if as_json else budget_text(table))
