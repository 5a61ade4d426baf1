"""The answers of a comparison: every pair of groups, and the scatter between all of them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import Any

from acutance.archive.comparisons.difference import Difference
from acutance.archive.comparisons.groups import NEVER_MIXED
from acutance.curves import Estimate

__all__ = ["GroupComparison", "GroupScatter"]


@dataclass(frozen=True, kw_only=True)
class GroupScatter:
    """How three or more groups scatter about their mean.

    Attributes
    ----------
    of : str
        Sensor, band, product level and direction, as far as they are not compared.
    by : str
    offsets : dict of str to Estimate
        Of every group from the mean of all, over that mean; without a deviation where none of its
        differences has one.
    scatter : Estimate
        Between the groups, over their mean, beyond the deviations of the offsets; ``nan`` where
        fewer than three have one.
    interval : (float, float)
        95 % interval of the scatter.
    """

    of: str
    by: str
    offsets: dict[str, Estimate]
    scatter: Estimate
    interval: tuple[float, float]

    @property
    def sentence(self) -> str:
        """The scatter in one sentence."""
        of = f"{self.of}: " if self.of else ""
        known = [one for one in self.offsets.values() if math.isfinite(one.std)]
        if not math.isfinite(self.scatter.value):
            return f"{of}how {len(self.offsets)} {self.by}s scatter cannot be told."
        low, high = (100 * end for end in self.interval)
        return (
            f"{of}{len(known)} {self.by}s scatter by "
            f"{100 * self.scatter.value:.1f} % (95 %: {low:.1f} to {high:.1f} %)."
        )

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        return {
            "of": self.of,
            "by": self.by,
            "offsets": {name: one.to_dict() for name, one in self.offsets.items()},
            "scatter": self.scatter.to_dict(),
            "interval": [end if math.isfinite(end) else None for end in self.interval],
            "sentence": self.sentence,
        }


@dataclass(frozen=True, kw_only=True)
class GroupComparison:
    """Whether groups of measurements differ.

    Attributes
    ----------
    metric, by : str
    groups : tuple of str
        Names of all that occur, whether there is another one to compare each with or not.
    differences : tuple of Difference
        Of every two groups of one sensor, band, product level and direction; empty where there
        are no two.
    scatters : tuple of GroupScatter
        Where there are three groups or more.
    notes : tuple of str
        What is peculiar about the images: dates that no image can have.
    """

    metric: str
    by: str
    groups: tuple[str, ...]
    differences: tuple[Difference, ...]
    scatters: tuple[GroupScatter, ...]
    notes: tuple[str, ...] = ()

    @property
    def summary(self) -> str:
        """All answers, a line each; where there is none, why."""
        return "\n".join(self._lines()) or self._nothing

    @property
    def _nothing(self) -> str:
        """What was found in place of two groups, and what to do."""
        nothing = f"there are no two {self.by}s to be compared"
        if not self.groups:
            return (
                f"{nothing}: no measurement has {self.metric} and a known {self.by}; compare "
                "another number, or by something else"
            )
        listed = ", ".join(self.groups)
        if len(self.groups) == 1:
            return (
                f"{nothing}: all measurements are of one {self.by}, {listed}; add measurements of "
                "another one, or widen the filters"
            )
        same = " and ".join(name for name in NEVER_MIXED if name != self.by)
        return (
            f"{nothing}: there are {listed}, but no two of them with the same {same}; add such "
            "measurements, or compare by something else"
        )

    def _lines(self) -> Iterator[str]:
        for one in self.differences:
            yield one.summary
        for scatter in self.scatters:
            yield scatter.sentence
        if self.differences:
            yield from self.notes

    def to_dict(self) -> dict[str, Any]:
        """All answers as strict JSON types."""
        return {
            "metric": self.metric,
            "by": self.by,
            "groups": list(self.groups),
            "differences": [one.to_dict() for one in self.differences],
            "scatters": [one.to_dict() for one in self.scatters],
            "notes": list(self.notes),
        }

    def _repr_html_(self) -> str:
        return "".join(f"<p>{escape(line)}</p>" for line in self.summary.splitlines())
