"""Does a result meet a requirement: met, not met, or it cannot be told yet.

What was measured has a normal density about its value, with its standard deviation. The
probability of conformity is what of it lies on the right side of the limit (JCGM 106:2012, The
role of measurement uncertainty in conformity assessment, section 7.3). A number that may be biased
beyond its deviation has no such density: of a doubtful result nothing is told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from acutance.arguments import require_all
from acutance.curves import METRICS, Estimate
from acutance.curves.estimate import normal_quantile
from acutance.curves.metric_bounds import limit_fault
from acutance.curves.metric_names import did_you_mean, metric_of
from acutance.errors import OptionError
from acutance.targets.recorded_direction import RecordedDirection
from acutance.targets.target_result import TargetResult
from acutance.targets.uncertainty_budget import (
    STATED_TERMS,
    SYSTEMATIC_TERMS,
    TERMS,
    systematic_share,
)

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement
    from acutance.targets.record import Record

__all__ = [
    "MET",
    "NOT_MET",
    "OPEN",
    "Conformity",
    "ConformityWord",
    "ToleranceLimit",
    "conformity_of",
    "conformity_word",
    "written_probability",
]

ConformityWord = Literal["met", "not met", "cannot be told yet"]

MET: Final = "met"
NOT_MET: Final = "not met"
OPEN: Final = "cannot be told yet"

Numbers = Mapping[str, Mapping[str, Estimate | None]]
"""Numbers by direction and name."""

Parts = Mapping[str, "Sequence[Measurement | Record]"]
"""The measurements that the numbers of a direction are of."""

_FORM = re.compile(r"(?:(across|along)\s*\.\s*)?([^<>=.]+)([<>])\s*=([^<>=]+)")
_STRICT = re.compile(r"[<>](?!\s*=)")
_MOST: Final = 1000
"""More measurements than this are no answer."""
_NAMED: Final = 0.1
"""Terms that measurements share are named from this share of the variance of all of them on."""


@dataclass(frozen=True)
class ToleranceLimit:
    """What a number has to reach, or may not exceed.

    Parameters
    ----------
    metric : str
        One of the numbers of a measurement: "mtf_nyquist".
    sense : {">=", "<="}
        Whether the limit is a minimum or a maximum.
    limit : float
    orientation : {"across", "along"}, optional
        The direction that is meant; every measured one without it.
    confidence : float, optional
        Probability from which it is met, and from which it is not met: above .5, below 1.

    Raises
    ------
    OptionError
        If there is no such number, or a value is none that it can have.

    Examples
    --------
    >>> from acutance.targets import ToleranceLimit
    >>> print(ToleranceLimit.of("across.mtf_nyquist >= 0.09"))
    across.mtf_nyquist >= 0.09
    """

    metric: str
    sense: Literal[">=", "<="]
    limit: float
    orientation: Literal["across", "along"] | None = None
    confidence: float = 0.95

    def __post_init__(self) -> None:
        if self.metric not in METRICS:
            meant = did_you_mean(self.metric) if isinstance(self.metric, str) else ""
            raise OptionError(
                f"a requirement asks for {self.metric!r}, which is no number of a measurement, "
                f"only {', '.join(METRICS)}{meant}"
            )
        if self.sense not in (">=", "<=") or not math.isfinite(self.limit):
            raise OptionError(f"the requirement {self} has no limit: give a number after >= or <=")
        if fault := limit_fault(self.metric, self.limit):
            raise OptionError(f"the requirement {self} cannot be tested: {fault}")
        if self.orientation not in (None, "across", "along"):
            raise OptionError(f"a requirement is across or along track, not {self.orientation!r}")
        if not 0.5 < self.confidence < 1:
            raise OptionError(
                f"the confidence of {self} is {self.confidence!r}: give a probability above 0.5 "
                "and below 1"
            )

    @classmethod
    def of(cls, text: str) -> ToleranceLimit:
        """The limit that a text states: "mtf_nyquist >= 0.09", "along.fwhm_m <= 1.5".

        A number may be named as reports print it, too: "MTF at Nyquist >= 0.09", "FWHM <= 1.5".

        Raises
        ------
        OptionError
            If it states none.
        """
        if not isinstance(text, str):
            raise OptionError(
                f"the requirement is {text!r:.80}, no text: write 'mtf_nyquist >= 0.09', or give a "
                "ToleranceLimit"
            )
        found = _FORM.fullmatch(" ".join(text.split()))
        try:
            orientation, metric, sense, number = found.groups()  # type: ignore[union-attr]
            limit = float("".join(number.split()))
        except (AttributeError, ValueError):
            strict = (
                " (of a number with a deviation > asks the same as >=, and < as <=)"
                if _STRICT.search(text)
                else ""
            )
            raise OptionError(
                f"the requirement {text!r} is not of the form NUMBER>=LIMIT or NUMBER<=LIMIT"
                f"{strict}: write mtf_nyquist>=0.09, or along.fwhm_m<=1.5 for one direction"
            ) from None
        metric = metric_of(metric.strip())
        return cls(metric, f"{sense}=", limit, orientation)  # type: ignore[arg-type]

    def __str__(self) -> str:
        return self.sentence if self.orientation is None else f"{self.orientation}.{self.sentence}"

    @property
    def sentence(self) -> str:
        """Metric, sense and limit."""
        return f"{self.metric} {self.sense} {self.limit:g}"

    def probability(self, number: Estimate) -> float:
        """How probable it is that the true value keeps the limit; ``nan`` where there is none."""
        above = number.probability_above(self.limit)
        return above if self.sense == ">=" else 1 - above


@dataclass(frozen=True)
class Conformity:
    """What a result says of a requirement, in one direction.

    Attributes
    ----------
    asked : ToleranceLimit
    orientation : str
        "across" or "along".
    number : Estimate or None
        What was measured.
    word : {"met", "not met", "cannot be told yet"}
    probability : float or None
        That it is met; ``None`` where nothing is told.
    reason : str
        Why it cannot be told.
    """

    asked: ToleranceLimit
    orientation: str
    number: Estimate | None
    word: ConformityWord
    probability: float | None
    reason: str = ""

    @property
    def summary(self) -> str:
        """The answer in a sentence."""
        asked = f"{self.orientation}: {self.asked.sentence}"
        if self.probability is None:
            return f"{asked} {self.word}: {self.reason}"
        told = f"probability of being met {written_probability(self.probability)}"
        if self.word == OPEN:
            return f"{asked} {self.word} ({told}): {self.number}; {self.reason}"
        return f"{asked} is {self.word} ({told}): {self.number}"

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        return {
            "metric": self.asked.metric,
            "sense": self.asked.sense,
            "limit": self.asked.limit,
            "confidence": self.asked.confidence,
            "orientation": self.orientation,
            "number": None if self.number is None else self.number.to_dict(),
            "word": self.word,
            "probability": self.probability,
            "summary": self.summary,
        }


def conformity_of(
    result: Measurement | Record | TargetResult[Measurement],
    limits: Sequence[ToleranceLimit | str],
) -> tuple[Conformity, ...]:
    """What a result says of requirements: one answer a limit and direction.

    Parameters
    ----------
    result : Measurement, Record or TargetResult
        Of all edges of a target the means are asked.
    limits : sequence of ToleranceLimit or str
        As `ToleranceLimit.of` reads them.

    Raises
    ------
    OptionError
        If a text states no limit.
    """
    limits = require_all(object, "the requirements", limits)
    stated = [one if isinstance(one, ToleranceLimit) else ToleranceLimit.of(one) for one in limits]
    if isinstance(result, TargetResult):
        numbers, doubts = _of_target(result)
        parts: Parts = {name: group.measurements for name, group in result.groups.items()}
    else:
        numbers, doubts = _of_one(result)
        parts = dict.fromkeys(numbers, (result,))
    return tuple(
        _answer(limit, name, numbers, doubts.get(name, ""), parts)
        for limit in stated
        for name in ([limit.orientation] if limit.orientation else numbers)
    )


def _of_one(result: Measurement | Record) -> tuple[Numbers, dict[str, str]]:
    """The measured directions, and why none of their numbers tells anything."""
    verdict, names = result.verdict, result.measured_directions
    doubt = f"the measurement is {verdict.word}" if verdict.warns else ""
    numbers = {
        str(name): one.numbers if isinstance(one, RecordedDirection) else one.metrics()
        for name, one in result.directions.items()
        if name in names
    }
    return numbers, dict.fromkeys(numbers, doubt)


def _of_target(result: TargetResult[Measurement]) -> tuple[Numbers, dict[str, str]]:
    """The same of the means of the edges of a target."""
    doubts = {
        name: "no edge of this direction is good or usable"
        for name, group in result.groups.items()
        if any(one.verdict.warns for one in group.measurements)
    }
    return {name: group.metrics for name, group in result.groups.items()}, doubts


def conformity_word(probability: float, confidence: float) -> ConformityWord:
    """Met from a probability on, not met from the contrary on."""
    if probability >= confidence:
        return MET
    return NOT_MET if probability <= 1 - confidence else OPEN


def written_probability(probability: float) -> str:
    """A probability that never looks like a certainty."""
    if probability > 0.999:
        return "> 0.999"
    return "< 0.001" if probability < 0.001 else f"{probability:.3f}"


def _answer(
    limit: ToleranceLimit, orientation: str, numbers: Numbers, doubt: str, parts: Parts
) -> Conformity:
    """The answer to one limit in one direction, or why there is none."""
    if orientation not in numbers:
        reason = f"what was measured shows {' and '.join(numbers)} track only"
        return Conformity(limit, orientation, None, OPEN, None, reason)
    number = numbers[orientation].get(limit.metric)
    probability = math.nan if number is None else limit.probability(number)
    if doubt or number is None or math.isnan(probability):
        reason = doubt or _missing(limit.metric, number)
        return Conformity(limit, orientation, number, OPEN, None, reason)
    word = conformity_word(probability, limit.confidence)
    reason = ""
    if word == OPEN:
        reason = _what_would_tell(limit, number, orientation, parts[orientation])
    return Conformity(limit, orientation, number, word, probability, reason)


def _missing(metric: str, number: Estimate | None) -> str:
    """Why there is no number, or no density of it."""
    if number is None:
        wanted = "the GSD is not known, state it" if metric.endswith("_m") else "it is not there"
        return f"{metric} was not measured: {wanted}"
    if math.isfinite(number.value):
        return f"{metric} has no standard deviation"
    return f"{metric} has no value: the curve does not fall so far"


def _what_would_tell(
    limit: ToleranceLimit,
    number: Estimate,
    orientation: str,
    parts: Sequence[Measurement | Record],
) -> str:
    """The deviation that would tell, if the value is what it seems."""
    needed = abs(number.value - limit.limit) / normal_quantile(2 * limit.confidence - 1)
    if number.std > math.sqrt(_MOST) * needed:
        return "the value is too near the limit to be told by more measurements"
    shared = min(_shared_std(parts, orientation, limit.metric), number.std)
    if shared >= needed:
        causes = _shared_causes(parts, orientation, limit.metric)
        words = " and ".join(TERMS[name].label for name in causes)
        leave = "leaves" if len(causes) == 1 else "leave"
        advice = (
            "state it with less uncertainty, or measure another target"
            if STATED_TERMS.issuperset(causes[:1])
            else "a longer target, or one of more contrast, has less of it"
        )
        return (
            f"more measurements of this target would not tell: {words} {leave} a standard "
            f"deviation of {shared:.2g} to all of them, and {needed:.2g} would tell; {advice}"
        )
    # What they share remains, the rest falls with the square root of their number.
    count = math.ceil((number.std**2 - shared**2) / (needed**2 - shared**2))
    if count > _MOST:
        return "the value is too near the limit to be told by more measurements"
    return f"about {count} measurements like this one would tell, as far as their errors differ"


def _shared_std(parts: Sequence[Measurement | Record], orientation: str, metric: str) -> float:
    """What all measurements share gives this deviation to a number, and to a mean of it."""
    stds = [
        number.std * math.sqrt(systematic_share(one.budget, orientation, metric))
        for one in parts
        for name, response in one.directions.items()
        if name == orientation and (number := getattr(response, metric)) is not None
    ]
    return sum(stds) / len(stds) if stds else 0.0


def _shared_causes(
    parts: Sequence[Measurement | Record], orientation: str, metric: str
) -> list[str]:
    """The terms of a number that all measurements share, the largest first."""
    shares = {
        name: max(
            systematic_share(one.budget, orientation, metric, frozenset((name,))) for one in parts
        )
        for name in SYSTEMATIC_TERMS
    }
    ranked = sorted(shares, key=lambda name: (-shares[name], name))
    return [name for name in ranked if shares[name] > _NAMED * sum(shares.values())]
