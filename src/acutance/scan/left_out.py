"""Why edges of a scene are left out: sentences that differ only in their numbers, as one."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from acutance.targets.check_table import QUESTIONS

__all__ = ["LeftOut", "left_out_by_reason"]

_NUMBER = re.compile(r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_BLANK = "#"
_SIDES = re.compile(r"\bthe (?:dark|bright) side\b")


class LeftOut(NamedTuple):
    """Edges that are left out for one reason.

    Attributes
    ----------
    edges : int
        How many.
    verdict : str
    check : str
        That failed; empty of an error.
    reason : str
        The most frequent wording, with the medians of its numbers.
    """

    edges: int
    verdict: str
    check: str
    reason: str


class _Parted(NamedTuple):
    """Attributes: check (empty of an error), kind (what tells it from others), found."""

    check: str
    kind: str
    found: str


def left_out_by_reason(
    left_out: Iterable[tuple[str, str]], number: Callable[[float], str] = "{:.3g}".format
) -> list[LeftOut]:
    """Edges by verdict and check or kind of error, the most frequent first.

    Parameters
    ----------
    left_out : iterable of (str, str)
        Verdict and reason of every edge.
    number : function, optional
        Writes a median.
    """
    groups: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for verdict, reason in left_out:
        one = _parted(reason)
        groups[verdict, one.check, one.kind].append(one.found)
    ordered = sorted(groups.items(), key=lambda group: -len(group[1]))
    return [
        LeftOut(len(found), verdict, check, _with_medians(found, number))
        for (verdict, check, _), found in ordered
    ]


def _parted(reason: str) -> _Parted:
    """A sentence without its advice: that of a check has the advice of the table."""
    for name, question in QUESTIONS.items():
        if question.advice and reason.endswith(f": {question.advice}"):
            return _Parted(name, "", reason.removesuffix(f": {question.advice}"))
    found = re.split(r"[:;] (?=[^:;]*$)", reason)[0]
    return _Parted("", re.split("[:;]", _blank(found))[0], found)


def _blank(sentence: str) -> str:
    """A sentence without its numbers and sides."""
    return _SIDES.sub("one side", _NUMBER.sub(_BLANK, sentence))


def _with_medians(sentences: Sequence[str], number: Callable[[float], str]) -> str:
    """The most frequent wording, with the medians of its numbers."""
    wording, _ = Counter(map(_blank, sentences)).most_common(1)[0]
    alike = [_NUMBER.findall(one) for one in sentences if _blank(one) == wording]
    numbers = np.array([[float(one.replace("−", "-")) for one in row] for row in alike])
    medians = iter(np.median(numbers, axis=0).tolist())
    return re.sub(_BLANK, lambda _: number(next(medians)), wording)
