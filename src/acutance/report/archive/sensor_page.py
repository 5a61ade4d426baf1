"""One page a sensor: the latest state, verdicts and drift; then curves, tables, images."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from acutance.archive import Archive
from acutance.archive.elsewhere import elsewhere
from acutance.archive.requirement_selection import asked_of, asks_nothing
from acutance.archive.specification import read_specification
from acutance.archive.trends.measured_series import NO_SENSOR
from acutance.curves import MAIN_NUMBERS, METRICS
from acutance.curves.metric_words import METRIC_WORDS
from acutance.errors import NothingSelectedError, OptionError
from acutance.report.archive.gsd_bands import with_gsd_bands
from acutance.report.archive.sensor_comparisons import (
    SensorComparisons,
    comparison_tables,
    comparisons_of,
)
from acutance.report.archive.sensor_curves import curves_plates
from acutance.report.archive.sensor_state import SeriesState, states_of
from acutance.report.archive.sensor_tables import (
    images_table,
    means_tables,
    rejected_table,
    specification_table,
    state_table,
)
from acutance.report.archive.trend_page import trend_plate, trend_verdict
from acutance.report.archive.wording import with_minus
from acutance.report.html import Section, Verdict, render_page
from acutance.report.labels import word_estimate

if TYPE_CHECKING:
    from acutance.archive.measurements import Measurements, Rejections
    from acutance.archive.requirement_answers import Answer, SpecificationCheck
    from acutance.archive.trends import Event

__all__ = ["sensor_page", "sensor_page_and_states"]

Word = Literal["good", "usable", "doubtful", "invalid"]
_ANSWERS: dict[str, Word] = {"met": "good", "not met": "invalid", "cannot be told yet": "doubtful"}


def sensor_page(
    archive: Archive,
    sensor: str,
    *,
    metric: str = "mtf_nyquist",
    specification: str | os.PathLike[str] | None = None,
    events: Sequence[Event] = (),
    verdict: str = "usable",
    command: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> str:
    """What an archive holds of a sensor, as one self-contained HTML page.

    Parameters
    ----------
    archive : Archive
    sensor : str
        "" of images that name none.
    metric : str, optional
        What is drawn through time.
    specification : path, optional
        A file of requirements; its answers come first.
    events : sequence of Event, optional
        Dates at which the sensor may have changed.
    verdict : str, optional
        Measurements of this verdict or better are used; all are listed.
    command : str, optional
        The command line.
    progress : function of (done, total), optional
        Called before the trends of every band and direction, which take most of the time.

    Raises
    ------
    OptionError
        If there is no such metric.
    NothingSelectedError
        If there is no measurement of the sensor with such a verdict, or with a value of the metric.
    """
    return sensor_page_and_states(
        archive, sensor, metric=metric, specification=specification, events=events,
        verdict=verdict, command=command, progress=progress,
    )[0]  # fmt: skip


def sensor_page_and_states(
    archive: Archive,
    sensor: str,
    *,
    metric: str = "mtf_nyquist",
    specification: str | os.PathLike[str] | None = None,
    events: Sequence[Event] = (),
    verdict: str = "usable",
    command: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[str, list[SeriesState]]:
    """The page, and the states it has, whose trends take most of its time."""
    if metric not in METRICS:
        raise OptionError(f"there is no metric {metric!r}, only {', '.join(METRICS)}")
    every, rejected = archive.measurements(sensor=sensor), archive.rejected(sensor=sensor)
    rows = archive.measurements(sensor=sensor, verdict=verdict)
    if not len(rows):
        archive.require_known_names({})
        sensors = archive.overview().sensors
        known = [one.sensor or "'' (not named)" for one in sensors if one.measured]
        raise NothingSelectedError(
            f"archive {archive.place} holds {len(every)} measurements of {sensor!r}, none of them "
            f"{verdict} or better; its sensors are {', '.join(known) or 'not known'}: name another "
            "sensor, or a lower verdict"
        )
    # Told apart by their GSD here, too, and with the note that their band is not named.
    states = states_of(rows, sensor, metric, events, progress)
    if not states:
        known = [one for one in MAIN_NUMBERS if np.isfinite(rows[one]).any()]
        raise NothingSelectedError(
            f"none of the {len(rows)} measurements of {sensor!r} has a value of {metric}: choose "
            f"{' or '.join(known) or 'another number'}"
        )
    rows = with_gsd_bands(rows)
    check, unasked = None, ""
    if specification is not None:
        stated = read_specification(specification)
        if asked_of(stated, {"sensor": sensor}):
            check = archive.check(stated, events=events, sensor=sensor)
        else:
            unasked = asks_nothing(stated, {"sensor": sensor})
    comparisons = comparisons_of(rows, sensor, metric)
    content = (
        *_answer_sections(states, check, comparisons, unasked),
        *_trend_sections(states, check, sensor),
        *map(Section.of_table, comparison_tables(comparisons)),
        *_curve_sections(rows),
        *map(Section.of_table, means_tables(rows)),
        *_list_sections(every, rejected, command),
    )
    title = sensor or "Sensor not named"
    facts = _facts(every, rejected, rows)
    return render_page(title, "What its measurements say", content, facts), states


def _facts(every: Measurements, rejected: Rejections, used: Measurements) -> dict[str, str]:
    measured, taken = (len(set(part["id"].tolist())) for part in (every, used))
    absent = sum(elsewhere(one) is not None for one in rejected["values"].tolist())
    counts = {"measured": measured, "used": taken, "rejected": len(rejected) - absent}
    # Of many targets in many images most pairs are none: that is no failure of the sensor's images.
    counts |= {"not in their images": absent} if absent else {}
    return {name: str(count) for name, count in counts.items()}


def _answer_sections(
    states: Sequence[SeriesState],
    check: SpecificationCheck | None,
    comparisons: SensorComparisons,
    unasked: str,
) -> list[Section]:
    """Specification, changes and comparisons first; then the state of every direction."""
    answers = check.answers if check else ()
    nothing = [Verdict("usable", f"{unasked[:1].upper()}{unasked[1:]}.")] if unasked else []
    verdicts = (
        *nothing,
        *(_answer_verdict(answer, states) for answer in answers),
        *map(_state_verdict, states),
        *(Verdict("usable", sentence) for sentence in comparisons.sentences),
    )
    tables = [state_table(states)]
    if check is not None:
        tables.insert(0, specification_table(check))
    return [Section("Result", verdicts=verdicts), *map(Section.of_table, tables)]


def _answer_verdict(answer: Answer, states: Sequence[SeriesState]) -> Verdict:
    """An answer, with those notes that the states below do not have."""
    name = f"{answer.requirement.name}: " if answer.requirement.name else ""
    told = {note for state in states for note in state.notes}
    notes = tuple(("note", with_minus(note)) for note in answer.notes if note not in told)
    return Verdict(_ANSWERS[answer.word], f"{name}{answer.judgement}", notes)


def _state_verdict(state: SeriesState) -> Verdict:
    """The state in a sentence, with what has to be known of its measurements."""
    found = _changes_verdict(state)
    notes = (("note", with_minus(text)) for text in state.notes)
    return replace(found, details=(*found.details, *notes))


def _changes_verdict(state: SeriesState) -> Verdict:
    label = f"{state.name}: " if state.name else ""
    if state.trend is not None:
        return trend_verdict(state.trend, label=label)
    words = word_estimate(state.level(state.metric)).value_and_std
    what = f"{label}{METRIC_WORDS[state.metric].of(words)}"
    if state.images == 1:
        return Verdict("usable", f"{what}: of one image, which shows no trend.")
    days = "too few of them have dates, or they are of one day, for a trend"
    return Verdict("usable", f"{what}, the mean of {state.images} images: {days}.")


def _trend_sections(
    states: Sequence[SeriesState], check: SpecificationCheck | None, sensor: str
) -> list[Section]:
    plates = tuple(
        trend_plate(one.trend, _limits_of(one, check, sensor))
        for one in states
        if one.trend is not None
    )
    return [Section("Through time", plates=plates)] if plates else []


def _limits_of(state: SeriesState, check: SpecificationCheck | None, sensor: str) -> list[float]:
    """The limits that requirements set for a series."""
    own = ", ".join(filter(None, (sensor or NO_SENSOR, state.name)))
    return [
        answer.requirement.limit
        for answer in (check.answers if check else ())
        if answer.requirement.metric == state.metric and answer.what == own
    ]


def _curve_sections(rows: Measurements) -> list[Section]:
    plates = tuple(curves_plates(rows))
    return [Section("Curves", plates=plates)] if plates else []


def _list_sections(every: Measurements, rejected: Rejections, command: str | None) -> list[Section]:
    images = images_table(every, rejected)
    reasons = rejected_table(rejected)
    sections = [] if reasons is None else [Section.of_table(reasons)]
    last = Section(images.title, paragraphs=images.notes, tables=(images,), command=command)
    return [*sections, last]
