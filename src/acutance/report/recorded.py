"""A record as tables and as sections of a page: what a measurement shows without its pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.figures.curves import COLORS, band_edges, mark_frequencies
from acutance.report.html import Plate, Section, Table, Verdict
from acutance.report.paper import new_page, styled
from acutance.report.tables.measurement import (
    checks_table,
    headline_table,
    numbers_table,
    options_table,
    recorded_numbers,
)
from acutance.report.tables.uncertainty_budget import uncertainty_table

if TYPE_CHECKING:
    from acutance.targets.record import Record

__all__ = ["recorded_mtf", "recorded_sections", "recorded_tables"]

PANEL_HEIGHT_IN = 3.6


def recorded_tables(record: Record) -> tuple[Table, ...]:
    """Numbers, checks, uncertainties and options; what a kind adds needs its details."""
    return (
        numbers_table(record),
        *((checks_table(record),) if record.checks else ()),
        *((uncertainty_table(record),) if record.budget else ()),
        options_table(record),
    )


def recorded_sections(
    record: Record, verdicts: tuple[Verdict, ...], command: str | None
) -> tuple[Section, ...]:
    """Verdict, main numbers and MTF first, then the tables."""
    *numbers, last = recorded_tables(record)
    return (
        Section(
            "Result",
            verdicts=verdicts,
            tables=(headline_table(recorded_numbers(record)),),
            plates=recorded_mtf(record),
            side_by_side=True,
        ),
        *map(Section.of_table, numbers),
        Section(last.title, tables=(last,), command=command),
    )


def recorded_mtf(record: Record) -> tuple[Plate, ...]:
    """The MTF of every direction as the document holds it; nothing where it holds numbers alone."""
    directions = {name: one for name, one in record.directions.items() if one.has_curve("mtf")}
    if not directions:
        return ()
    with styled():
        figure = new_page(5.0, PANEL_HEIGHT_IN)
        axes = figure.subplots()
        curves = {name: one.curve("mtf") for name, one in directions.items()}
        tops = (band_edges(value, std)[1].max() for _, value, std in curves.values())
        mark_frequencies(axes, None, float(max(tops)))
        for name, (freq, value, std) in curves.items():
            low, high = band_edges(value, std)
            axes.fill_between(freq, low, high, color=COLORS[name], alpha=0.25, linewidth=0)
            axes.plot(freq, value, color=COLORS[name], label=name)
        axes.legend(loc="upper right")
    return (Plate.of_figure(figure, "MTF", ""),)
