"""``acutance biresolution``: measure a sensor against a finer image of the same ground."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import choose_methods
from acutance.cli.measure import measure_target
from acutance.cli.named_bands import number_or_name
from acutance.cli.option_groups import with_groups
from acutance.cli.options import PixelOptions, ResultOptions, method_option
from acutance.cli.sensor import named_sensor
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

if TYPE_CHECKING:
    from acutance.raster import Image
    from acutance.targets.pair.reference import ReferenceLike

__all__ = ["EXAMPLE", "biresolution", "parse_reference"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance biresolution b8a-20m.tif b8-10m.tif --reference 0.26 --report pair.html\n"
    "  acutance biresolution low.tif high.tif --ratio 4 --reference high-sensor.toml --json"
)
KIND = KINDS["biresolution"]


@with_groups
def biresolution(
    *,
    low: Annotated[str, typer.Argument(metavar="LOW", help="The image whose sensor is measured.")],
    high: Annotated[
        str, typer.Argument(metavar="HIGH", help="A finer image of the same ground and band.")
    ],
    pixels: PixelOptions,
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
            metavar="FILE|NAME|M",
            help="MTF of the high image: a sensor (.toml, or its name), a measurement (.json), or "
            "its value at the high image's Nyquist frequency. Without it the result is MTF_low / "
            "MTF_high.",
        ),
    ] = None,
    high_band: Annotated[
        str,
        typer.Option(metavar="BAND", help="Which band of the high image: its number, or its name."),
    ] = "1",
    high_nodata: Annotated[
        float | None,
        typer.Option(metavar="VALUE", help="The same of the high image."),
    ] = None,
    method: Annotated[str, method_option("biresolution")] = KIND.methods[0],
    stop: Annotated[
        float,
        typer.Option(
            metavar="CHANGE", help="End the iterations at this relative change of the residual."
        ),
    ] = 1e-4,
    max_shift: Annotated[
        int, typer.Option(metavar="PX", help="Largest error of registration looked for, up to 48.")
    ] = 8,
    high_noise: Annotated[
        float | None,
        typer.Option(metavar="DN", help="Noise of the high image; estimated without it."),
    ] = None,
    robust: Annotated[
        bool, typer.Option(help="Leave out what fits badly: clouds, changes, defects.")
    ] = True,
    wanted: ResultOptions,
) -> None:
    """Measure the MTF of a sensor from two images of the same ground at two resolutions.

    No target is needed: roads, shores, buildings, fields. Frequencies are in cycles per pixel of
    the LOW image. Shift, gain and offset between the two are fitted. The options of pixels
    (--roi to --along-track) are those of the LOW image.
    """

    def finer_image(_: Image) -> Mapping[str, Any]:
        from acutance.raster import open_image

        return {
            "high": open_image(high, number_or_name(high_band), nodata=high_nodata),
            "ratio": ratio,
            "reference_mtf": parse_reference(reference),
        }

    measure_target(
        KIND,
        low,
        pixels,
        wanted,
        methods=choose_methods(method, None, KIND.methods),
        options={
            "stop_change": stop,
            "max_shift_px": max_shift,
            "noise_high": high_noise,
            "robust": robust,
        },
        arguments=finer_image,
        inputs=(high, reference),
    )


def parse_reference(text: str | None) -> ReferenceLike:
    """The value of ``--reference``: a sensor, a measurement, or a number.

    Raises
    ------
    OptionError
        If it is none of them.
    """
    if text is None:
        return None
    if Path(text).suffix.lower() == ".json":
        from acutance.targets.pair import measured_reference

        try:
            document = json.loads(Path(text).read_text(encoding="utf-8-sig"))
        except (OSError, ValueError) as error:
            raise OptionError(f"--reference {text} cannot be read ({error})") from error
        return measured_reference(document, f"--reference {text}")
    with suppress(ValueError):
        return float(text)
    try:
        return named_sensor(text)
    except OptionError as error:
        raise OptionError(
            f"--reference {text}: give a sensor (.toml, or its name), a measurement (.json, "
            f"written with --json), or the MTF at the high image's Nyquist frequency; {error}"
        ) from None
