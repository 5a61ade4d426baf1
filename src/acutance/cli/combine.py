"""``acutance combine``: many measurements of one sensor become one 2-D OTF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from acutance.cli.choices import numbers_of
from acutance.cli.documents import read_json
from acutance.cli.option_groups import with_groups
from acutance.cli.options import GsdOption, ResultOptions, parse_gsd
from acutance.cli.results import Outputs, Shown
from acutance.errors import OptionError

__all__ = ["EXAMPLE", "combine"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance simulate site --out site.tif\n"
    "  acutance edge site.tif --roi 34,30,33,61 --json > across.json\n"
    "  acutance edge site.tif --roi 122,31,58,29 --json > along.json\n"
    "  acutance points site.tif --roi 10,160,120,50 --json > mirrors.json\n"
    "  acutance combine across.json along.json mirrors.json --report sensor.html\n"
    '  acutance combine edges.json --leave-out "edges.json north"'
)


@dataclass(frozen=True)
class _OneResult(ResultOptions):
    """What is asked of the one result that there is."""

    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the result: .png, .svg or .pdf.")
    ] = None
    report: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a self-contained page: .html.")
    ] = None
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the MTF in steps of 0.02 c/px: .csv."),
    ] = None


@with_groups
def combine(
    *,
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="Measurements as JSON, written by a measuring command."
        ),
    ],
    leave_out: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Leave out the measurement that has this name in the result, also one of a file "
            "of many; may be repeated.",
        ),
    ] = None,
    gsd: GsdOption = None,
    detector: Annotated[
        str,
        typer.Option(metavar="PX|ACROSS,ALONG", help="Width of the detector in pixels."),
    ] = "1",
    wanted: _OneResult,
) -> None:
    """Combine measurements of one sensor into one 2-D OTF: across and along exactly.

    Edges and pulses of several directions, points, stars, bars and pairs of images are fitted
    together by a parametric sensor; a chi-square shows whether they agree.
    """
    outputs = Outputs.checked(wanted, files)
    documents = [read_json(name) for name in files]

    from acutance.targets.combine import CombineOptions
    from acutance.targets.combine import combine as combine_measurements

    options = CombineOptions(detector_px=_parse_detector(detector), limits=wanted.limits)
    measurement = combine_measurements(
        documents, names=files, leave_out=leave_out or (), gsd_m=parse_gsd(gsd), options=options
    )
    outputs.deliver(Shown(measurement))


def _parse_detector(text: str) -> tuple[float, float]:
    widths = numbers_of(text)
    if len(widths) not in (1, 2):
        raise OptionError(
            f"--detector {text}: write one width in pixels (1), or those across and along (1,0.9)"
        )
    return widths[0], widths[-1]
