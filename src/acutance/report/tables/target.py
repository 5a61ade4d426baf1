"""All edges of a target in tables: means by direction, every edge, what was rejected."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from acutance.curves import METRICS
from acutance.curves.metric_words import metric_words
from acutance.report.html import Table
from acutance.report.labels import MISSING, count_edges, format_number, word_estimate, word_place
from acutance.report.tables.measurement import headline_table

if TYPE_CHECKING:
    from acutance.targets import TargetResult

__all__ = [
    "HOW_COUNTED",
    "edges_table",
    "group_rows",
    "means_headline",
    "notes_on_means",
    "target_tables",
]

HOW_COUNTED = (
    "Edges are counted from 1; the lists of the JSON document count from 0: edge 1 is "
    "measurements[0]."
)
"""Whoever copies a number from a table into a script has to know."""
MAIN = ("mtf_nyquist", "rer", "fwhm_px")


def target_tables(result: TargetResult[Any]) -> tuple[Table, ...]:
    """Every edge, the means by direction, and what was rejected."""
    tables = [edges_table(result), _means_table(result)]
    if result.rejected:
        rows = tuple((word_place(one.values), one.stage, one.reason) for one in result.rejected)
        tables.append(Table(("Where", "Stage", "Why"), rows, "lll", title="Rejected"))
    return tuple(tables)


def means_headline(result: TargetResult[Any]) -> Table:
    """The means of the main numbers: a row a direction."""
    numbers = {
        f"{name}\nmean of {count_edges(len(group.measurements))}": dict(group.metrics)
        for name, group in result.groups.items()
    }
    return headline_table(numbers)


def edges_table(result: TargetResult[Any]) -> Table:
    """Every edge: place, direction, angle, SNR, main numbers, verdict, failed checks."""
    rows, alerts = [], set()
    for i, one in enumerate(result.measurements):
        failed = ", ".join(check.name for check in one.failed_checks)
        place = (f"{one.line.row:.0f}", f"{one.line.col:.0f}")
        numbers = (word_estimate(getattr(one, name)).value_and_std for name in MAIN)
        rows.append(
            (
                str(i + 1), *place, one.orientation, word_estimate(one.angle_deg).value_and_std,
                format_number(one.snr, 3), *numbers, one.verdict.word, failed or "all passed",
            )
        )  # fmt: skip
        if one.verdict.warns:
            alerts.add(i)
    labels = (metric_words(name).label_with_unit for name in MAIN)
    line = ("Edge", "Row", "Column", "Direction", "Angle [°]", "SNR")
    columns = (*line, *labels, "Verdict", "Checks")
    return Table(columns, tuple(rows), "rrrlrrrrrll", alerts=frozenset(alerts), title="Edges",
                 notes=(HOW_COUNTED,) if rows else ())  # fmt: skip


def _means_table(result: TargetResult[Any]) -> Table:
    found = group_rows(result)
    by_metric = dict.fromkeys(metric for _, metric, *_ in found)
    rows = [
        (metric, *(cell for _, name, *cells in found if name == metric for cell in cells))
        for metric in by_metric
    ]
    columns = (part for name in result.groups for part in (f"{name} mean", "chi² / dof", "p"))
    weights = "Means with a chi² weigh every edge by one over its variance."
    notes = (weights, *notes_on_means(result))
    return Table(
        ("Metric", *columns), tuple(rows), "l" + "rrr" * len(result.groups),
        title="Means by direction", notes=notes,
    )  # fmt: skip


def notes_on_means(result: TargetResult[Any]) -> tuple[str, ...]:
    """Which edges the means are without, where edges disagree, and why there is no chi-square."""
    notes = []
    number = {id(one): i for i, one in enumerate(result.measurements, start=1)}
    for orientation, group in result.groups.items():
        if group.left_out:
            listed = ", ".join(f"{number[id(one)]} ({one.verdict.word})" for one in group.left_out)
            notes.append(f"Left out of the means {orientation}: {listed}.")
        if group.disagrees:
            notes.append(
                f"The edges {orientation} differ by more than their standard deviations explain "
                "(p): the means' deviations are widened; find out why before using them."
            )
    plain = {
        metric_words(name).label
        for group in result.groups.values()
        for name, found in group.chi_square.items()
        if group.degrees_of_freedom and math.isnan(found)
    }
    if plain:
        notes.append(
            f"No chi² of {', '.join(sorted(plain))}: the interval of an edge reaches 0, below "
            "which there is no such number, and deviations do not tell how edges scatter there. "
            "The mean is a plain one, and no more certain than one edge."
        )
    return tuple(notes)


def group_rows(
    result: TargetResult[Any], names: Sequence[str] = METRICS
) -> list[tuple[str, str, str, str, str]]:
    """Direction, metric, mean, chi-square over its degrees of freedom, p-value."""
    rows = []
    for orientation, group in result.groups.items():
        for name in names:
            if name not in group.metrics:
                continue
            found, freedom = group.chi_square[name], group.degrees_of_freedom
            rows.append(
                (
                    orientation, metric_words(name).label_with_unit,
                    word_estimate(group.metrics[name]).value_and_std,
                    f"{found:.1f} / {freedom}" if freedom and math.isfinite(found) else MISSING,
                    format_number(group.p_value[name], 2),
                )
            )  # fmt: skip
    return rows
