"""Whether a result meets requirements: lines of text, boxes of a page, a part of a document."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal

from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.html import Verdict
from acutance.targets import Record
from acutance.targets.conformity import MET, NOT_MET, OPEN, ToleranceLimit, conformity_of

if TYPE_CHECKING:
    from acutance.targets.conformity import Conformity

__all__ = ["Required", "answers_to", "required_lines", "required_verdicts", "with_requirements"]

Required = Sequence[ToleranceLimit | str]
"""Requirements as limits, or as texts: "mtf_nyquist >= 0.09"."""

_COLOURS: Final[Mapping[str, Literal["good", "usable", "doubtful", "invalid"]]] = {
    MET: "good", NOT_MET: "invalid", OPEN: "usable",
}  # fmt: skip


def answers_to(result: Result | Record, required: Required) -> tuple[tuple[str, Conformity], ...]:
    """What a result says of requirements, with the label of the method where there are several.

    Parameters
    ----------
    result : Measurement, TargetResult, Comparison or sequence of Measurement
    required : sequence of ToleranceLimit or str

    Raises
    ------
    OptionError
        If a text states no limit.
    """
    found = result if isinstance(result, Record) else as_result(result)
    if not isinstance(found, Comparison):
        return tuple(("", one) for one in conformity_of(found, required))
    return tuple(
        (label, answer)
        for label, one in zip(found.labels, found.measurements, strict=True)
        for answer in conformity_of(one, required)
    )


def required_lines(
    result: Result | Record, required: Required, title: str = "Required"
) -> list[str]:
    """The answers as one text under a title, if there are any."""
    lines = [f"  {_sentence(*one)}" for one in answers_to(result, required)]
    return ["\n".join([title, *lines])] if lines else []


def required_verdicts(
    result: Result | Record, required: Required, label: str = ""
) -> tuple[Verdict, ...]:
    """The answers as boxes of a page, in the colours of verdicts."""
    return tuple(
        Verdict(_COLOURS[answer.word], f"{label}Required {_sentence(method, answer)}")
        for method, answer in answers_to(result, required)
    )


def _sentence(method: str, answer: Conformity) -> str:
    return f"{method}, {answer.summary}" if method else answer.summary


def with_requirements(
    document: dict[str, Any], result: Result, required: Required
) -> dict[str, Any]:
    """A document with the answers; the same where nothing is required."""
    answers = [
        {**({"method": method} if method else {}), **answer.to_dict()}
        for method, answer in answers_to(result, required)
    ]
    return {**document, "requirements": answers} if answers else document
