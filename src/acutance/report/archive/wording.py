"""How changes of a sensor are put into words."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from acutance.report.labels import MISSING, word_estimate

if TYPE_CHECKING:
    from acutance.archive.trends import EventEffect, Trend
    from acutance.curves import Estimate

__all__ = ["event_percent", "interval_words", "percent", "signed", "with_minus"]

_NEGATIVE = re.compile(r"(?<![\w.])-(?=[\d.])")


def percent(estimate: Estimate, *, sign: bool = True) -> str:
    """A relative change in per cent, with its standard deviation."""
    value = 100 * estimate.value if sign else 100 * abs(estimate.value)
    return f"{value:{'+' if sign else ''}.1f} ± {100 * estimate.std:.1f} %".replace("-", "−")


def event_percent(trend: Trend, event: EventEffect) -> str:
    """What a stated event changed, in per cent of the level."""
    return percent((1 / (trend.level.value or 1.0)) * event.size)


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
