"""Tables of a sensor: its state, means by target and method, its images, what was not measured."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import date
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.archive.columns import Columns
from acutance.archive.dates import day_or_minute
from acutance.archive.elsewhere import elsewhere
from acutance.archive.natural_order import natural_key
from acutance.archive.requirement_answers import Answer, SpecificationCheck
from acutance.archive.tables_by import MeasurementTable, table_by
from acutance.archive.trends import Trend
from acutance.archive.trends.series import date_of
from acutance.archive.trends.words import unsought_words
from acutance.curves import MAIN_NUMBERS
from acutance.curves.metric_words import METRIC_WORDS, metric_words
from acutance.report.archive.sensor_state import SeriesState
from acutance.report.archive.wording import interval_words, rate_words, step_words
from acutance.report.html import Table
from acutance.report.labels import MISSING, word_estimate
from acutance.targets.conformity import written_probability

__all__ = ["images_table", "means_tables", "rejected_table", "specification_table", "state_table"]

if TYPE_CHECKING:
    from acutance.archive.measurements import Measurements

_MAX_IMAGES, _MAX_REASONS, _MAX_NAMES = 400, 30, 20
_VERDICTS = ("good", "usable", "doubtful", "invalid")


def state_table(states: Sequence[SeriesState]) -> Table:
    """Every band and direction: numbers on the day of the last image, and their drift."""
    metrics = tuple(dict.fromkeys(metric for one in states for metric in one.found))
    rows: list[tuple[str, ...]] = []
    for one in states:
        trend = one.trend
        rows.append((
            one.name, str(one.images), str(one.measurements),
            str(trend.last) if trend else _span(one.days),
            *(_level_and_drift(one, metric) for metric in metrics),
            "\n".join(_changes(trend)) if trend else MISSING,
        ))  # fmt: skip
    labels = (metric_words(name).label_with_unit for name in metrics)
    drawn = METRIC_WORDS[states[0].metric].label
    return Table(
        ("", "Images", "Measurements", "On", *labels, f"Changes of {drawn}"),
        tuple(rows), f"lrrr{'r' * len(metrics)}l", title="State",
        notes=(
            "The sensor's mean on the day of its last image, without the season, and below it the "
            "drift of that number; where there is no trend the mean of all images.",
        ),
    )  # fmt: skip


def _level_and_drift(state: SeriesState, metric: str) -> str:
    if metric not in state.found:
        return MISSING
    level, found = word_estimate(state.level(metric)).value_and_std, state.found[metric]
    if not isinstance(found, Trend):
        return level
    return f"{level}\n{rate_words(found)} a year"


def _span(days: tuple[date, ...]) -> str:
    """The days of a mean, the first and the last in a line each."""
    return "\n".join(map(str, dict.fromkeys(days))) or MISSING


def _changes(trend: Trend) -> list[str]:
    found = [f"{one.date} {step_words(one)}" for one in trend.changes]
    found += [f"{one.date} {one.name} {step_words(one)}" for one in trend.events]
    unseen = [
        f"{date_of(one.year)} {one.name}: no image shows it"
        for one in trend.posterior.design.events if not trend.images.surround(one.year)
    ]  # fmt: skip
    none = unsought_words(trend) or f"none found ({1 - trend.step_probability:.2f})"
    return [*(found or [none]), *unseen]


def specification_table(check: SpecificationCheck) -> Table:
    """Every requirement with its answer."""
    rows = [_answer_row(answer) for answer in check.answers]
    columns = ["Requirement", "Of", "Limit", "Answer", "Probability", "Mean", "95 %", "Images",
               "More images"]  # fmt: skip
    align = "lllllrrrr"
    if not any(answer.requirement.name for answer in check.answers):
        # The limit is what tells requirements without names apart.
        rows, columns, align = [row[1:] for row in rows], columns[1:], align[1:]
    alerts = (at for at, answer in enumerate(check.answers) if answer.word != "met")
    return Table(
        tuple(columns), tuple(rows), align, alerts=frozenset(alerts), title="Specification",
        notes=(
            "Probability: that the sensor's mean over the year (without the season) meets the "
            "limit; 95 %: the interval of the same density. More images: how many would tell, if "
            "the mean is what it is now; 0 where it is told.",
        ),
    )  # fmt: skip


def _answer_row(answer: Answer) -> tuple[str, ...]:
    mean, chance = answer.mean, answer.probability
    return (
        answer.requirement.name or MISSING, answer.what, answer.requirement.sentence, answer.word,
        MISSING if chance is None else written_probability(chance),
        MISSING if mean is None else word_estimate(mean).value,
        MISSING if mean is None else interval_words(mean),
        str(answer.images), MISSING if answer.more_images is None else str(answer.more_images),
    )  # fmt: skip


def means_tables(rows: Measurements) -> list[Table]:
    """Means by target, method and site, where there are several, for every direction."""
    found = []
    for by, names in (("target", ("target",)), ("method", ("kind", "method")), ("site", ("site",))):
        if len(set(rows[by].tolist())) > 1:
            means = table_by(rows, names, MAIN_NUMBERS)
            directions = dict.fromkeys(direction for direction, _ in means.columns)
            found += [_means_table(means, direction, f"By {by}") for direction in directions]
    return found


def _means_table(means: MeasurementTable, direction: str, title: str) -> Table:
    """The means of one direction; groups that were not seen in it are left out."""
    own = means.of_direction(direction)
    first = len(own.header) - len(own.columns)
    labels = (METRIC_WORDS[metric].label_with_unit for _, metric in own.columns)
    names = (name[:1].upper() + name[1:] for name in own.header[:first])
    sides = "l" * len(own.by) + "r" * (len(own.header) - len(own.by))
    return Table(
        (*names, *labels), tuple(own.texts()), sides, title=f"{title}, {direction}",
        notes=own.notes,
    )  # fmt: skip


def images_table(rows: Columns, rejected: Columns) -> Table:
    """Every image: what was measured in it and how it was judged, what was rejected."""
    images: dict[int, dict[str, Any]] = {}
    for part, is_measured in ((rows, True), (rejected, False)):
        for at in range(len(part)):
            described = (part["acquired"][at], str(part["image"][at] or ""))
            one = images.setdefault(
                int(part["image_id"][at]), {"what": described, "ids": {}, "rejected": 0}
            )
            if is_measured:
                one["ids"][int(part["id"][at])] = str(part["verdict"][at])
            elif elsewhere(part["values"][at]) is None:
                one["rejected"] += 1
    listed = []
    # Of very many the latest are of interest; those without a date stand last.
    in_order = sorted(images.values(), key=_by_date)
    dated = sum(not np.isnat(one["what"][0]) for one in in_order)
    first = min(max(0, len(in_order) - _MAX_IMAGES), dated)
    for one in in_order[first : first + _MAX_IMAGES]:
        acquired, name = one["what"]
        counts = Counter(one["ids"].values())
        words = ", ".join(f"{counts[word]} {word}" for word in _VERDICTS if counts[word])
        day = MISSING if np.isnat(acquired) else day_or_minute(acquired.astype("M8[us]").item())
        listed.append((
            day, name or MISSING, str(len(one["ids"])), words or MISSING,
            str(one["rejected"]),
        ))  # fmt: skip
    left = len(images) - len(listed)
    notes = (f"The latest {len(listed)}; {left} more are not listed.",) if left else ()
    return Table(
        ("Acquired (UTC)", "Image", "Measured", "Verdicts", "Rejected"), tuple(listed), "llrlr",
        title="Images", notes=notes, page_only=True,
    )  # fmt: skip


def _by_date(image: dict[str, Any]) -> tuple[Any, ...]:
    acquired, name = image["what"]
    return bool(np.isnat(acquired)), acquired.astype(np.int64), natural_key(name)


def rejected_table(rejected: Columns) -> Table | None:
    """Why targets were not measured, the most frequent reason first; none if all were.

    Targets that their images do not show are named, whatever the pixel where they would lie.
    """
    if not len(rejected):
        return None
    columns = (rejected[name].tolist() for name in ("stage", "reason", "values", "target"))
    counts: Counter[tuple[str, str]] = Counter()
    names: dict[str, dict[str, None]] = {}
    for stage, reason, values, target in zip(*columns, strict=True):
        absent = elsewhere(values)
        counts[str(stage), absent or str(reason)] += 1
        if absent:
            names.setdefault(absent, {})[target or "(without a name)"] = None
    rows = tuple(
        (str(count), stage, f"{reason}: {_listed(names[reason])}" if reason in names else reason)
        for (stage, reason), count in counts.most_common()
    )
    left = len(rows) - _MAX_REASONS
    notes = (
        (f"The {_MAX_REASONS} most frequent; {left} more are in the archive.",) if left > 0 else ()
    )
    return Table(
        ("Times", "Stage", "Reason"), rows[:_MAX_REASONS], "rll", title="Not measured", notes=notes,
        page_only=True,
    )  # fmt: skip


def _listed(names: Mapping[str, None]) -> str:
    """Names, the first of many."""
    more = len(names) - _MAX_NAMES
    return ", ".join([*list(names)[:_MAX_NAMES], *([f"{more} more"] if more > 0 else [])])
