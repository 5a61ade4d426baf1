"""Several measurements of one target in one table, with the truth where it is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.curves.metric_words import METRIC_WORDS, metric_words
from acutance.report.html import Table
from acutance.report.labels import MISSING, word_estimate
from acutance.report.tables.measurement import numbers_of

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.report.comparison import Comparison

__all__ = ["comparison_tables", "true_numbers"]


def comparison_tables(comparison: Comparison) -> tuple[Table, ...]:
    """The numbers of every method in one table; across and along below each other."""
    several = len(comparison.directions) > 1
    rows = []
    for name in METRIC_WORDS:
        for direction in comparison.directions:
            cells = _cells(comparison, direction, name)
            if cells:
                label = metric_words(name).label_with_unit
                first = direction == comparison.directions[0]
                rows.append((label if first else "", *((direction,) if several else ()), *cells))
    known = ("truth",) if comparison.truth else ()
    columns = ("Metric", *(("Direction",) if several else ()), *known, *comparison.labels)
    align = "l" + "l" * several + "r" * (len(columns) - 1 - several)
    return (Table(columns, tuple(rows), align, title="Numbers"),)


def _cells(comparison: Comparison, direction: str, name: str) -> tuple[str, ...]:
    """A metric as it is true, if known, and by every method; nothing if one does not have it."""
    numbers = [numbers_of(one)[direction].get(name) for one in comparison.measurements]
    truth = true_numbers(comparison, direction)
    if any(number is None for number in numbers):
        return ()
    known = word_estimate(truth[name]).value if name in truth else MISSING
    found = (word_estimate(number).value_and_std for number in numbers if number is not None)
    return (*((known,) if comparison.truth else ()), *found)


def true_numbers(comparison: Comparison, direction: str) -> dict[str, Estimate]:
    """What is known of a simulated target, under the names of its measurements."""
    response = comparison.truth.get(direction)
    curves = {} if response is None else response.metrics()
    return {**comparison.true_numbers, **curves}
