"""The faces of a result: text, JSON, figure, report and CSV, each made only when asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from acutance.cli.output import OutputFile
from acutance.cli.terminal import command_line, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from acutance.curves.grid import Floats
    from acutance.report import PlanePanel
    from acutance.report.html import Section
    from acutance.targets import Measurement2d
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import TargetResult

__all__ = ["Faces", "deliver", "faces_by_method", "faces_of_plane", "faces_of_target"]

Plane = TypeVar("Plane", bound="Measurement2d")


@dataclass(frozen=True)
class Faces:
    """Ways to show one result, as functions without arguments but for the document's.

    Parameters
    ----------
    text, csv, report : function
        Give text.
    document : function of bool
        Gives the JSON document, with the covariance factors when its argument is true.
    figure : function
        Gives a matplotlib figure.
    """

    text: Callable[[], str]
    document: Callable[[bool], dict[str, Any]]
    figure: Callable[[], Figure]
    report: Callable[[], str]
    csv: Callable[[], str]


def _faces_of_one(measurement: Measurement) -> Faces:
    """Of a single target."""
    from acutance import report

    return Faces(
        text=lambda: report.text_report(measurement),
        document=lambda covariance: report.measurement_document(measurement, covariance=covariance),
        figure=lambda: report.edge_figure(measurement),
        report=lambda: report.edge_report(measurement, command=command_line()),
        csv=lambda: report.mtf_csv(measurement),
    )


def faces_by_method(measurements: Sequence[Measurement]) -> Faces:
    """Of one target by one method, or by several side by side."""
    if len(measurements) == 1:
        return _faces_of_one(measurements[0])
    return _faces_of_comparison(measurements)


def _faces_of_comparison(measurements: Sequence[Measurement]) -> Faces:
    """Of one target by several methods."""
    from acutance import report

    return Faces(
        text=lambda: report.comparison_text(measurements),
        document=lambda covariance: report.comparison_document(measurements, covariance=covariance),
        figure=lambda: report.comparison_figure(measurements),
        report=lambda: report.comparison_report(measurements, command=command_line()),
        csv=lambda: report.mtf_csv_of_many(measurements),
    )


def faces_of_target(result: TargetResult, backdrop: Floats, origin: tuple[int, int]) -> Faces:
    """Of all edges of a target; `backdrop` are its pixels, `origin` the first one's place."""
    from acutance import report

    return Faces(
        text=lambda: report.target_text(result),
        document=lambda covariance: report.target_document(result, covariance=covariance),
        figure=lambda: report.target_figure(result, backdrop=backdrop, origin=origin),
        report=lambda: report.target_report(
            result, backdrop=backdrop, origin=origin, command=command_line()
        ),
        csv=lambda: report.mtf_csv_of_many(result.measurements),
    )


def faces_of_plane(
    measurement: Plane,
    *,
    panels: Callable[[Plane], Sequence[PlanePanel]],
    sections: Callable[[Plane], Sequence[Section]],
    blocks: Callable[[Plane], Sequence[str]],
) -> Faces:
    """Of a 2-D measurement, with what its method adds to the figure, the report and the text."""
    from acutance import report

    return Faces(
        text=lambda: report.plane_text(measurement, blocks(measurement)),
        document=lambda covariance: report.plane_document(measurement, covariance=covariance),
        figure=lambda: report.plane_figure(measurement, panels(measurement)),
        report=lambda: report.plane_report(
            measurement,
            command=command_line(),
            extra_panels=panels(measurement),
            extra_sections=sections(measurement),
        ),
        csv=lambda: report.plane_csv(measurement),
    )


def deliver(
    faces: Faces,
    *,
    figure: OutputFile | None,
    report: OutputFile | None,
    csv: OutputFile | None,
    as_json: bool,
    covariance: bool,
) -> None:
    """Write the files that were asked for, then print the text or the JSON document."""
    from acutance.report import json_text
    from acutance.report.page import figure_bytes

    if figure is not None:
        _write(figure, figure_bytes(faces.figure(), figure.ending))
    if report is not None:
        _write(report, faces.report())
    if csv is not None:
        _write(csv, faces.csv())
    typer.echo(json_text(faces.document(covariance)) if as_json else faces.text())


def _write(target: OutputFile, content: str | bytes) -> None:
    target.write(content)
    say(f"wrote {target.path}")
