"""``acutance pulse``: measure a strip between two grounds."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.choices import change_limits, choose_methods, choose_rer_centre
from acutance.cli.faces import faces_by_method
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
from acutance.errors import OptionError

__all__ = ["EXAMPLE", "pulse"]

EXAMPLE = (
    "\b\nExample:\n"
    "  acutance pulse scene.tif --roi 80,210,60,40 --width-m 8.83 --gsd 2.8 --report pulse.html"
)
METHODS_HELP = "spline (the reference) or sdsu-2005"


def pulse(
    image: ImageArgument,
    width_m: Annotated[
        float | None,
        typer.Option(metavar="M", help="Width of the target along its normal, in metres."),
    ] = None,
    width_px: Annotated[
        float | None, typer.Option(metavar="PX", help="The same in pixels.")
    ] = None,
    hold_width: Annotated[
        bool,
        typer.Option(
            "--hold-width", help="Take the stated width as it is; without it, it is fitted too."
        ),
    ] = False,
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    nodata: NodataOption = None,
    gsd: GsdOption = None,
    along_track: AlongTrackOption = "y",
    method: Annotated[str, typer.Option(metavar="METHOD", help=f"{METHODS_HELP}.")] = "spline",
    compare: CompareOption = None,
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
    """Measure MTF, RER and FWHM on a pulse: a tarp on grass, a bridge, a painted stripe.

    Every number comes with its standard deviation and 95 % interval; so does the width of the
    target, which is fitted from the stated one, or from what the image shows.
    """
    if width_m is not None and width_px is not None:
        raise OptionError("--width-m and --width-px both state the width: give one of them")
    if hold_width and width_m is None and width_px is None:
        raise OptionError("--hold-width needs a width: add --width-m or --width-px")
    wanted = ResultOptions(
        (image, roi),
        figure=figure,
        report=report,
        csv=csv,
        as_json=as_json,
        covariance=covariance,
        strict=strict,
    )

    from acutance.targets.straight import PULSE_METHODS, PulseLimits, PulseOptions, measure_pulse

    methods = choose_methods(method, compare, PULSE_METHODS)
    options = PulseOptions(
        rer_centre=choose_rer_centre(rer_centre),
        robust=robust,
        limits=change_limits(PulseLimits(), limit or []),
    )
    source, region = open_target(
        image, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata, along_track=along_track
    )
    if width_m is not None and source.gsd() is None:
        raise OptionError("--width-m needs a GSD, and the image has none: add --gsd or --width-px")
    measurements = [
        measure_pulse(
            source,
            region,
            width_px=width_px,
            width_m=width_m,
            fit_width=not hold_width,
            method=name,
            options=options,
        )
        for name in methods
    ]
    wanted.deliver(measurements, faces_by_method(measurements))
