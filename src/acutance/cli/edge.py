"""``acutance edge``: measure a straight edge."""

from __future__ import annotations

from typing import Annotated

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

__all__ = ["EXAMPLE", "edge"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate site --out site.tif\n"
    "  acutance edge site.tif --roi 34,30,33,61 --report edge.html\n"
    "  acutance edge site.tif --roi 34,30,33,61 --target-softness-m 0.05+-0.02"
)
KIND = KINDS["edge"]


@with_groups
def edge(
    *,
    image: ImageArgument,
    pixels: PixelOptions,
    method: Annotated[str, method_option("edge")] = KIND.methods[0],
    compare: CompareOption = None,
    all_edges: Annotated[
        bool,
        typer.Option(
            "--all",
            help="Find and measure every edge of the region's target: those with four fifths of "
            "the strongest edge's contrast or more. Edges of every contrast: acutance scan.",
        ),
    ] = False,
    rer_centre: RerCentreOption = None,
    robust: RobustOption = True,
    stated: StatedOptions,
    wanted: ResultOptions,
) -> None:
    """Measure MTF, RER and FWHM on a straight edge.

    Every number comes with its standard deviation and 95 % interval.
    """
    if all_edges and compare is not None:
        raise OptionError("--all and --compare cannot be combined: use one of them")
    measure_target(
        KIND,
        image,
        pixels,
        wanted,
        methods=choose_methods(method, compare, KIND.methods),
        measure_all=all_edges,
        options={"rer_centre": choose_rer_centre(rer_centre), "robust": robust, **stated.fields},
    )
