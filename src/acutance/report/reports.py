"""Whole HTML reports: a title over the sections of what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.html import render_report
from acutance.report.sections import comparison_sections, edge_sections, target_sections
from acutance.report.wording import count_edges, describe_image

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import TargetResult

__all__ = ["comparison_report", "edge_report", "target_report"]


def edge_report(measurement: Measurement, *, command: str | None = None) -> str:
    """A measurement as one HTML page.

    Parameters
    ----------
    measurement : Measurement
    command : str, optional
        The command line that produced it; made up from the measurement when not given.
    """
    title = f"{measurement.kind.capitalize()} measurement, {measurement.orientation}"
    return render_report(title, describe_image(measurement), edge_sections(measurement, command))


def comparison_report(
    measurements: Sequence[Measurement],
    *,
    truth: Response | None = None,
    true_width_px: float | None = None,
    command: str | None = None,
) -> str:
    """Several measurements of one target as one HTML page, with the truth where it is known.

    `truth` and `true_width_px` are those of `comparison_figure`.
    """
    sections = comparison_sections(
        measurements, truth=truth, true_width_px=true_width_px, command=command
    )
    return render_report("Methods compared", describe_image(measurements[0]), sections)


def target_report(
    result: TargetResult,
    *,
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
    command: str | None = None,
) -> str:
    """All edges of a target as one HTML page.

    `backdrop` and `origin` are those of `target_figure`.
    """
    sections = target_sections(result, backdrop=backdrop, origin=origin, command=command)
    count = len(result.measurements)
    title = f"{count_edges(count)} of one target"
    image = result.measurements[0].image
    return render_report(title, f"{image.path or 'array in memory'}, band {image.band}", sections)
