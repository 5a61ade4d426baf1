"""Tables of a campaign: several methods against the truth and against each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from acutance.curves import METRICS, Estimate
from acutance.curves.metric_words import metric_words
from acutance.report.html import Table
from acutance.report.labels import MISSING, word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.curves import Response

__all__ = ["CampaignEntry", "campaign_rows", "campaign_table", "difference_table"]

COMPARED = ("mtf_nyquist", "rer", "fwhm_px")
MANY_STDS = 3.0


@dataclass(frozen=True, eq=False)
class CampaignEntry:
    """What one method found in one direction, and what is true there.

    Parameters
    ----------
    target : str
        "vertical edge".
    method : str
    orientation : {"across", "along"}
    response : Response
        What was measured.
    truth : Response
        What a perfect measurement in the same direction would be.
    reference : bool, optional
        Whether the method reports all of its uncertainty; published ones have known biases.
    """

    target: str
    method: str
    orientation: Literal["across", "along"]
    response: Response
    truth: Response
    reference: bool = True

    def numbers(self, name: str) -> tuple[Estimate, float]:
        """A metric as measured, and its truth."""
        if name not in METRICS:
            raise KeyError(name)
        measured: Estimate = getattr(self.response, name)
        return measured, float(getattr(self.truth, name).value)

    def deviation(self, name: str) -> float:
        """Measured minus true, in standard deviations."""
        measured, true = self.numbers(name)
        return (measured.value - true) / measured.std if measured.std > 0 else math.nan


def campaign_table(entries: Sequence[CampaignEntry]) -> Table:
    """Every method by every direction: value, standard deviation, truth, deviation.

    Rows more than three standard deviations off are marked.
    """
    columns = ["Target", "Direction", "Method"]
    for name in COMPARED:
        columns += [metric_words(name).label_with_unit, "truth", "off"]
    rows, alerts = [], set()
    for i, one in enumerate(entries):
        again = i > 0 and entries[i - 1].target == one.target
        cells = ["" if again else one.target, one.orientation, one.method]
        for name in COMPARED:
            measured, true = one.numbers(name)
            off = one.deviation(name)
            cells += [word_estimate(measured).value_and_std, f"{true:.4f}", _stds(off)]
            if abs(off) > MANY_STDS:
                alerts.add(i)
        rows.append(tuple(cells))
    return Table(
        tuple(columns), tuple(rows), "lll" + "rrr" * len(COMPARED), alerts=frozenset(alerts)
    )


def campaign_rows(entries: Sequence[CampaignEntry]) -> list[dict[str, object]]:
    """The same as data, for JSON."""
    rows = []
    for one in entries:
        row: dict[str, object] = {
            "target": one.target,
            "orientation": one.orientation,
            "method": one.method,
        }
        for name in COMPARED:
            measured, true = one.numbers(name)
            row[name] = {
                **measured.to_dict(), "truth": true, "off_in_std": one.deviation(name),
            }  # fmt: skip
        rows.append(row)
    return rows


def difference_table(entries: Sequence[CampaignEntry], name: str = "mtf_nyquist") -> Table:
    """Every method minus every other one in the same direction, in standard deviations.

    Each is first compared with the truth of its own direction, so that a tilt of six degrees does
    not count as a difference.
    """
    labels = [f"{one.target} ({one.method})" if not one.reference else one.target
              for one in entries]  # fmt: skip
    rows = []
    for one, label in zip(entries, labels, strict=True):
        cells = [label]
        for other in entries:
            cells.append(MISSING if other is one else _stds(_between(one, other, name)))
        rows.append(tuple(cells))
    return Table(("minus →", *labels), tuple(rows), "l" + "r" * len(labels))


def _between(one: CampaignEntry, other: CampaignEntry, name: str) -> float:
    (first, true), (second, also_true) = one.numbers(name), other.numbers(name)
    std = math.hypot(first.std, second.std)
    return ((first.value - true) - (second.value - also_true)) / std if std > 0 else math.nan


def _stds(off: float) -> str:
    if not math.isfinite(off):
        return MISSING
    text = write_fixed(off, 1)
    return text if text.startswith("−") or float(text) == 0 else f"+{text}"
