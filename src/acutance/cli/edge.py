"""``acutance edge``: measure a straight edge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.choices import change_limits, choose_methods, choose_rer_centre
from acutance.cli.faces import Faces, faces_by_method, faces_of_target
from acutance.cli.result_options import (
    CompareOption,
    CovarianceOption,
    CsvOption,
    FigureOption,
    JsonOption,
    LimitOption,
    ReportOption,
    RerCentreOption,
    ResultOptions,
    RobustOption,
    StrictOption,
)
from acutance.cli.target import (
    AlongTrackOption,
    BandOption,
    GsdOption,
    ImageArgument,
    NodataOption,
    RoiOption,
    SiteOption,
    open_target,
)
from acutance.errors import NoEdgeError, OptionError

if TYPE_CHECKING:
    from acutance.raster import Image, Region
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import EdgeOptions

__all__ = ["EXAMPLE", "edge"]

EXAMPLE = "\b\nExample:\n  acutance edge scene.tif --roi 120,340,40,40 --gsd 0.7 --report edge.html"
METHODS_HELP = "spline (the reference), sdsu-2005, kompsat-2014, iso12233 or fermi"


def edge(
    image: ImageArgument,
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    nodata: NodataOption = None,
    gsd: GsdOption = None,
    along_track: AlongTrackOption = "y",
    method: Annotated[str, typer.Option(metavar="METHOD", help=f"{METHODS_HELP}.")] = "spline",
    compare: CompareOption = None,
    all_edges: Annotated[
        bool, typer.Option("--all", help="Find and measure every edge of the region.")
    ] = False,
    figure: FigureOption = None,
    report: ReportOption = None,
    csv: CsvOption = None,
    as_json: JsonOption = False,
    covariance: CovarianceOption = False,
    limit: LimitOption = None,
    rer_centre: RerCentreOption = None,
    robust: RobustOption = True,
    strict: StrictOption = False,
) -> None:
    """Measure MTF, RER and FWHM on a straight edge.

    Every number comes with its standard deviation and 95 % interval.
    """
    if all_edges and compare is not None:
        raise OptionError("--all and --compare cannot be combined: use one of them")
    wanted = ResultOptions(
        (image, roi),
        figure=figure,
        report=report,
        csv=csv,
        as_json=as_json,
        covariance=covariance,
        strict=strict,
    )

    from acutance.targets.straight import METHODS, EdgeLimits, EdgeOptions, measure_edge

    methods = choose_methods(method, compare, METHODS)
    options = EdgeOptions(
        rer_centre=choose_rer_centre(rer_centre),
        robust=robust,
        limits=change_limits(EdgeLimits(), limit or []),
    )
    source, region = open_target(
        image, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata, along_track=along_track
    )
    if all_edges:
        wanted.deliver(*_measure_all(source, region, method, options))
        return
    measurements = [measure_edge(source, region, method=name, options=options) for name in methods]
    wanted.deliver(measurements, faces_by_method(measurements))


def _measure_all(
    image: Image, region: Region | None, method: str, options: EdgeOptions
) -> tuple[Sequence[Measurement], Faces]:
    from acutance.raster import Box
    from acutance.targets.straight import measure_edges

    result = measure_edges(image, region, method=method, options=options)
    if not result.measurements:
        tried = len(result.rejected)
        why = f"; of {tried} tried the first: {result.rejected[0].reason}" if tried else ""
        raise NoEdgeError(
            f"no edge of {image.path} could be measured{why}. Choose a region around one target"
        )
    box = Box.whole(image.shape) if region is None else region.box(image.shape)
    return result.measurements, faces_of_target(result, image.read(box), (box.row, box.col))
