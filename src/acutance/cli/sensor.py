"""Naming a sensor on the command line, and ``acutance simulate sensor-budget``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.output import check_optional
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.optics import Sensor

__all__ = [
    "BUDGET_EXAMPLE",
    "SENSOR_OPTION",
    "OptionalSensorName",
    "SensorGsd",
    "SensorName",
    "named_sensor",
    "sensor_budget",
]

BUDGET_EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate sensor-budget generic-2005\n"
    "  acutance simulate sensor-budget my-sensor.toml --figure budget.svg --json"
)

SENSOR_OPTION = typer.Option(
    "--sensor",
    metavar="FILE|NAME",
    help="A sensor in a .toml file; one like a real one: generic-2005, ikonos-like, "
    "quickbird-like; or a kind of sensor: gaussian, wide, diffraction, halo, sharpened, "
    "asymmetric, smeared, defocused.",
)
SensorName = Annotated[str, SENSOR_OPTION]
OptionalSensorName = Annotated[str | None, SENSOR_OPTION]
SensorGsd = Annotated[
    float | None,
    typer.Option("--gsd", metavar="M", help="GSD in metres, instead of the sensor's own."),
]


def named_sensor(name: str, gsd_m: float | None = None) -> Sensor:
    """The sensor of a TOML file, a preset, or a reference system.

    Parameters
    ----------
    name : str
    gsd_m : float, optional
        Another ground sampling distance than the sensor's own. What a file states in metres keeps
        its metres, all other blur stays the same in pixels.

    Raises
    ------
    OptionError
        If it is none of them.
    ModelError
        If the file describes no sensor.
    """
    from acutance.optics import presets, read_sensor
    from acutance.simulate import reference_systems

    ready = {key: one.sensor for key, one in presets().items()} | reference_systems()
    if gsd_m is not None:
        from acutance.raster import Gsd

        Gsd.given(gsd_m)
    if name not in ready:
        if Path(name).suffix.lower() != ".toml":
            raise OptionError(f"the sensor {name} is no .toml file and none of {', '.join(ready)}")
        return read_sensor(name, gsd_m)
    sensor = ready[name]
    return sensor if gsd_m is None else replace(sensor, gsd_m=gsd_m, gsd_along_m=None)


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
    described = check_optional("--toml", toml, (".toml",), keep=(sensor,))
    from acutance.optics import SensorFile, budget, presets, sensor_file_to_toml
    from acutance.report import budget_document, budget_figure, budget_text, figure_bytes, json_text

    system = named_sensor(sensor)
    table = budget(system, freq)
    if drawing is not None:
        drawing.deliver(figure_bytes(budget_figure(table), drawing.ending))
    if described is not None:
        described.deliver(sensor_file_to_toml(presets().get(sensor, SensorFile(system))))
    typer.echo(json_text(budget_document(table)) if as_json else budget_text(table))
