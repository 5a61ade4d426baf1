"""``acutance edge``: measure a straight edge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.faces import (
    Faces,
    deliver,
    faces_of_comparison,
    faces_of_edge,
    faces_of_target,
)
from acutance.cli.output import OutputFile, check_output
from acutance.cli.target import (
    BandOption,
    GsdOption,
    ImageArgument,
    RoiOption,
    SiteOption,
    open_target,
)
from acutance.cli.terminal import FAILED_CHECK, say
from acutance.errors import NoEdgeError, OptionError

if TYPE_CHECKING:
    from acutance.curves.metrics import RerCentre
    from acutance.measure import EdgeOptions
    from acutance.measure.measurement import Measurement
    from acutance.raster import Image, Region

__all__ = ["EXAMPLE", "edge"]

EXAMPLE = "\b\nExample:\n  acutance edge scene.tif --roi 120,340,40,40 --gsd 0.7 --report edge.html"
RER_CENTRES: dict[str, RerCentre] = {"half": "half", "peak": "peak"}
METHODS_HELP = "spline (the reference), sdsu-2005, kompsat-2014, iso12233 or fermi"


def edge(
    image: ImageArgument,
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    gsd: GsdOption = None,
    method: Annotated[str, typer.Option(metavar="METHOD", help=f"{METHODS_HELP}.")] = "spline",
    compare: Annotated[
        str | None,
        typer.Option(
            metavar="METHOD,...", help="Measure by these methods too, and set them side by side."
        ),
    ] = None,
    all_edges: Annotated[
        bool, typer.Option("--all", help="Find and measure every edge of the region.")
    ] = False,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the steps: .png, .svg or .pdf.")
    ] = None,
    report: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a self-contained page: .html.")
    ] = None,
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the MTF in steps of 0.02 c/px: .csv."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the JSON document, and nothing else, to stdout.")
    ] = False,
    covariance: Annotated[
        bool, typer.Option("--covariance", help="With --json: add the covariance factors.")
    ] = False,
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Ask more or less of a check; repeatable."),
    ] = None,
    rer_centre: Annotated[
        str | None,
        typer.Option(
            metavar="half|peak",
            help="Centre RER on the 50 % point or on the peak of the LSF; without it as the "
            "method does.",
        ),
    ] = None,
    robust: Annotated[
        bool, typer.Option(help="Bound the weight of outlying pixels (method spline).")
    ] = True,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with code 3 when a check failed.")
    ] = False,
) -> None:
    """Measure MTF, RER and FWHM on a straight edge.

    Every number comes with its standard deviation and 95 % interval.
    """
    if all_edges and compare is not None:
        raise OptionError("--all and --compare cannot be combined: use one of them")
    if covariance and not as_json:
        raise OptionError("--covariance belongs to the JSON document: add --json")
    files = {
        "figure": _checked("--figure", figure, (".png", ".svg", ".pdf"), image),
        "report": _checked("--report", report, (".html",), image),
        "csv": _checked("--csv", csv, (".csv",), image),
    }
    methods = _methods(method, compare)
    options = _edge_options(limit or [], rer_centre, robust)
    source, region = open_target(image, band=band, gsd=gsd, roi=roi, site=site)
    if all_edges:
        measurements, faces = _measure_all(source, region, method, options)
    else:
        measurements, faces = _measure_by(source, region, methods, options)
    deliver(faces, **files, as_json=as_json, covariance=covariance)
    failed = sum(not one.trusted for one in measurements)
    if strict and failed:
        say(f"acutance: a check failed in {failed} of {len(measurements)} measurements")
        raise typer.Exit(FAILED_CHECK)


def _checked(
    option: str, name: str | None, endings: Sequence[str], image: str
) -> OutputFile | None:
    return None if name is None else check_output(option, name, endings, keep=image)


def _methods(first: str, compare: str | None) -> list[str]:
    """The methods to measure by, each once, all of them known."""
    from acutance.measure import METHODS

    others = [name.strip() for name in (compare or "").split(",")]
    wanted = list(dict.fromkeys([first, *(name for name in others if name)]))
    for name in wanted:
        if name not in METHODS:
            raise OptionError(f"there is no method {name!r}: choose from {', '.join(METHODS)}")
    return wanted


def _edge_options(limits: Sequence[str], rer_centre: str | None, robust: bool) -> EdgeOptions:
    """The options of the measurement, its limits changed as ``--limit`` asks."""
    from acutance.measure import EdgeLimits, EdgeOptions

    if rer_centre is not None and rer_centre not in RER_CENTRES:
        raise OptionError(f"--rer-centre {rer_centre}: it has to be half or peak")
    defaults = EdgeLimits()
    known = {field.name for field in fields(defaults)}
    changed = dict(_parse_limit(text, known) for text in limits)
    return EdgeOptions(
        rer_centre=None if rer_centre is None else RER_CENTRES[rer_centre],
        robust=robust,
        limits=replace(defaults, **changed),
    )


def _parse_limit(text: str, known: set[str]) -> tuple[str, float]:
    asked, _, number = text.partition("=")
    # A limit holds for both sides: the names of a side's check are understood too.
    name = asked.replace("_dark", "").replace("_bright", "")
    if name not in known:
        raise OptionError(f"--limit {text}: the limits are {', '.join(sorted(known))}")
    try:
        return name, float(number)
    except ValueError as error:
        raise OptionError(f"--limit {text}: write a number, as in {name}=10") from error


def _measure_by(
    image: Image, region: Region | None, methods: Sequence[str], options: EdgeOptions
) -> tuple[Sequence[Measurement], Faces]:
    from acutance.measure import measure_edge

    measurements = [
        measure_edge(image, region, method=method, options=options) for method in methods
    ]
    if len(measurements) == 1:
        return measurements, faces_of_edge(measurements[0])
    return measurements, faces_of_comparison(measurements)


def _measure_all(
    image: Image, region: Region | None, method: str, options: EdgeOptions
) -> tuple[Sequence[Measurement], Faces]:
    from acutance.measure import measure_edges
    from acutance.raster import Box

    result = measure_edges(image, region, method=method, options=options)
    if not result.measurements:
        tried = len(result.rejected)
        why = f"; of {tried} tried the first: {result.rejected[0].reason}" if tried else ""
        raise NoEdgeError(
            f"no edge of {image.path} could be measured{why}. Choose a region around one target"
        )
    box = Box.whole(image.shape) if region is None else region.box(image.shape)
    return result.measurements, faces_of_target(result, image.read(box), (box.row, box.col))
