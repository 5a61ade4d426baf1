"""Tables of every measurement: the main numbers, all numbers, checks, the MTF, options."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves import Estimate
from acutance.curves.metric_words import metric_words
from acutance.report.check_words import write_found
from acutance.report.html import Table
from acutance.report.labels import (
    MISSING,
    flatten_options,
    measurement_metric_words,
    transfer_name,
    word_estimate,
)
from acutance.targets.record import Record

if TYPE_CHECKING:
    from acutance.targets.check import Check
    from acutance.targets.measurement import Measurement

__all__ = [
    "STEP_CPP",
    "checks_table",
    "headline_table",
    "mtf_freqs_cpp",
    "mtf_table",
    "numbers_of",
    "numbers_table",
    "options_table",
    "recorded_numbers",
]

STEP_CPP = 0.02
HEADLINES = (
    "width_px", "mtf_nyquist", "rer", "fwhm_px", "fwhm_m",
)  # fmt: skip

PULSE_NUMBERS = ("width_px", "width_m", "prf_fwhm_px", "prf_fwhm_m")

_UNDEFINED = Estimate(math.nan, math.nan)

Numbers = dict[str, dict[str, Estimate]]
"""Numbers by direction and name."""


def numbers_of(measurement: Measurement) -> Numbers:
    """All numbers by measured direction and name; of a pulse its widths before them."""
    numbers = measurement.numbers()
    pulse: dict[str, Estimate] = getattr(measurement, "pulse_numbers", dict)()
    return {name: {**pulse, **numbers[name]} for name in measurement.measured_directions}


def recorded_numbers(record: Record) -> Numbers:
    """The same of a record."""
    document = record.document
    pulse = {name: Estimate.from_dict(document[name]) for name in PULSE_NUMBERS if name in document}
    return {
        name: {**pulse, **record.directions[name].numbers} for name in record.measured_directions
    }


def _names(numbers: Numbers) -> tuple[str, ...]:
    """The numbers that any direction has: a printed table may have some in one of them only."""
    return tuple(dict.fromkeys(name for found in numbers.values() for name in found))


def headline_table(numbers: Numbers, measurement: Measurement | None = None) -> Table:
    """The main numbers in one table: a row a direction, a column a number."""
    there = _names(numbers)
    names = [name for name in HEADLINES if name in there]
    rows = tuple(
        (direction, *(word_estimate(found.get(name, _UNDEFINED)).three_lines for name in names))
        for direction, found in numbers.items()
    )
    words = [
        metric_words(name) if measurement is None else measurement_metric_words(measurement, name)
        for name in names
    ]
    # "FWHM on the ground [m]" is next to "FWHM [px]": their units differ.
    labels = [one.label_with_unit.replace(" on the ground", "") for one in words]
    return Table(("", *labels), rows, "l" + "r" * len(names))


def numbers_table(measurement: Measurement | Record) -> Table:
    """All numbers with their intervals and meanings; across and along stand side by side."""
    numbers = (
        recorded_numbers(measurement)
        if isinstance(measurement, Record)
        else numbers_of(measurement)
    )
    rows = []
    for name in _names(numbers):
        words = measurement_metric_words(measurement, name)
        cells = (word_estimate(found.get(name, _UNDEFINED)) for found in numbers.values())
        pairs = (part for cell in cells for part in (cell.value_and_std, cell.interval))
        rows.append((words.label, *pairs, words.unit, words.meaning))
    named = (
        part for name in numbers for part in (f"{name.capitalize()}, value ± std", "95 % interval")
    )
    columns = ("Metric", *named, "Unit", "Meaning")
    align = "l" + "rr" * len(numbers) + "ll"
    return Table(columns, tuple(rows), align, title="Numbers", notes=_not_measured(measurement))


def _not_measured(measurement: Measurement | Record) -> tuple[str, ...]:
    missing = [one for one in measurement.directions if one not in measurement.measured_directions]
    return tuple(
        f"The target shows nothing {name} track: what the JSON document has in that direction "
        "follows from the prior, with wide intervals."
        for name in missing
    )


def checks_table(result: Measurement | Record) -> Table:
    """What was asked of the target and what was found, failed checks first."""
    checks = sorted(result.checks, key=lambda check: check.passed)
    has_sources = any(check.source for check in checks)
    rows = tuple(
        (
            f"{check.name}\n{check.question}" if check.question else check.name,
            write_found(check, 3), check.asked, state_of(check), check.message,
            *((check.source,) if has_sources else ()),
        )
        for check in checks
    )  # fmt: skip
    alerts = frozenset(i for i, check in enumerate(checks) if not check.passed)
    columns = (
        "Check", "Found", "Asked", "", "What was found",
        *(("Source of the limit",) if has_sources else ()),
    )  # fmt: skip
    return Table(columns, rows, "lrrlll"[: len(columns)], alerts=alerts, title="Checks")


def state_of(check: Check) -> str:
    """ "passed", or how grave the failure is: "note", "caution", "fail"."""
    return "passed" if check.passed else check.severity


def mtf_freqs_cpp() -> list[float]:
    """Frequencies from 0 to 1 c/px at which tables give the MTF."""
    freqs: list[float] = np.linspace(0.0, 1.0, round(1.0 / STEP_CPP) + 1).tolist()
    return freqs


def mtf_table(measurement: Measurement) -> Table:
    """The MTF of every measured direction in steps of 0.02 cycles per pixel."""
    responses = {name: measurement.directions[name] for name in measurement.measured_directions}
    gsds = {one.gsd_m for one in responses.values()}
    gsd_m = gsds.pop() if len(gsds) == 1 else None
    rows = []
    for freq in mtf_freqs_cpp():
        cells = [f"{freq:.2f}"] if gsd_m is None else [f"{freq:.2f}", f"{freq / gsd_m:.3f}"]
        for response in responses.values():
            here = word_curve(response.mtf(freq))
            cells += [here[0], here[1]]
        rows.append(tuple(cells))
    name = transfer_name(measurement)
    curves = (
        part
        for direction in responses
        for part in (f"{direction}" if len(responses) > 1 else name, "95 % interval")
    )
    columns = ("c/px", *(() if gsd_m is None else ("c/m",)), *curves)
    return Table(
        columns, tuple(rows), "r" * len(columns), parts=3 if len(responses) == 1 else 2,
        title=f"{name} in steps of {STEP_CPP:g} cycles per pixel", page_only=True,
    )  # fmt: skip


def word_curve(here: Estimate) -> tuple[str, str]:
    """A value of a curve and its interval, with four decimals."""
    low, high = here.interval(0.95)
    return f"{here.value:.4f}", f"{max(low, 0.0):.4f} … {high:.4f}"


def options_table(measurement: Measurement | Record) -> Table:
    """Method, options, software and time."""
    from acutance import __version__

    version = __version__
    if isinstance(measurement, Record):
        version = str(measurement.fields.get("software", {}).get("acutance", MISSING))
    rows = (
        ("method", measurement.method),
        *flatten_options(measurement.options),
        ("acutance", version),
        ("measured at", measurement.measured_at.isoformat(sep=" ", timespec="seconds")),
    )
    return Table(("Option", "Value"), rows, "ll", title="How it was measured", page_only=True)
