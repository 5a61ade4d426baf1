"""The tables of any result."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.tables.bars import bars_tables
from acutance.report.tables.biresolution import biresolution_tables
from acutance.report.tables.combined import combined_tables
from acutance.report.tables.comparison import comparison_tables
from acutance.report.tables.measurement import (
    checks_table,
    mtf_table,
    numbers_table,
    options_table,
)
from acutance.report.tables.points import points_tables
from acutance.report.tables.scene import scene_tables
from acutance.report.tables.star import star_tables
from acutance.report.tables.target import target_tables
from acutance.report.tables.uncertainty_budget import uncertainty_table
from acutance.targets import Record, TargetResult

if TYPE_CHECKING:
    from acutance.report.html import Table
    from acutance.targets.measurement import Measurement

__all__ = ["KIND_TABLES", "kind_tables", "tables"]

KIND_TABLES: dict[str, Callable[[Any], tuple[Table, ...]]] = {
    "bars": bars_tables,
    "biresolution": biresolution_tables,
    "combined": combined_tables,
    "points": points_tables,
    "scene": scene_tables,
    "star": star_tables,
}
"""What each kind of target tabulates besides the numbers that every measurement has."""


def tables(result: Result | Record) -> tuple[Table, ...]:
    """The tables of any result: numbers, what the kind adds, checks, uncertainties, MTF, options.

    Parameters
    ----------
    result : Measurement, Record, TargetResult, Comparison or sequence of Measurement
        Several measurements of one target are compared. A record has no table that needs pixels.

    Returns
    -------
    tuple of Table
        With titles, columns and rows of text.
    """
    if isinstance(result, Record):
        from acutance.report.recorded import recorded_tables

        return recorded_tables(result)
    found = as_result(result)
    if isinstance(found, TargetResult):
        return target_tables(found)
    if isinstance(found, Comparison):
        return comparison_tables(found)
    checks = (checks_table(found),) if found.checks else ()
    return (
        numbers_table(found),
        *kind_tables(found),
        *checks,
        uncertainty_table(found),
        mtf_table(found),
        options_table(found),
    )


def kind_tables(measurement: Measurement) -> tuple[Table, ...]:
    """What the kind of target adds; nothing for edges and pulses."""
    kind = KIND_TABLES.get(measurement.kind)
    return kind(measurement) if kind else ()
