"""Results as a piece of HTML, as notebooks show them: numbers, checks, figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.bands import bands_tables
from acutance.report.figure import panels
from acutance.report.html import Plate, Section, render_fragment
from acutance.report.labels import describe_image, title_of
from acutance.report.page import verdict_of
from acutance.report.paper import new_page, split_page, styled
from acutance.report.recorded import recorded_mtf
from acutance.report.tables.measurement import headline_table, numbers_of, recorded_numbers
from acutance.report.tables.target import target_tables
from acutance.targets.measurement import Measurement
from acutance.targets.record import Record
from acutance.targets.target_result import TargetResult

if TYPE_CHECKING:
    from acutance.report.html import Table
    from acutance.scan import BandScenes

__all__ = ["notebook_html"]

SHOWN_PANELS = 3
SHOWN_TABLES = 2
PANEL_HEIGHT_IN = 3.6


def notebook_html(
    result: Measurement | Record | TargetResult[Measurement] | BandScenes,
) -> str:
    """Main numbers, checks that failed and the first drawings of a measurement, as HTML.

    Parameters
    ----------
    result : Measurement, Record, TargetResult or BandScenes
        A record, and a measurement without details, show their curves only; several measurements
        their tables.

    Returns
    -------
    str
        A ``div`` with its own style.
    """
    if isinstance(result, Measurement | Record):
        return _one_html(result)
    if isinstance(result, TargetResult):
        return _several_html(result.summary(), target_tables(result)[:SHOWN_TABLES])
    # What is no result at all is refused there.
    tables = bands_tables(result)
    return _several_html(result.summary(), tables)


def _several_html(summary: str, tables: Sequence[Table]) -> str:
    return render_fragment([Section("", paragraphs=(summary,)), *map(Section.of_table, tables)])


def _one_html(result: Measurement | Record) -> str:
    if isinstance(result, Record):
        numbers = headline_table(recorded_numbers(result))
        plates = recorded_mtf(result)
    else:
        numbers = headline_table(numbers_of(result), result)
        plates = (_first_panels(result),)
    main = Section(
        title_of(result),
        paragraphs=(describe_image(result),),
        verdicts=(verdict_of(result),),
        tables=(numbers,),
    )
    return render_fragment([main, Section("", plates=plates)])


def _first_panels(measurement: Measurement) -> Plate:
    """The first narrow drawings of a measurement in a row."""
    shown = [panel for panel in panels(measurement) if not panel.wide][:SHOWN_PANELS]
    with styled():
        figure = new_page(4.4 * len(shown), PANEL_HEIGHT_IN)
        for place, panel in zip(split_page(figure, 1, len(shown)), shown, strict=True):
            panel.draw(place)
    return Plate.of_figure(figure, "Curves", "")
