"""``acutance pulse``: measure a pulse between two plateaus."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import choose_methods, choose_rer_centre
from acutance.cli.measure import measure_target
from acutance.cli.option_groups import with_groups
from acutance.cli.options import (
    CompareOption,
    ImageArgument,
    PixelOptions,
    RerCentreOption,
    ResultOptions,
    RobustOption,
    StatedOptions,
    method_option,
)
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

if TYPE_CHECKING:
    from acutance.raster import Image

__all__ = ["EXAMPLE", "pulse"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate site --out site.tif\n"
    "  acutance pulse site.tif --roi 122,93,57,36 --width-m 3 --report pulse.html"
)
KIND = KINDS["pulse"]


@with_groups
def pulse(
    *,
    image: ImageArgument,
    pixels: PixelOptions,
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
    method: Annotated[str, method_option("pulse")] = KIND.methods[0],
    compare: CompareOption = None,
    rer_centre: RerCentreOption = None,
    robust: RobustOption = True,
    stated: StatedOptions,
    wanted: ResultOptions,
) -> None:
    """Measure MTF, RER and FWHM on a pulse: a tarp on grass, a bridge, a painted stripe.

    Every number comes with its standard deviation and 95 % interval; so does the width of the
    target, which is fitted from the stated one, or from what the image shows.
    """
    if width_m is not None and width_px is not None:
        raise OptionError("--width-m and --width-px both state the width: give one of them")
    if hold_width and width_m is None and width_px is None:
        raise OptionError("--hold-width needs a width: add --width-m or --width-px")

    def stated_width(image: Image) -> Mapping[str, Any]:
        if width_m is not None and image.gsd() is None:
            raise OptionError(
                "--width-m needs a GSD, and the image has none: add --gsd or --width-px"
            )
        return {"width_px": width_px, "width_m": width_m, "fit_width": not hold_width}

    measure_target(
        KIND,
        image,
        pixels,
        wanted,
        methods=choose_methods(method, compare, KIND.methods),
        options={"rer_centre": choose_rer_centre(rer_centre), "robust": robust, **stated.fields},
        arguments=stated_width,
    )
