"""``acutance biresolution``: measure a sensor against a finer image of the same ground."""

from __future__ import annotations

import json
from pathlib import Path
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
from acutance.cli.target import (
    BandOption,
    GsdOption,
    NodataOption,
    RoiOption,
    SiteOption,
    open_target,
)
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.targets.pair.reference import ReferenceLike

__all__ = ["EXAMPLE", "biresolution", "parse_reference"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance biresolution b8a-20m.tif b8-10m.tif --reference 0.26 --report pair.html\n"
    "  acutance biresolution low.tif high.tif --ratio 4 --reference high-sensor.toml --json"
)


def biresolution(
    low: Annotated[str, typer.Argument(metavar="LOW", help="The image whose sensor is measured.")],
    high: Annotated[
        str, typer.Argument(metavar="HIGH", help="A finer image of the same ground and band.")
    ],
    ratio: Annotated[
        float | None,
        typer.Option(
            metavar="R",
            help="GSD of the low image over that of the high one; without it, that of the "
            "geotransforms or of the shapes.",
        ),
    ] = None,
    reference: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|M",
            help="MTF of the high image: a sensor (.toml), a measurement (.json), or its value at "
            "the high image's Nyquist frequency. Without it the result is MTF_low / MTF_high.",
        ),
    ] = None,
    roi: RoiOption = None,
    site: SiteOption = None,
    band: BandOption = 1,
    high_band: Annotated[
        int, typer.Option(metavar="N", help="Which band of the high image, from 1.")
    ] = 1,
    nodata: NodataOption = None,
    high_nodata: Annotated[
        float | None,
        typer.Option(metavar="VALUE", help="The same of the high image."),
    ] = None,
    gsd: GsdOption = None,
    method: Annotated[
        str, typer.Option(metavar="METHOD", help="kernel-fit (the reference) or spectral-ratio.")
    ] = "kernel-fit",
    stop: Annotated[
        float,
        typer.Option(
            metavar="CHANGE", help="End the iterations at this relative change of the residual."
        ),
    ] = 1e-4,
    max_shift: Annotated[
        int, typer.Option(metavar="PX", help="Largest error of registration looked for.")
    ] = 8,
    high_noise: Annotated[
        float | None,
        typer.Option(metavar="DN", help="Noise of the high image; estimated without it."),
    ] = None,
    robust: Annotated[
        bool, typer.Option(help="Leave out what fits badly: clouds, changes, defects.")
    ] = True,
    figure: FigureOption = None,
    report: ReportOption = None,
    csv: CsvOption = None,
    as_json: JsonOption = False,
    covariance: CovarianceOption = False,
    limit: LimitOption = None,
    strict: StrictOption = False,
) -> None:
    """Measure the MTF of a sensor from two images of the same ground at two resolutions.

    No target is needed: roads, shores, buildings, fields. Frequencies are in cycles per pixel of
    the LOW image. Shift, gain and offset between the two are fitted.
    """
    wanted = ResultOptions(
        (low, high, reference, roi),
        figure=figure,
        report=report,
        csv=csv,
        as_json=as_json,
        covariance=covariance,
        strict=strict,
    )

    from acutance.raster import open_image
    from acutance.targets.pair import BiresolutionLimits, BiresolutionOptions, measure_biresolution

    options = BiresolutionOptions(
        stop_change=stop,
        max_shift_px=max_shift,
        noise_high=high_noise,
        robust=robust,
        limits=change_limits(BiresolutionLimits(), limit or []),
    )
    known = parse_reference(reference)
    source, region = open_target(low, band=band, gsd=gsd, roi=roi, site=site, nodata=nodata)
    measurement = measure_biresolution(
        source,
        open_image(high, high_band, nodata=high_nodata),
        ratio=ratio,
        roi=region,
        reference_mtf=known,
        method=method,
        options=options,
    )

    from acutance import report as faces

    shown = faces_of_plane(
        measurement,
        panels=faces.biresolution_panels,
        sections=faces.biresolution_sections,
        blocks=faces.biresolution_blocks,
    )
    wanted.deliver([measurement], shown)


def parse_reference(text: str | None) -> ReferenceLike:
    """The value of ``--reference``: a sensor, a measurement, or a number.

    Raises
    ------
    OptionError
        If it is none of them.
    """
    if text is None:
        return None
    ending = Path(text).suffix.lower()
    if ending == ".toml":
        from acutance.optics import read_sensor

        return read_sensor(text)
    if ending == ".json":
        from acutance.targets.pair import measured_reference

        try:
            document = json.loads(Path(text).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise OptionError(f"--reference {text} cannot be read ({error})") from error
        return measured_reference(document, f"--reference {text}")
    try:
        return float(text)
    except ValueError:
        raise OptionError(
            f"--reference {text}: give a sensor (.toml), a measurement (.json, written with "
            "--json), or the MTF at the high image's Nyquist frequency"
        ) from None
