"""``acutance bars``: measure groups of bars."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.choices import numbers_of
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

if TYPE_CHECKING:
    from acutance.geometry.bar_group import Bars

__all__ = ["EXAMPLE", "bars", "parse_group"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance bars target.tif --count 5 --figure bars.png --report bars.html\n"
    "  acutance bars target.tif --group 40,31,6,8,5,24 --group 74,31,6,4,5,24 --json"
)
_PARTS = 6


@with_groups
def bars(
    *,
    image: ImageArgument,
    pixels: PixelOptions,
    group: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ROW,COL,ANGLE,PERIOD,COUNT,LENGTH",
            help="A group: its centre, the direction across its bars (degrees from the column "
            "axis towards the row axis), their period, number and length in pixels; repeatable. "
            "Groups are searched for without it.",
        ),
    ] = None,
    count: Annotated[
        int | None,
        typer.Option(metavar="N", help="Bars in a group, for the search; counted without it."),
    ] = None,
    dark: DarkOption = None,
    bright: BrightOption = None,
    level_std: LevelStdOption = 0.0,
    robust: RobustOption = True,
    wanted: ResultOptions,
) -> None:
    """Measure the MTF on groups of parallel bars, as wide as the gaps between them.

    All groups are fitted together as what they are: finite square waves of different periods.
    The contrast of every group (CTF) and Coltman's series are given for comparison.
    """
    _require_bars("--count", count)
    measure_target(
        KINDS["bars"],
        image,
        pixels,
        wanted,
        options={
            "groups": tuple(parse_group(text) for text in group or []),
            "count": count,
            "dark": dark,
            "bright": bright,
            "level_std": level_std,
            "robust": robust,
        },
    )


def parse_group(text: str) -> Bars:
    """The value of ``--group``.

    Raises
    ------
    OptionError
        If it is not six numbers, or the number of bars is not a whole one above 1.
    """
    from acutance.geometry.bar_group import Bars

    numbers = numbers_of(text)
    if len(numbers) != _PARTS or not numbers[4].is_integer():
        raise OptionError(
            f"--group {text}: write ROW,COL,ANGLE,PERIOD,COUNT,LENGTH, as in --group "
            "40.5,31,6,8,5,24"
        )
    row, col, angle, period, count, length = numbers
    _require_bars(f"--group {text}: COUNT", count)
    return Bars(row, col, angle, period, int(count), length)


def _require_bars(option: str, count: float | None) -> None:
    if count is not None and count < 2:
        raise OptionError(
            f"{option} is {count:g}, a group has 2 bars or more; a single bar is a pulse, which "
            "acutance pulse measures"
        )
