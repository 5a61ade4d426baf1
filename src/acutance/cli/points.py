"""``acutance points``: measure mirrors, lamps or stars."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.choices import change_limits, choose_methods
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

__all__ = ["EXAMPLE", "points"]

EXAMPLE = (
    "\b\nExample:\n"
    "  acutance points mirrors.tif --positions mirrors.csv --surveyed mirrors.csv --gsd 0.7 "
    "--report mirrors.html"
)


def points(
    image: ImageArgument,
    positions: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Approximate places of the sources: CSV (row,col or lon,lat or x,y) or GeoJSON. "
            "Found in the image without it.",
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
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    nodata: NodataOption = None,
    gsd: GsdOption = None,
    method: Annotated[
        str, typer.Option(metavar="METHOD", help="psf-fit (the reference) or gaussian-2003.")
    ] = "psf-fit",
    min_snr: Annotated[
        float, typer.Option(metavar="RATIO", help="Least peak of a source over the noise.")
    ] = 10.0,
    min_distance: Annotated[
        float, typer.Option(metavar="PX", help="Least distance to another bright source.")
    ] = 4.0,
    radius: Annotated[
        float, typer.Option(metavar="PX", help="Use the pixels up to this distance.")
    ] = 13.0,
    robust: Annotated[
        bool, typer.Option(help="Bound the weight of outlying pixels (method psf-fit).")
    ] = True,
    figure: FigureOption = None,
    report: ReportOption = None,
    csv: CsvOption = None,
    as_json: JsonOption = False,
    covariance: CovarianceOption = False,
    limit: LimitOption = None,
    strict: StrictOption = False,
) -> None:
    """Measure PSF, MTF, RER and FWHM across and along on points: mirrors, lamps, stars.

    One joint fit gives every source its place, light and background, and all of them one PSF;
    every number comes with its standard deviation and 95 % interval. What does not serve
    (saturated, blended, hot pixels, cosmic rays) is left out and named.
    """
    wanted = ResultOptions(
        (image, positions, surveyed, roi),
        figure=figure,
        report=report,
        csv=csv,
        as_json=as_json,
        covariance=covariance,
        strict=strict,
    )
    if survey_reference not in ("mean", "first"):
        raise OptionError(f"--survey-reference {survey_reference}: it has to be mean or first")

    from acutance.raster import read_positions
    from acutance.targets.points import POINTS_METHODS, PointsLimits, PointsOptions, measure_points

    choose_methods(method, None, POINTS_METHODS)
    options = PointsOptions(
        min_snr=min_snr,
        min_distance_px=min_distance,
        radius_px=radius,
        robust=robust,
        limits=change_limits(PointsLimits(), limit or []),
    )
    source, region = open_target(image, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata)
    measurement = measure_points(
        source,
        region,
        positions=None if positions is None else read_positions(positions, source),
        surveyed=None if surveyed is None else read_positions(surveyed, source),
        survey_reference="first" if survey_reference == "first" else "mean",
        method=method,
        options=options,
    )

    from acutance import report as faces

    wanted.deliver(
        [measurement],
        faces_of_plane(
            measurement,
            panels=faces.points_panels,
            sections=faces.points_sections,
            blocks=faces.points_blocks,
        ),
    )
