"""Checks: the questions asked of a target, the answers found, and the verdict.

The questions of all kinds of target, with their limits, sources and advice, stand in
`acutance.targets.check_table`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, overload

from acutance.arguments import require_choice
from acutance.errors import OptionError
from acutance.targets.check_table import QUESTIONS
from acutance.targets.document_fields import refuse_damaged
from acutance.targets.question import Question, Sense, Severity, limit_range

__all__ = [
    "MAX_RATIO",
    "Check",
    "Checks",
    "HasChecks",
    "Limits",
    "Verdict",
    "VerdictWord",
    "answer",
    "bounded_ratio",
    "count_failed",
    "limit_of",
    "require_limits",
    "verdict_of",
]

Limits = Mapping[str, float]
"""Limits that a caller sets instead of those of the table, by the names of the checks."""

VerdictWord = Literal["good", "usable", "doubtful", "invalid"]

MAX_RATIO = 999.0
"""Stands for larger ratios and those without bound, such as contrast without noise."""

_WORDS: dict[Severity, VerdictWord] = {"fail": "invalid", "caution": "doubtful", "note": "usable"}


@dataclass(frozen=True)
class Check:
    """One question asked of a target, with the answer and its limit.

    Parameters
    ----------
    name : str
        The question's name in `QUESTIONS`.
    value : float
        What was found.
    sense : {">=", "<="}
        Whether the limit is a minimum or a maximum.
    limit : float
        The limit asked for.
    passed : bool
    message : str
        What was found, in words; where the limit is not kept, also what it means and what to do.
    severity : {"note", "caution", "fail"}
        What it means if it does not pass: wide intervals; a bias that the intervals may not hold;
        numbers that mean nothing.
    """

    name: str
    value: float
    sense: Sense
    limit: float
    passed: bool
    message: str
    severity: Severity = "caution"

    @property
    def asked(self) -> str:
        """The limit as text: ">= 50"."""
        return f"{self.sense} {self.limit:g}"

    @property
    def excess(self) -> float:
        """How many times the value is beyond the limit; 0 of a check that passed.

        Where there should be none, any are beyond: as many times as there are, and once more.
        """
        if self.passed:
            return 0.0
        if self.sense == "<=" and self.limit == 0:
            return 1.0 + self.value
        over, under = (self.value, self.limit) if self.sense == "<=" else (self.limit, self.value)
        return over / under if under > 0 else math.inf

    @property
    def question(self) -> str:
        """What is asked, as a sentence; empty for a check that the table does not have."""
        found = QUESTIONS.get(self.name)
        return "" if found is None else found.question

    @property
    def source(self) -> str:
        """Where the limit comes from; empty where simulations of this program set it."""
        found = QUESTIONS.get(self.name)
        return "" if found is None else found.source

    def to_dict(self) -> dict[str, Any]:
        """The check for JSON: `limit` as text, `limit_value` as a number."""
        return {
            "name": self.name,
            "value": self.value if math.isfinite(self.value) else None,
            "limit": self.asked,
            "sense": self.sense,
            "limit_value": self.limit if math.isfinite(self.limit) else None,
            "severity": self.severity,
            "passed": self.passed,
            "message": self.message,
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Check:
        """The check that `to_dict` wrote; of older documents the limit is read from its text.

        Raises
        ------
        OptionError
            If it is none, or damaged.
        """
        with refuse_damaged("a check", "give what to_dict() returned"):
            severity = document.get("severity", "caution")
            require_choice(_WORDS, severity=severity)
            sense, _, number = str(document["limit"]).partition(" ")
            limit = document.get("limit_value", number or math.nan)
            value = document["value"]
            return cls(
                str(document["name"]),
                math.nan if value is None else float(value),
                "<=" if sense == "<=" else ">=",
                math.nan if limit is None else float(limit),
                bool(document["passed"]),
                str(document["message"]),
                severity,
            )


@dataclass(frozen=True)
class Verdict:
    """The summary of the checks of a measurement.

    Parameters
    ----------
    word : {"good", "usable", "doubtful", "invalid"}
        All checks passed; only notes failed (the intervals are wide, but hold); a check failed
        that may bias the numbers; the numbers have no meaning.
    sentence : str
        What matters most.
    """

    word: VerdictWord
    sentence: str

    def __str__(self) -> str:
        return f"{self.word}: {self.sentence}"

    def to_dict(self) -> dict[str, str]:
        """Both, for JSON."""
        return {"word": self.word, "sentence": self.sentence}

    @property
    def warns(self) -> bool:
        """Whether the numbers may be biased, or have no meaning."""
        return self.word in ("doubtful", "invalid")


def limit_of(name: str, limits: Limits) -> float:
    """The limit of a check: the caller's, or that of the table."""
    return limits.get(name, QUESTIONS[name].limit)


