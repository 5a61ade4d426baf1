"""``acutance star``: measure a Siemens star."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.choices import parse_pair
from acutance.cli.measure import measure_target
from acutance.cli.option_groups import with_groups
from acutance.cli.options import (
    BrightOption,
    DarkOption,
    ImageArgument,
    LevelStdOption,
    PixelOptions,
    ResultOptions,
    RobustOption,
)
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

__all__ = ["EXAMPLE", "WaveOption", "star"]

_CENTRE_WORDS = "ROW,COL, as in --centre 63.5,64"
EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance star baotou.tif --cycles 36 --wave square --dark 212 --bright 1187 "
    "--report star.html\n"
    "  acutance star chart.png --cycles count --figure star.png --json"
)

WaveOption = Annotated[str, typer.Option(metavar="sine|square", help="Form of the spokes.")]


@with_groups
def star(
    *,
    image: ImageArgument,
    pixels: PixelOptions,
    cycles: Annotated[
        str,
        typer.Option(
            metavar="N|count", help="Periods in a full turn, also of a fan; count: count them."
        ),
    ] = "36",
    wave: WaveOption = "sine",
    dark: DarkOption = None,
    bright: BrightOption = None,
    level_std: LevelStdOption = 0.0,
    centre: Annotated[
        str | None,
        typer.Option(
            metavar="ROW,COL", help="The centre to some pixels, where it is not to be searched for."
        ),
    ] = None,
    inner: Annotated[
        float | None, typer.Option(metavar="PX", help="Leave out pixels nearer to the centre.")
    ] = None,
    robust: RobustOption = True,
    wanted: ResultOptions,
) -> None:
    """Measure the MTF of every direction and frequency on a Siemens star, full or a fan.

    Sine or square spokes; the centre is fitted. Spokes finer than two pixels are aliased: the fit
    allows for it and uses them.
    """
    known = _parse_cycles(cycles)
    measure_target(
        KINDS["star"],
        image,
        pixels,
        wanted,
        options={
            "wave": wave,
            "dark": dark,
            "bright": bright,
            "level_std": level_std,
            "centre": None if centre is None else parse_pair("--centre", centre, _CENTRE_WORDS),
            "inner_px": inner,
            "robust": robust,
        },
        arguments=lambda _: {"cycles": known},
    )


def _parse_cycles(text: str) -> int | None:
    """The value of ``--cycles``; None is to count them."""
    if text == "count":
        return None
    try:
        return int(text)
    except ValueError:
        raise OptionError(f"--cycles {text}: write a whole number, or count") from None
