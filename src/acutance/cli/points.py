"""``acutance points``: measure mirrors, lamps or stars."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import choose_methods
from acutance.cli.measure import measure_target
from acutance.cli.option_groups import with_groups
from acutance.cli.options import (
    ImageArgument,
    PixelOptions,
    ResultOptions,
    RobustOption,
    method_option,
)
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

if TYPE_CHECKING:
    from acutance.raster import Image

__all__ = ["EXAMPLE", "points"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate points --peak 1500 --snr 80 --out mirrors.tif\n"
    "  acutance points mirrors.tif --report mirrors.html\n"
    "  acutance points field.tif --positions places.csv --surveyed survey.csv --gsd 0.7"
)
KIND = KINDS["points"]


@with_groups
def points(
    *,
    image: ImageArgument,
    pixels: PixelOptions,
    positions: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Approximate places of the sources: CSV (row,col or lon,lat or x,y), GeoJSON, or "
            "the truth of a simulation. Found in the image without it.",
        ),
    ] = None,
    surveyed: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Surveyed places: what the measured ones are compared with."
        ),
    ] = None,
    survey_reference: Annotated[
        str,
        typer.Option(
            metavar="mean|first",
            help="Take the mean difference out, or that of the first source (report of 2003).",
        ),
    ] = "mean",
    method: Annotated[str, method_option("points")] = KIND.methods[0],
    min_snr: Annotated[
        float,
        typer.Option(
            metavar="RATIO",
            help="Minimum peak of a bright spot over the noise about it, before the fit.",
        ),
    ] = 10.0,
    min_distance: Annotated[
        float, typer.Option(metavar="PX", help="Minimum distance to another bright source.")
    ] = 4.0,
    radius: Annotated[
        float, typer.Option(metavar="PX", help="Use the pixels up to this distance.")
    ] = 13.0,
    robust: RobustOption = True,
    wanted: ResultOptions,
) -> None:
    """Measure PSF, MTF, RER and FWHM across and along on points: mirrors, lamps, stars.

    One joint fit gives every source its place, light and background, and all of them one PSF;
    every number comes with its standard deviation and 95 % interval. Sources that cannot be used
    (saturated, blended, hot pixels, cosmic rays) are left out and named.
    """
    if survey_reference not in ("mean", "first"):
        raise OptionError(f"--survey-reference {survey_reference}: it has to be mean or first")

    def places(image: Image) -> Mapping[str, Any]:
        from acutance.raster import read_positions

        return {
            "positions": None if positions is None else read_positions(positions, image),
            "surveyed": None if surveyed is None else read_positions(surveyed, image),
            "survey_reference": survey_reference,
        }

    measure_target(
        KIND,
        image,
        pixels,
        wanted,
        methods=choose_methods(method, None, KIND.methods),
        options={
            "min_snr": min_snr,
            "min_distance_px": min_distance,
            "radius_px": radius,
            "robust": robust,
        },
        arguments=places,
        inputs=(positions, surveyed),
    )
