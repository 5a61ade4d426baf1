"""A measurement or a record as a piece of HTML, as notebooks show it: numbers, checks, figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.figure import panels
from acutance.report.figures.curves import COLORS, band_edges, mark_frequencies
from acutance.report.html import Plate, Section, render_fragment
from acutance.report.labels import describe_image, title_of
from acutance.report.page import verdict_of
from acutance.report.paper import new_page, split_page, styled
from acutance.report.tables.measurement import headline_table, numbers_of, recorded_numbers
from acutance.targets.record import Record

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement

__all__ = ["notebook_html"]

SHOWN_PANELS = 3
PANEL_HEIGHT_IN = 3.6


def notebook_html(result: Measurement | Record) -> str:
    """Main numbers, checks that failed and the first drawings of a measurement, as HTML.

    Parameters
    ----------
    result : Measurement or Record
        A record, and a measurement without details, show their curves only.

    Returns
    -------
    str
        A ``div`` with its own style.
    """
    if isinstance(result, Record):
        numbers = headline_table(recorded_numbers(result))
        plate = _recorded_mtf(result)
    else:
        numbers = headline_table(numbers_of(result), result)
        plate = _first_panels(result)
    main = Section(
        title_of(result),
        paragraphs=(describe_image(result),),
        verdicts=(verdict_of(result),),
        tables=(numbers,),
    )
    return render_fragment([main, Section("", plates=(plate,))])


def _first_panels(measurement: Measurement) -> Plate:
    """The first narrow drawings of a measurement in a row."""
    shown = [panel for panel in panels(measurement) if not panel.wide][:SHOWN_PANELS]
    with styled():
        figure = new_page(4.4 * len(shown), PANEL_HEIGHT_IN)
        for place, panel in zip(split_page(figure, 1, len(shown)), shown, strict=True):
            panel.draw(place)
    return Plate.of_figure(figure, "Curves", "")


def _recorded_mtf(record: Record) -> Plate:
    """The MTF of every direction as the document holds it."""
    with styled():
        figure = new_page(5.0, PANEL_HEIGHT_IN)
        axes = figure.subplots()
        curves = {name: one.curve("mtf") for name, one in record.directions.items()}
        tops = (band_edges(value, std)[1].max() for _, value, std in curves.values())
        mark_frequencies(axes, None, float(max(tops)))
        for name, (freq, value, std) in curves.items():
            low, high = band_edges(value, std)
            axes.fill_between(freq, low, high, color=COLORS[name], alpha=0.25, linewidth=0)
            axes.plot(freq, value, color=COLORS[name], label=name)
        axes.legend(loc="upper right")
    return Plate.of_figure(figure, "MTF", "")
