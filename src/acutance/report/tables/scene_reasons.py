"""Why edges of a scene are left out: sentences that differ only in their numbers, as one."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from acutance.report.html import Table
from acutance.report.labels import MISSING, format_number
from acutance.targets.check_table import QUESTIONS

if TYPE_CHECKING:
    from acutance.scan.edge_table import EdgeTable

__all__ = ["reasons_table"]

_ROWS = 14
_NUMBER = re.compile(r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_BLANK = "#"
_SIDES = re.compile(r"\bthe (?:dark|bright) side\b")


class _Reason(NamedTuple):
    """Attributes: verdict, check (empty of an error), kind (what tells it from others), found."""

    verdict: str
    check: str
    kind: str
    found: str


def reasons_table(edges: EdgeTable, most: int = _ROWS) -> Table:
    """Edges that are not used, by verdict and check or kind of error, the most frequent first.

    Parameters
    ----------
    edges : EdgeTable
        Of one band or several.
    most : int, optional
        Rows; all others are one.
    """
    columns = edges.columns()
    left_out = ~columns["used"]
    groups: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for verdict, reason in zip(
        columns["verdict"][left_out].tolist(), columns["reason"][left_out].tolist(), strict=True
    ):
        one = _parted(verdict, reason)
        groups[one.verdict, one.check, one.kind].append(one.found)
    ordered = sorted(groups.items(), key=lambda group: -len(group[1]))
    rows = [
        (str(len(found)), verdict, check or MISSING, _with_medians(found))
        for (verdict, check, _), found in ordered[:most]
    ]
    rest = sum(len(found) for _, found in ordered[most:])
    if rest:
        rows.append((str(rest), "", "", f"{len(ordered) - most} other reasons"))
    return Table(
        ("edges", "verdict", "check", "why; numbers are medians"), tuple(rows), "rlll",
        title="Edges left out", page_only=True,
        notes=(
            "Every edge counts once, with what is gravest. Those without a check could not be "
            "measured.",
        ),
    )  # fmt: skip


def _parted(verdict: str, reason: str) -> _Reason:
    """A sentence without its advice: that of a check has the advice of the table."""
    for name, question in QUESTIONS.items():
        if question.advice and reason.endswith(f": {question.advice}"):
            return _Reason(verdict, name, "", reason.removesuffix(f": {question.advice}"))
    found = re.split(r"[:;] (?=[^:;]*$)", reason)[0]
    return _Reason(verdict, "", re.split("[:;]", _blank(found))[0], found)


def _blank(sentence: str) -> str:
    """A sentence without its numbers and sides."""
    return _SIDES.sub("one side", _NUMBER.sub(_BLANK, sentence))


def _with_medians(sentences: Sequence[str]) -> str:
    """The most frequent wording, with the medians of its numbers."""
    wording, _ = Counter(map(_blank, sentences)).most_common(1)[0]
    alike = [_NUMBER.findall(one) for one in sentences if _blank(one) == wording]
    numbers = np.array([[float(one.replace("−", "-")) for one in row] for row in alike])
    medians = iter(np.median(numbers, axis=0).tolist())
    filled = re.sub(_BLANK, lambda _: format_number(next(medians), 3), wording)
    return filled[:1].upper() + filled[1:]
