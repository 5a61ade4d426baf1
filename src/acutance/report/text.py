"""The report for a terminal: plain text, aligned columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.wording import (
    describe_image,
    describe_line,
    format_number,
    metric_words,
    verdict,
    word_estimate,
)

if TYPE_CHECKING:
    from acutance.measure.measurement import Measurement

__all__ = ["align_columns", "text_report"]


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
    for name, estimate in measurement.metrics().items():
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
    blocks.append("\n".join([verdict(measurement), *_complaints(measurement)]))
    return "\n\n".join(blocks)


def _complaints(measurement: Measurement) -> list[str]:
    return [f"  {check.name}: {check.message}" for check in measurement.failed_checks]
