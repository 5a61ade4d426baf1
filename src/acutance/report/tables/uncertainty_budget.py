"""The uncertainty budget of a measurement as a table, and in one line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from acutance.report.html import Table
from acutance.report.labels import MISSING, format_number, measurement_metric_words
from acutance.targets.uncertainty_budget import MAIN_NUMBERS, BudgetTerm

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement
    from acutance.targets.record import Record

__all__ = ["uncertainty_line", "uncertainty_table"]

_LEAST_SHARE = 0.01


def uncertainty_table(result: Measurement | Record) -> Table:
    """Every cause: how it was found, its standard deviation and its share of the variance."""
    directions = {term.direction for term in result.budget}
    rows = tuple(
        (
            *((term.direction,) if len(directions) > 1 else ()),
            term.words.label, term.words.evaluation, term.words.found_by,
            *(cell for name in MAIN_NUMBERS for cell in _cells(term, name)),
        )
        for term in result.budget
    )  # fmt: skip
    numbers = (
        part
        for name in MAIN_NUMBERS
        for part in (f"{measurement_metric_words(result, name).label}, std", "share")
    )
    columns = (
        *(("",) if len(directions) > 1 else ()), "Cause", "Type", "Found by", *numbers,
    )  # fmt: skip
    align = "l" * (len(columns) - 2 * len(MAIN_NUMBERS)) + "rr" * len(MAIN_NUMBERS)
    notes = (
        "Type A: from statistics of the pixels; B: from a prior or a statement (GUM). Shares are "
        "those of the variance, and add up to 100 %.",
    )
    return Table(columns, rows, align, title="Uncertainty budget", notes=notes, page_only=True)


def uncertainty_line(result: Measurement | Record) -> str:
    """The causes of the standard deviation of the MTF at Nyquist, the largest first."""
    name = MAIN_NUMBERS[0]
    parts = {}
    for direction in dict.fromkeys(term.direction for term in result.budget):
        terms = [term for term in result.budget if term.direction == direction]
        large = [term for term in terms if term.share[name] >= _LEAST_SHARE]
        if len(terms) > 1 and large:
            large.sort(key=lambda term: -term.share[name])
            shares = (f"{term.words.label} {_percent(term.share[name])}" for term in large)
            parts[direction] = ", ".join(shares)
    if not parts:
        return ""
    named = (
        f"{direction}: {shares}" if len(parts) > 1 else shares
        for direction, shares in parts.items()
    )
    return f"std of {measurement_metric_words(result, name).label}: {'; '.join(named)}"


def _cells(term: BudgetTerm, name: str) -> tuple[str, str]:
    """Standard deviation and share."""
    std, share = term.std[name], term.share[name]
    if not math.isfinite(std):
        return MISSING, MISSING
    return f"{std:.5f}", _percent(share)


def _percent(share: float) -> str:
    return f"{format_number(100 * share, 2)} %" if share >= 1e-3 else "< 0.1 %"
