"""The options that say what becomes of a result, shared by every measuring command."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.faces import Faces, deliver
from acutance.cli.output import check_optional
from acutance.cli.terminal import FAILED_CHECK, say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.targets import Measurement2d
    from acutance.targets.measurement import Measurement

__all__ = [
    "CompareOption",
    "CovarianceOption",
    "CsvOption",
    "FigureOption",
    "JsonOption",
    "LimitOption",
    "ReportOption",
    "RerCentreOption",
    "ResultOptions",
    "RobustOption",
    "StrictOption",
]

CompareOption = Annotated[
    str | None,
    typer.Option(
        metavar="METHOD,...", help="Measure by these methods too, and set them side by side."
    ),
]
FigureOption = Annotated[
    str | None, typer.Option(metavar="FILE", help="Draw the steps: .png, .svg or .pdf.")
]
ReportOption = Annotated[
    str | None, typer.Option(metavar="FILE", help="Write a self-contained page: .html.")
]
CsvOption = Annotated[
    str | None, typer.Option(metavar="FILE", help="Write the MTF in steps of 0.02 c/px: .csv.")
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the JSON document, and nothing else, to stdout.")
]
CovarianceOption = Annotated[
    bool, typer.Option("--covariance", help="With --json: add the covariance factors.")
]
LimitOption = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=VALUE", help="Ask more or less of a check; repeatable."),
]
RerCentreOption = Annotated[
    str | None,
    typer.Option(
        metavar="half|peak",
        help="Centre RER on the 50 % point or on the peak of the LSF; without it as the "
        "method does.",
    ),
]
RobustOption = Annotated[
    bool, typer.Option(help="Bound the weight of outlying pixels (method spline).")
]
StrictOption = Annotated[
    bool, typer.Option("--strict", help="Exit with code 3 when a check failed.")
]


class ResultOptions:
    """Where a result goes, found possible before any work is done for it.

    Parameters
    ----------
    inputs : iterable of str or None
        What the command reads, files or not: no output may overwrite a file of them.
    figure, report, csv : str or None
        Names of the files asked for.
    as_json, covariance, strict : bool

    Raises
    ------
    OptionError
        If a file cannot be written, or the options contradict each other.
    """

    def __init__(
        self,
        inputs: Iterable[str | None],
        *,
        figure: str | None,
        report: str | None,
        csv: str | None,
        as_json: bool,
        covariance: bool,
        strict: bool,
    ) -> None:
        if covariance and not as_json:
            raise OptionError("--covariance belongs to the JSON document: add --json")
        kept = tuple(inputs)
        self.figure = check_optional("--figure", figure, (".png", ".svg", ".pdf"), keep=kept)
        self.report = check_optional("--report", report, (".html",), keep=kept)
        self.csv = check_optional("--csv", csv, (".csv",), keep=kept)
        self.as_json, self.covariance, self.strict = as_json, covariance, strict

    def deliver(self, measurements: Sequence[Measurement | Measurement2d], faces: Faces) -> None:
        """Write and print what was asked for; under ``--strict`` a failed check is exit code 3."""
        deliver(
            faces,
            figure=self.figure,
            report=self.report,
            csv=self.csv,
            as_json=self.as_json,
            covariance=self.covariance,
        )
        failed = sum(not one.trusted for one in measurements)
        if self.strict and failed:
            say(f"acutance: a check failed in {failed} of {len(measurements)} measurements")
            raise typer.Exit(FAILED_CHECK)
