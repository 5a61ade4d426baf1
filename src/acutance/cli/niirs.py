"""``acutance niirs``: interpretability of an image, of a measurement or of stated numbers."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.choices import numbers_of
from acutance.cli.documents import read_json
from acutance.cli.options import JsonOption
from acutance.errors import OptionError

__all__ = ["EXAMPLE", "niirs"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance niirs measurement.json --gsd-m 0.7 --snr 80 --elevation-deg 70\n"
    "  acutance niirs across.json along.json\n"
    "  acutance niirs --rer 0.45,0.42 --gsd-m 0.7 --snr 80 --version 4 --noise-gain 2"
)


def niirs(
    files: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE...",
            help="A measurement as JSON, or several of one sensor, as one of each direction; "
            "without it state --rer.",
        ),
    ] = None,
    gsd_m: Annotated[
        str | None,
        typer.Option(
            metavar="M[,M]",
            help="Ground sampling distance normal to the line of sight; else the measurement's.",
        ),
    ] = None,
    rer: Annotated[
        str | None, typer.Option(metavar="RER[,RER]", help="Relative edge response, across,along.")
    ] = None,
    snr: Annotated[
        float | None, typer.Option(metavar="RATIO", help="Signal to noise ratio before sharpening.")
    ] = None,
    elevation_deg: Annotated[
        float, typer.Option(metavar="DEG", help="Of the line of sight; 90 at nadir.")
    ] = 90.0,
    version: Annotated[
        int, typer.Option(metavar="3|4|5", help="Of the General Image Quality Equation.")
    ] = 5,
    giqe_h: Annotated[
        float | None, typer.Option(metavar="H", help="Edge height overshoot (versions 3 and 4).")
    ] = None,
    noise_gain: Annotated[
        float, typer.Option(metavar="G", help="Of the sharpening (versions 3 and 4).")
    ] = 1.0,
    as_json: JsonOption = False,
) -> None:
    """NIIRS by the General Image Quality Equation, with its standard deviation.

    It is that of the measurement and the equation's own; several measurements are combined. Notes
    have the checks that a measurement failed, and where the equation was not made for such an
    image.
    """
    inputs = tuple(files or ())
    if not inputs and rer is None:
        raise OptionError("give the JSON document of a measurement, or state --rer")

    from acutance.report import json_text, niirs_text
    from acutance.restoration import niirs as niirs_of

    found = niirs_of(
        [read_json(name) for name in inputs] or None,
        gsd_m=_gsd(gsd_m),
        rer=None if rer is None else _one_or_two("--rer", rer),
        snr=snr,
        elevation_deg=elevation_deg,
        version=version,  # type: ignore[arg-type]
        giqe_h=giqe_h,
        noise_gain=noise_gain,
        names=inputs or None,
    )
    if as_json:
        typer.echo(json_text({"schema": "acutance/niirs/1", **found.to_dict()}))
    else:
        typer.echo(niirs_text(found))


def _gsd(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    numbers = _one_or_two("--gsd-m", text)
    return numbers[0], numbers[-1]


def _one_or_two(option: str, text: str) -> list[float]:
    """One number, that stands for both directions, or two of them."""
    numbers = list(numbers_of(text))
    if len(numbers) not in (1, 2):
        raise OptionError(f"{option} {text}: write one number, or two (across,along)")
    return [numbers[0], numbers[-1]]
