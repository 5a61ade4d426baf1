"""The HTML page of a 2-D measurement."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from acutance.report.html import Headline, Plate, Section, Table, Verdict, render_report
from acutance.report.page import new_page, styled
from acutance.report.plane_page import plane_panels
from acutance.report.plane_panels import PlanePanel
from acutance.report.quantity import plane_metric_words, transfer_name
from acutance.report.sections import checks_sections, reproducing_section
from acutance.report.tables import STEP_CPP
from acutance.report.wording import (
    MISSING,
    describe_plane,
    describe_plane_image,
    format_number,
    verdict,
    word_estimate,
    write_fixed,
)

if TYPE_CHECKING:
    from acutance.targets import Measurement2d

__all__ = ["plane_report", "plane_sections"]

HEADLINES = ("mtf_nyquist", "rer", "fwhm_px", "fwhm_m")
PLATE_IN = 6.0
WIDE_IN = 12.4


def plane_report(
    measurement: Measurement2d,
    *,
    command: str | None = None,
    extra_panels: Sequence[PlanePanel] = (),
    extra_sections: Sequence[Section] = (),
) -> str:
    """A 2-D measurement as one HTML page.

    Parameters
    ----------
    measurement : Measurement2d
    command : str, optional
        The command line that produced it.
    extra_panels : sequence of PlanePanel, optional
        Drawings of the method's own, after the curves.
    extra_sections : sequence of Section, optional
        Tables of the method's own, after the numbers.
    """
    sections = plane_sections(
        measurement, command=command, extra_panels=extra_panels, extra_sections=extra_sections
    )
    title = f"{measurement.kind.capitalize()} measurement"
    return render_report(title, describe_plane_image(measurement), sections)


def plane_sections(
    measurement: Measurement2d,
    *,
    command: str | None = None,
    extra_panels: Sequence[PlanePanel] = (),
    extra_sections: Sequence[Section] = (),
) -> tuple[Section, ...]:
    """The sections of `plane_report`, for a page that holds more than one measurement."""
    evidence = (
        (Section("Evidence", plates=tuple(map(_plate, extra_panels))),) if extra_panels else ()
    )
    return (
        Section(
            "Result",
            paragraphs=(f"{describe_plane(measurement)}.",),
            headlines=_headlines(measurement),
            verdicts=(Verdict(measurement.trusted, verdict([measurement])),),
        ),
        Section("Curves", plates=tuple(map(_plate, plane_panels(measurement)))),
        *evidence,
        Section("Numbers", tables=(_numbers_table(measurement),)),
        *extra_sections,
        *checks_sections(measurement),
        Section(
            f"{transfer_name(measurement)} in steps of 0.02 cycles per pixel",
            tables=(_mtf_table(measurement),),
        ),
        reproducing_section(measurement, command),
    )


def _plate(panel: PlanePanel) -> Plate:
    with styled():
        figure = new_page(WIDE_IN if panel.wide else PLATE_IN, panel.height_in)
        panel.draw(figure)
    return Plate.of_figure(figure, panel.title, panel.caption, wide=panel.wide)


def _headlines(measurement: Measurement2d) -> tuple[Headline, ...]:
    cards = []
    for direction, numbers in measurement.metrics().items():
        for name in HEADLINES:
            if name in numbers:
                words = plane_metric_words(measurement, name)
                number = word_estimate(numbers[name])
                details = (
                    () if number.std == MISSING else (f"± {number.std}", f"95 %: {number.interval}")
                )
                cards.append(
                    Headline(f"{words.label}, {direction}", number.value, words.unit, details)
                )
    if math.isfinite(measurement.snr):
        cards.append(Headline("SNR", format_number(measurement.snr, 3)))
    return tuple(cards)


def _numbers_table(measurement: Measurement2d) -> Table:
    across, along = measurement.across.metrics(), measurement.along.metrics()
    rows = []
    for name in across:
        words = plane_metric_words(measurement, name)
        pair = [word_estimate(one[name]) for one in (across, along)]
        cells = (cell for number in pair for cell in (number.value_and_std, number.interval))
        rows.append((words.label, *cells, words.unit, words.meaning))
    columns = ("Metric", "Across", "95 % interval", "Along", "95 % interval", "Unit", "Meaning")
    return Table(columns, tuple(rows), "lrrrrll")


def _mtf_table(measurement: Measurement2d) -> Table:
    rows = []
    for freq in np.linspace(0.0, 1.0, round(1.0 / STEP_CPP) + 1).tolist():
        cells = [f"{freq:.2f}"]
        for response in (measurement.across, measurement.along):
            here = response.mtf(freq)
            low, high = here.interval(0.95)
            cells += [f"{here.value:.4f}", f"{write_fixed(low)} … {write_fixed(high)}"]
        rows.append(tuple(cells))
    columns = ("c/px", "Across", "95 % interval", "Along", "95 % interval")
    return Table(columns, tuple(rows), "rrrrr", parts=2)
