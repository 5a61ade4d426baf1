"""``acutance bars``: measure groups of bars."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.choices import change_limits
from acutance.cli.faces import faces_of_plane
from acutance.cli.result_options import (
    CovarianceOption,
    CsvOption,
    FigureOption,
    JsonOption,
    LimitOption,
    ReportOption,
    ResultOptions,
    StrictOption,
)
from acutance.cli.star import BrightOption, DarkOption, LevelStdOption
from acutance.cli.target import (
    BandOption,
    GsdOption,
    ImageArgument,
    NodataOption,
    RoiOption,
    SiteOption,
    open_target,
)
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.geometry.bar_group import Bars

__all__ = ["EXAMPLE", "bars", "parse_group"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance bars target.tif --count 5 --figure bars.png --report bars.html\n"
    "  acutance bars target.tif --group 40,31,6,8,5,24 --group 74,31,6,4,5,24 --json"
)
_PARTS = 6


def bars(
    image: ImageArgument,
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
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    nodata: NodataOption = None,
    gsd: GsdOption = None,
    robust: Annotated[bool, typer.Option(help="Bound the weight of outlying pixels.")] = True,
    figure: FigureOption = None,
    report: ReportOption = None,
    csv: CsvOption = None,
    as_json: JsonOption = False,
    covariance: CovarianceOption = False,
    limit: LimitOption = None,
    strict: StrictOption = False,
) -> None:
    """Measure the MTF on groups of parallel bars, as wide as the gaps between them.

    All groups are fitted together as what they are: finite square waves of different periods.
    The contrast of every group (CTF) and Coltman's series stand beside the result.
    """
    wanted = ResultOptions(
        (image, roi),
        figure=figure,
        report=report,
        csv=csv,
        as_json=as_json,
        covariance=covariance,
        strict=strict,
    )

    from acutance.targets.periodic import BarsLimits, BarsOptions, measure_bars

    _require_bars("--count", count)
    options = BarsOptions(
        groups=tuple(parse_group(text) for text in group or []),
        count=count,
        dark=dark,
        bright=bright,
        level_std=level_std,
        robust=robust,
        limits=change_limits(BarsLimits(), limit or []),
    )
    source, region = open_target(image, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata)
    measurement = measure_bars(source, region, options=options)

    from acutance import report as faces

    shown = faces_of_plane(
        measurement,
        panels=faces.bars_panels,
        sections=faces.bars_sections,
        blocks=faces.bars_blocks,
    )
    wanted.deliver([measurement], replace(shown, csv=lambda: faces.bars_csv(measurement)))


def parse_group(text: str) -> Bars:
    """The value of ``--group``.

    Raises
    ------
    OptionError
        If it is not six numbers, or the number of bars is not a whole one above 1.
    """
    from acutance.geometry.bar_group import Bars

    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
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
