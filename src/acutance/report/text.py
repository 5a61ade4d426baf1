"""A result for a terminal: plain text, aligned columns."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from acutance.curves.aligned_columns import align_columns
from acutance.report.check_words import (
    common_verdict,
    count_failed_checks,
    failed_by_check,
    write_found,
)
from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.html import Table
from acutance.report.labels import (
    count_edges,
    describe_image,
    describe_measurement,
    title_of,
)
from acutance.report.requirements import Required, required_lines
from acutance.report.tables.measurement import numbers_table
from acutance.report.tables.result import kind_tables, tables
from acutance.report.tables.scene_reasons import reasons_table
from acutance.report.tables.target import HOW_COUNTED, notes_on_means
from acutance.report.tables.uncertainty_budget import uncertainty_line
from acutance.targets import Record, TargetResult

if TYPE_CHECKING:
    from acutance.scan.edge_table import EdgeTable
    from acutance.targets.measurement import Measurement

__all__ = ["reasons_text", "table_text", "text"]

MAX_ROWS = 40
_REASONS = 6


def text(result: Result | Record, *, required: Required = ()) -> str:
    """Any result as text: what was measured, the verdict, the numbers, the checks.

    Parameters
    ----------
    result : Measurement, Record, TargetResult, Comparison or sequence of Measurement
    required : sequence of ToleranceLimit or str, optional
        Requirements to be answered: "mtf_nyquist >= 0.09".

    Returns
    -------
    str
        Several lines, without a newline at the end.
    """
    found = result if isinstance(result, Record) else as_result(result)
    if isinstance(found, TargetResult):
        return _target_text(found, required)
    if isinstance(found, Comparison):
        return _comparison_text(found, required)
    of_kind: tuple[Table, ...] = ()
    if isinstance(found, Record):
        # The line of the target and what a kind adds need its details.
        named = title_of(found)
    else:
        named, of_kind = describe_measurement(found), kind_tables(found)
    parts = [
        f"{named}\n  {describe_image(found)}",
        *([str(found.verdict)] if found.checks else []),
        *required_lines(found, required),
        table_text(numbers_table(found), drop_last=1),
        *([f"  {causes}"] if (causes := uncertainty_line(found)) else []),
        *(table_text(table) for table in of_kind if not table.page_only),
    ]
    if found.checks:
        checks = [
            ("ok" if one.passed else one.severity.upper(), one.name, write_found(one),
             one.asked)
            for one in found.checks
        ]  # fmt: skip
        parts.append(align_columns(checks, "llrl"))
    parts.append("\n".join(_verdict_lines(found)))
    return "\n\n".join(parts)


def _verdict_lines(measurement: Measurement | Record) -> list[str]:
    """Verdict and how many checks failed, then what each of those found."""
    counted = count_failed_checks([measurement])
    first = f"{measurement.verdict.word}: {counted}" if measurement.checks else counted
    return [
        first,
        *(f"  {one.name} ({one.severity}): {one.message}" for one in measurement.failed_checks),
    ]


def _comparison_text(comparison: Comparison, required: Required) -> str:
    """A column and the failed checks of each method."""
    first = comparison.measurements[0]
    title = title_of(first).split(",")[0]
    verdicts = (
        line if line.startswith(" ") else f"{label}: {line}"
        for label, one in zip(comparison.labels, comparison.measurements, strict=True)
        for line in _verdict_lines(one)
    )
    refused = (f"{one.values['method']}: not measured: {one.reason}" for one in comparison.rejected)
    return "\n\n".join(
        (
            f"{title} by {len(comparison.labels)} methods, {' and '.join(comparison.directions)} "
            f"track\n  {describe_image(first)}",
            *required_lines(comparison, required),
            *map(table_text, tables(comparison)),
            "\n".join((*verdicts, *refused)),
        )
    )


def _target_text(result: TargetResult[Any], required: Required) -> str:
    """Every edge, the means by direction, what was rejected, and what failed checks found."""
    measurements = result.measurements
    head = f"{count_edges(len(measurements))} measured, {len(result.rejected)} rejected"
    where = f"\n  {describe_image(measurements[0])}" if measurements else ""
    failing = Counter(check.name for one in measurements for check in one.failed_checks)
    failed = [
        f"  {name}, {'edges' if failing[name] > 1 else 'edge'} {edges}: {meaning}"
        for name, edges, meaning in failed_by_check(measurements)
    ]
    return "\n\n".join(
        (
            head + where,
            str(common_verdict(measurements)),
            *required_lines(result, required),
            *map(table_text, tables(result)),
            *((HOW_COUNTED,) if measurements else ()),
            *notes_on_means(result),
            *(["\n".join(("Failed checks", *failed))] if failed else []),
        )
    )


def table_text(table: Table, drop_last: int = 0) -> str:
    """Title, header and rows; a long table is cut, a line of a cell is one line here.

    Parameters
    ----------
    table : Table
    drop_last : int, optional
        How many of its last columns are left out.
    """
    kept = len(table.columns) - drop_last
    rows = [[cell.split("\n")[0] for cell in row[:kept]] for row in table.rows[:MAX_ROWS]]
    header = [list(table.columns[:kept])] if any(table.columns) else []
    lines = [table.title] if table.title else []
    if rows:
        lines.append(align_columns([*header, *rows], table.align[:kept]))
    else:
        lines += [f"  {note}" for note in table.notes]
    more = len(table.rows) - len(rows)
    if more > 0:
        lines.append(f"  ... {more} more in the JSON document")
    return "\n".join(lines)


def reasons_text(edges: EdgeTable) -> str:
    """Why edges of a scene are not used, the most frequent reasons first; empty if all are."""
    table = reasons_table(edges, _REASONS)
    return table_text(table) if table.rows else ""
