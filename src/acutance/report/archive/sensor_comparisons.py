"""What is compared on the page of a sensor: across with along, kinds, methods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from acutance.archive.comparison_margin import MARGIN
from acutance.archive.comparisons import compare_groups
from acutance.archive.counted import counted
from acutance.curves import MAIN_NUMBERS
from acutance.curves.metric_words import METRIC_WORDS
from acutance.errors import OptionError
from acutance.report.archive.wording import percent, with_minus
from acutance.report.html import Table
from acutance.report.labels import MISSING

if TYPE_CHECKING:
    from acutance.archive.comparisons import Difference, GroupComparison
    from acutance.archive.measurements import Measurements

__all__ = ["SensorComparisons", "comparison_tables", "comparisons_of"]

_TITLES = {"orientation": "Across and along", "kind": "Kinds", "method": "Methods"}
_COMMON = {
    "measurement": "same measurements", "target": "same targets", "image": "same images",
    "targets": "same targets, other images", "means": "means",
}  # fmt: skip
_MAX_SENTENCES = 6
"""More pairs of methods, or bands, are in the tables only."""


@dataclass(frozen=True)
class SensorComparisons:
    """Comparisons of a sensor's measurements.

    Parameters
    ----------
    sensor : str
        Its name is not said again.
    metric : str
        What is drawn through time.
    found : dict of str to dict of str to GroupComparison
        By what is compared and by metric.
    """

    sensor: str
    metric: str
    found: dict[str, dict[str, GroupComparison]]

    @property
    def sentences(self) -> list[str]:
        """The answers of the drawn metric, of three methods or more their scatter.

        Of many the first, and how many more the tables have.
        """
        lines = []
        for by_metric in self.found.values():
            main = by_metric[self.metric]
            several = {one.of for one in main.scatters}
            lines += [one.sentence for one in main.differences if one.of not in several]
            lines += [one.sentence for one in main.scatters]
        found = [with_minus(self.without_sensor(line)) for line in lines[:_MAX_SENTENCES]]
        if left := len(lines) - len(found):
            found.append(f"{counted(left, 'more comparison')} in the tables below.")
        return found

    def without_sensor(self, text: str) -> str:
        """A text that begins with the sensor, without it."""
        return text.removeprefix(self.sensor).lstrip(",: ")


def comparisons_of(rows: Measurements, sensor: str, metric: str) -> SensorComparisons:
    """Across with along, kinds and methods, wherever there are two of them.

    Parameters
    ----------
    rows : Measurements
        Of one sensor.
    sensor : str
    metric : str
        What is drawn; the main numbers are compared with it.
    """
    metrics = tuple(dict.fromkeys((metric, *MAIN_NUMBERS)))
    found = {}
    for by in _TITLES:
        if by == "method" and _are_kinds(rows):
            continue
        try:
            found[by] = {one: compare_groups(rows, one, by) for one in metrics}
        except OptionError:
            # More methods than can be compared: the means by method show them.
            continue
    return SensorComparisons(sensor, metric, found)


def _are_kinds(rows: Measurements) -> bool:
    """Whether every kind has one method: methods are compared where kinds are."""
    pairs = set(zip(rows["kind"].tolist(), rows["method"].tolist(), strict=True))
    return len(pairs) == len({kind for kind, _ in pairs})


def comparison_tables(comparisons: SensorComparisons) -> Iterator[Table]:
    """A table of relative differences for everything that is compared."""
    for by, by_metric in comparisons.found.items():
        by_pair: dict[tuple[str, str, str], dict[str, Difference]] = {}
        for metric, one in by_metric.items():
            for pair in one.differences:
                of = comparisons.without_sensor(pair.of)
                by_pair.setdefault((of, pair.first, pair.second), {})[metric] = pair
        if by_pair:
            yield _table(by, tuple(by_metric), by_pair)


def _table(
    by: str, metrics: tuple[str, ...], by_pair: dict[tuple[str, str, str], dict[str, Difference]]
) -> Table:
    rows = []
    for (of, first, second), found in by_pair.items():
        main = next(iter(found.values()))
        images = main.images if main.is_of_different_images else main.images[:1]
        rows.append((
            "\n".join((f"{first} − {second}", *([of] if of else []))),
            *(_cell(found.get(metric)) for metric in metrics), _COMMON[main.basis],
            " / ".join(map(str, images)),
        ))  # fmt: skip
    labels = (METRIC_WORDS[metric].label for metric in metrics)
    notes = dict.fromkeys(
        note for found in by_pair.values() for one in found.values() for note in one.notes
    )
    return Table(
        ("", *labels, "From", "Images"), tuple(rows), "l" + "r" * len(metrics) + "lr",
        title=_TITLES[by],
        notes=(
            "First minus second over the mean of both, with what does not average out over images; "
            f"below it whether they differ (95 %), or agree within {100 * MARGIN:g} %.",
            *notes,
        ),
    )  # fmt: skip


def _cell(one: Difference | None) -> str:
    if one is None or one.relative.std != one.relative.std:
        return MISSING
    return f"{percent(one.relative)}\n{one.answer}"
