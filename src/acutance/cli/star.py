"""``acutance star``: measure a Siemens star."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal, cast

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

__all__ = ["EXAMPLE", "BrightOption", "DarkOption", "LevelStdOption", "parse_place", "star"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance star baotou.tif --cycles 36 --wave square --dark 212 --bright 1187 "
    "--report star.html\n"
    "  acutance star chart.png --cycles count --figure star.png --json"
)

DarkOption = Annotated[
    float | None,
    typer.Option(
        metavar="DN",
        help="Level of a wide patch of the dark material, before blur. The contrast is fitted "
        "without --dark and --bright, which is less exact.",
    ),
]
BrightOption = Annotated[
    float | None, typer.Option(metavar="DN", help="Level of a wide patch of the bright material.")
]
LevelStdOption = Annotated[
    float, typer.Option(metavar="DN", help="Standard deviation of --bright less --dark.")
]


def star(
    image: ImageArgument,
    cycles: Annotated[
        str,
        typer.Option(
            metavar="K|count", help="Periods in a full turn, also of a fan; count: count them."
        ),
    ] = "36",
    wave: Annotated[str, typer.Option(metavar="sine|square", help="Form of the spokes.")] = "sine",
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
    """Measure the MTF of every direction and frequency on a Siemens star, full or a fan.

    Sine or square spokes; the centre is fitted. Spokes finer than two pixels are aliased: the fit
    knows it and uses them.
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

    from acutance.targets.periodic import StarLimits, StarOptions, measure_star

    options = StarOptions(
        wave=cast("Literal['sine', 'square']", wave),
        dark=dark,
        bright=bright,
        level_std=level_std,
        centre=None if centre is None else parse_place("--centre", centre),
        inner_px=inner,
        robust=robust,
        limits=change_limits(StarLimits(), limit or []),
    )
    known = _parse_cycles(cycles)
    source, region = open_target(image, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata)
    measurement = measure_star(source, region, cycles=known, options=options)

    from acutance import report as faces

    shown = faces_of_plane(
        measurement,
        panels=faces.star_panels,
        sections=faces.star_sections,
        blocks=faces.star_blocks,
    )
    wanted.deliver([measurement], replace(shown, csv=lambda: faces.star_csv(measurement)))


def _parse_cycles(text: str) -> int | None:
    """The value of ``--cycles``; None is to count them."""
    if text == "count":
        return None
    try:
        return int(text)
    except ValueError:
        raise OptionError(f"--cycles {text}: write a whole number, or count") from None


def parse_place(option: str, text: str) -> tuple[float, float]:
    """A place as ROW,COL.

    Raises
    ------
    OptionError
        If it is not two numbers.
    """
    try:
        row, col = (float(part) for part in text.split(","))
    except ValueError:
        raise OptionError(f"{option} {text}: write ROW,COL, as in {option} 63.5,64") from None
    return row, col
