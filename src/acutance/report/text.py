"""The report for a terminal: plain text, aligned columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.comparison_page import edge_labels
from acutance.report.target_page import group_rows
from acutance.report.wording import (
    count_edges,
    describe_image,
    describe_line,
    format_number,
    metric_words,
    numbers_of,
    verdict,
    word_estimate,
    word_place,
)

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement
    from acutance.targets.straight import TargetResult

__all__ = ["align_columns", "comparison_text", "target_text", "text_report"]


def align_columns(rows: Sequence[Sequence[str]], align: str, indent: str = "  ") -> str:
    """Lay rows out in columns two spaces apart.

    Parameters
    ----------
    rows : sequence of sequences of str
        All of the same length.
    align : str
        One letter a column: ``"l"`` or ``"r"``.
    indent : str, optional
        What every line starts with.
    """
    widths = [max(len(row[i]) for row in rows) for i in range(len(align))]
    lines = []
    for row in rows:
        cells = [
            cell.ljust(width) if side == "l" else cell.rjust(width)
            for cell, width, side in zip(row, widths, align, strict=True)
        ]
        lines.append((indent + "  ".join(cells)).rstrip())
    return "\n".join(lines)


def text_report(measurement: Measurement) -> str:
    """A measurement as text: where, what, the numbers and the checks.

    Parameters
    ----------
    measurement : Measurement

    Returns
    -------
    str
        Several lines, without a newline at the end.
    """
    title = f"{measurement.kind} by {measurement.method}, {measurement.orientation}"
    numbers = [("", "value", "std", "95 % interval", "")]
    for name, estimate in numbers_of(measurement).items():
        words, number = metric_words(name), word_estimate(estimate)
        numbers.append((words.label, number.value, number.std, number.interval, words.unit))
    blocks = [
        f"{title}\n  {describe_image(measurement)}\n  {describe_line(measurement)}",
        align_columns(numbers, "lrrrl"),
    ]
    if measurement.checks:
        checks = [
            ("ok" if one.passed else "FAILED", one.name, format_number(one.value), one.limit)
            for one in measurement.checks
        ]
        blocks.append(align_columns(checks, "llrl"))
    blocks.append("\n".join([verdict([measurement]), *_complaints(measurement)]))
    return "\n\n".join(blocks)


def comparison_text(measurements: Sequence[Measurement]) -> str:
    """Several measurements of one target as text: a column and the failed checks of each."""
    labels = edge_labels(measurements)
    rows = [("", *labels)]
    for name, first in numbers_of(measurements[0]).items():
        cells = (numbers_of(one).get(name, first) for one in measurements)
        words = (word_estimate(cell).value_and_std for cell in cells)
        rows.append((metric_words(name).label_with_unit, *words))
    verdicts = (
        line
        for label, one in zip(labels, measurements, strict=True)
        for line in (f"{label}: {verdict([one])}", *_complaints(one))
    )
    return "\n\n".join(
        (
            f"{measurements[0].kind} by {len(labels)} methods, {measurements[0].orientation}\n"
            f"  {describe_image(measurements[0])}",
            align_columns(rows, "l" + "r" * len(labels)),
            "\n".join(verdicts),
        )
    )


def target_text(result: TargetResult) -> str:
    """All edges of a target as text: every edge, the means by direction, what was rejected."""
    edges: list[tuple[str, ...]] = [
        ("edge", "direction", "angle [°]", "MTF at Nyquist", "RER", "FWHM [px]", "checks")
    ]
    for number, one in enumerate(result.measurements, start=1):
        failed = ", ".join(check.name for check in one.failed_checks)
        numbers = (one.angle_deg, one.mtf_nyquist, one.rer, one.fwhm_px)
        words = (word_estimate(each).value_and_std for each in numbers)
        edges.append((str(number), one.orientation, *words, failed or "all passed"))
    blocks = [
        f"{count_edges(len(result.measurements))} measured, {len(result.rejected)} rejected",
        align_columns(edges, "llrrrrl"),
        align_columns(
            [("mean", "metric", "value", "chi² / dof", "p"), *group_rows(result)], "llrrr"
        ),
    ]
    if result.rejected:
        blocks.append(
            "\n".join(
                f"  at {word_place(one.values)}, {one.stage}: {one.reason}"
                for one in result.rejected
            )
        )
    return "\n\n".join(blocks)


def _complaints(measurement: Measurement) -> list[str]:
    return [f"  {check.name}: {check.message}" for check in measurement.failed_checks]
