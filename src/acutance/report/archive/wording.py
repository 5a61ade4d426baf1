"""How changes of a sensor are put into words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.labels import format_number

if TYPE_CHECKING:
    from acutance.archive.trends import EventEffect, Trend
    from acutance.curves import Estimate

__all__ = ["event_percent", "interval_words", "percent"]

_LEVEL = 0.95


def percent(estimate: Estimate, *, sign: bool = True) -> str:
    """A relative change in per cent, with its standard deviation."""
    value = 100 * estimate.value if sign else 100 * abs(estimate.value)
    return f"{value:{'+' if sign else ''}.1f} ± {100 * estimate.std:.1f} %".replace("-", "−")


def event_percent(trend: Trend, event: EventEffect) -> str:
    """What a stated event changed, in per cent of the level."""
    return percent((1 / (trend.level.value or 1.0)) * event.size)


def interval_words(estimate: Estimate, scale: float = 1.0) -> str:
    """The 95 % interval."""
    low, high = estimate.interval(_LEVEL)
    return f"{format_number(scale * low, 3)} to {format_number(scale * high, 3)}".replace("-", "−")
