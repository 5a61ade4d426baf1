"""One question that is asked of a target: its limit, and what a failure means."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["PLACES", "Question", "Sense", "Severity"]

Sense = Literal[">=", "<="]
Severity = Literal["note", "caution", "fail"]

PLACES = {
    "dark": "on the dark side",
    "bright": "on the bright side",
    "before": "before the pulse",
    "behind": "behind the pulse",
}
"""Where a target's two plateaus lie."""


@dataclass(frozen=True)
class Question:
    """One question.

    Parameters
    ----------
    question, advice, source : str
        What is asked; consequences if the limit is not kept, and what to do; where it comes from.
    sense : {">=", "<="}
        Whether the limit is a minimum or a maximum.
    limit : float
        The default limit.
    severity : {"note", "caution", "fail"}
        note: the intervals are wide, or a fact to know. caution: a bias that the intervals may not
        hold. fail: the numbers have no meaning.
    caution : float, optional
        Of a note: the value beyond which it is a caution.
    """

    question: str
    sense: Sense
    limit: float
    advice: str
    source: str = ""
    severity: Severity = "caution"
    caution: float | None = None
