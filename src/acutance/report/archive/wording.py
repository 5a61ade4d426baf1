"""How changes of a sensor are put into words."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from acutance.archive.trends.words import signed as signed_number
from acutance.archive.trends.words import size_words
from acutance.report.labels import MISSING, word_estimate

if TYPE_CHECKING:
    from acutance.archive.trends import Change, EventEffect, Trend
    from acutance.curves import Estimate

__all__ = [
    "interval_words",
    "percent",
    "rate_words",
    "signed",
    "step_percent",
    "step_words",
    "with_minus",
]

_NEGATIVE = re.compile(r"(?<![\w.])-(?=[\d.])")


def percent(estimate: Estimate, *, sign: bool = True) -> str:
    """A relative change in per cent, with its standard deviation."""
    value = 100 * estimate.value if sign else 100 * abs(estimate.value)
    return f"{value:{'+' if sign else ''}.1f} ± {100 * estimate.std:.1f} %".replace("-", "−")


def step_percent(step: Change | EventEffect) -> str:
    """A step, found or stated, in per cent of the level before it; a dash where that may be 0."""
    return MISSING if math.isnan(step.relative_size.value) else percent(step.relative_size)


def step_words(step: Change | EventEffect) -> str:
    """The same; where the level may be 0, in the units of the metric."""
    return with_minus(size_words(step)) if step_percent(step) == MISSING else step_percent(step)


def rate_words(trend: Trend, *, sign: bool = True) -> str:
    """The drift a year in per cent of the level; where that may be 0, in units of the metric."""
    rate = trend.rate_per_year
    if trend.has_scale:
        return percent(trend.relative_rate_per_year, sign=sign)
    return with_minus(signed_number(rate)) if sign else str(rate if rate.value > 0 else -rate)


def interval_words(estimate: Estimate) -> str:
    """The 95 % interval, with the digits of the standard deviation."""
    words = word_estimate(estimate)
    return words.low if words.low == MISSING else f"{words.low} to {words.high}"


def signed(value: float) -> str:
    """A number with its sign and one decimal; 0 has none."""
    text = f"{value:+.1f}".replace("-", "−")
    return text if text[1:] != "0.0" else "0.0"


def with_minus(text: str) -> str:
    """A text whose negative numbers have a minus, and no hyphen."""
    return _NEGATIVE.sub("−", text)