def answer(
    name: str,
    value: float,
    found: str,
    limits: Limits,
    *,
    default: float | None = None,
    caution: float | None = None,
    advice: str | None = None,
) -> Check:
    """Ask one question of the table.

    Parameters
    ----------
    name : str
        Of the question.
    value : float
        What was found.
    found : str
        The same in words.
    limits : mapping of str to float
        Limits the caller changed.
    default : float, optional
        The limit of a method to which that of the table does not apply.
    caution : float, optional
        Of a note: from where on it is a caution, where that of the table does not apply.
    advice : str, optional
        What to do, where it depends on the target and the table cannot hold it.
    """
    asked = QUESTIONS[name]
    limit = limits.get(name, asked.limit if default is None else default)
    passed = bool(value >= limit if asked.sense == ">=" else value <= limit)
    advice = asked.advice if advice is None else advice
    message = found if passed or not advice else f"{found}: {advice}"
    severity = _severity(asked, value, limit, asked.caution if caution is None else caution)
    return Check(name, float(value), asked.sense, limit, passed, message, severity)


def _severity(asked: Question, value: float, limit: float, caution: float | None) -> Severity:
    """The severity of a question, which far beyond the limit of a note may be that of a caution."""
    if caution is None:
        return asked.severity
    if asked.sense == ">=":
        return "caution" if value < min(caution, limit) else asked.severity
    return "caution" if value > max(caution, limit) else asked.severity


def bounded_ratio(over: float, under: float) -> float:
    """A ratio, at most `MAX_RATIO`."""
    return min(over / under, MAX_RATIO) if under > 0 else MAX_RATIO


def count_failed(checks: Sequence[Check]) -> str:
    """ "2 of 17 checks failed (rows, profile)"."""
    failed = [check.name for check in checks if not check.passed]
    names = f" ({', '.join(failed)})" if failed else ""
    return f"{len(failed)} of {len(checks)} checks failed{names}"


def verdict_of(checks: Iterable[Check]) -> Verdict:
    """The verdict: that of the gravest check that failed, with its message.

    Of several equally grave ones, that which is farthest beyond its limit.
    """
    failed = [check for check in checks if not check.passed]
    if not failed:
        return Verdict("good", "every check passed")
    gravity = list(_WORDS)[::-1].index
    gravest = max(failed, key=lambda check: (gravity(check.severity), check.excess))
    return Verdict(_WORDS[gravest.severity], gravest.message)


class HasChecks:
    """What follows from the checks of whatever has some: a measurement, or its record."""

    if TYPE_CHECKING:

        @property
        def checks(self) -> Sequence[Check]: ...

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(check for check in self.checks if not check.passed)

    @property
    def trusted(self) -> bool:
        """Whether every check passed."""
        return not self.failed_checks

    @property
    def verdict(self) -> Verdict:
        """The summary of the checks, in a word and a sentence."""
        return verdict_of(self.checks)


def require_limits(limits: Any, known: Sequence[str], options: str) -> None:
    """Refuse limits that no check has, and those that are no numbers or mean nothing.

    An infinite limit is one that all answers keep, or none.

    Parameters
    ----------
    limits : mapping of str to float
    known : sequence of str
        The checks of the kind of target.
    options : str
        The class that holds them, for the message.

    Raises
    ------
    OptionError
        Names the limit, and those that there are.
    """
    if not isinstance(limits, Mapping):
        raise OptionError(
            f"{options}: limits has to be a dict of numbers by the names of checks, found "
            f"{limits!r:.80}"
        )
    for name, limit in limits.items():
        if name not in known:
            raise OptionError(
                f"{options}: there is no check {name!r} to limit (limits, --limit), only "
                f"{', '.join(sorted(known))}"
            )
        if not isinstance(limit, Real) or isinstance(limit, bool) or math.isnan(limit):
            raise OptionError(f"{options}: the limit of {name} has to be a number, found {limit!r}")
        low, high = limit_range(name)
        number = float(limit)
        if math.isfinite(number) and not low <= number <= high:
            wanted = f"from {low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"
            raise OptionError(
                f"{options}: the limit of {name} is {number:g}, and what is compared with it is "
                f"{wanted} (limits, --limit): give such a number; inf or -inf for a check that "
                "always or never passes"
            )


class Checks(Sequence[Check]):
    """Checks of a target, computed when they are first read: they cost as much as a fit.

    Parameters
    ----------
    compute : function without arguments
        Returns the checks.
    """

    def __init__(self, compute: Callable[[], tuple[Check, ...]]) -> None:
        self._compute = compute

    @cached_property
    def answers(self) -> tuple[Check, ...]:
        """All checks."""
        return self._compute()

    def __repr__(self) -> str:
        return f"<{count_failed(self.answers)}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self.answers == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type, tuple[tuple[Check, ...]]]:
        # The pixels and fits from which the checks are computed are not pickled.
        return tuple, (self.answers,)

    def __len__(self) -> int:
        return len(self.answers)

    def __iter__(self) -> Iterator[Check]:
        return iter(self.answers)

    @overload
    def __getitem__(self, index: int) -> Check: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Check, ...]: ...

    def __getitem__(self, index: int | slice) -> Check | tuple[Check, ...]:
        return self.answers[index]
