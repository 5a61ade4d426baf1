"""What came out of a batch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from acutance.curves.short_repr import ShortRepr

__all__ = ["BatchSummary", "Tally"]

VERDICTS = ("good", "usable", "doubtful", "invalid")
_ELSEWHERE = ("outside", "not there then")
"""Rejections of targets that the image does not show: nothing went wrong."""


@dataclass(frozen=True, eq=False)
class BatchSummary(ShortRepr):
    """Counts of a batch: rows of the archive, those that were there before among them.

    Parameters
    ----------
    archive : str
    images : int
        Of the plan.
    unreadable : tuple of str
        Images that could not be read now.
    done_before : int
        Rows that were there already.
    kept : int
        Rows that were added.
    verdicts : mapping of str to int
        Measured rows by verdict.
    reasons : mapping of str to int
        Rejected rows by their reason in a word or two.
    measuring_s : float
        Spent in measurements, over all workers.
    elapsed_s : float
    run : int or None
        Number of the run in the archive; None if there was nothing to do.
    """

    archive: str
    images: int
    unreadable: tuple[str, ...] = ()
    done_before: int = 0
    kept: int = 0
    verdicts: Mapping[str, int] = field(default_factory=dict)
    reasons: Mapping[str, int] = field(default_factory=dict)
    measuring_s: float = 0.0
    elapsed_s: float = 0.0
    run: int | None = None

    @property
    def measured(self) -> int:
        """Rows with a measurement."""
        return sum(self.verdicts.values())

    @property
    def rejected(self) -> int:
        """Rows without one, targets that the images do not show among them."""
        return sum(self.reasons.values())

    @property
    def failed(self) -> int:
        """Rows that ``--strict`` objects to: rejected in their image, doubtful or invalid."""
        elsewhere = sum(self.reasons.get(one, 0) for one in _ELSEWHERE)
        weak = self.verdicts.get("doubtful", 0) + self.verdicts.get("invalid", 0)
        return self.rejected - elsewhere + weak

    def summary(self) -> str:
        """Rows, and how they came out."""
        by_verdict = ", ".join(f"{self.verdicts[one]} {one}" for one in self.verdicts)
        return (
            f"{self.images} images, {self.kept} rows added, {self.done_before} there before; "
            f"measured {self.measured} ({by_verdict or 'none'}), rejected {self.rejected}"
        )

    def to_dict(self) -> dict[str, Any]:
        """All counts, for JSON."""
        return {
            "schema": "acutance/batch/1",
            "archive": self.archive,
            "images": self.images,
            "unreadable": list(self.unreadable),
            "done_before": self.done_before,
            "kept": self.kept,
            "measured": self.measured,
            "rejected": self.rejected,
            "verdicts": dict(self.verdicts),
            "reasons": dict(self.reasons),
            "measuring_s": round(self.measuring_s, 3),
            "elapsed_s": round(self.elapsed_s, 3),
            "run": self.run,
        }


class Tally:
    """Rows counted by verdict and by reason."""

    def __init__(self) -> None:
        self.verdicts: Counter[str] = Counter()
        self.reasons: Counter[str] = Counter()

    def add(self, verdict: str | None, reason: str | None) -> None:
        """Count a row: its verdict, or the reason why it was not measured."""
        if verdict is not None:
            self.verdicts[verdict] += 1
        else:
            self.reasons[reason or "rejected"] += 1

    def by_verdict(self) -> dict[str, int]:
        """Counts, the best verdict first."""
        return {one: self.verdicts[one] for one in VERDICTS if self.verdicts[one]}

    def by_reason(self) -> dict[str, int]:
        """Counts, the most frequent reason first."""
        return dict(self.reasons.most_common())
