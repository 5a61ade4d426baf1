"""Checks of the ground beside a straight target, as the reference estimator fitted it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.check import Check, Limits, answer
from acutance.targets.question import PLACES
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.rim import find_rim

__all__ = ["ground_checks", "rim"]

_Span = tuple[float, float, float]
_CLOSE_WIDTHS = 2.5
_MIN_LEVEL = 0.003
"""Share of the contrast below which ground is taken as even when the two sides are compared."""


def ground_checks(
    data: CheckData, limits: Limits, sides: tuple[str, str], *, steps: int
) -> tuple[Check, ...]:
    """What lies beside the target; nothing where the method has no model of it.

    Parameters
    ----------
    data : CheckData
    limits : mapping of str to float
    sides : (str, str)
        Names of the sides before and behind the target.
    steps : int
        Of the target: 1 of an edge, 2 of a pulse.
    """
    if not isinstance(data.fit, SplineEdge):
        return ()
    close_px = _CLOSE_WIDTHS * data.fit.blur.width_px
    spans = [_span(one.distance_px, one.level, one.seen, close_px) for one in data.fit.ground]
    return (
        _ground(spans, limits, sides), _close(spans, close_px, limits, sides),
        _mirrored(data.fit, spans, limits, steps),
    )  # fmt: skip


def rim(data: CheckData, limits: Limits) -> tuple[Check, ...]:
    """How probable a strip along the border is that moves the numbers; nothing without a model."""
    if not isinstance(data.fit, SplineEdge):
        return ()
    strip = find_rim(data, data.fit)
    if strip is None:
        found = "no strip along the border explains the profile better than a sensor alone"
        return (answer("rim", 0.0, found, limits),)
    kind = "brighter" if strip.height > 0 else "darker"
    found = (
        f"a strip {PLACES[strip.side]}, about {strip.width_px:g} px wide and "
        f"{100 * abs(strip.height):.1f} ± {100 * strip.height_std:.1f} % of the contrast {kind} "
        f"than it, may touch the border (probability {strip.probability:.2f}); behind it the "
        f"sensor has an RER of {strip.rer:.3f}"
    )
    return (answer("rim", strip.probability, found, limits),)


def _ground(spans: list[_Span], limits: Limits, sides: tuple[str, str]) -> Check:
    """How much the ground beside the target differs from its level at the target."""
    worst = 0 if spans[0][0] >= spans[1][0] else 1
    value, from_px, _ = spans[worst]
    found = "the ground beside the target is even"
    if value > 0:
        found = (
            f"{PLACES[sides[worst]]} the ground differs by {100 * value:.1f} % of the contrast "
            f"from {from_px:.1f} px on"
        )
    return answer("ground", value, found, limits)


@compiled
def _span(
    distance_px: Floats, level: Floats, seen: NDArray[np.bool_], close_px: float
) -> tuple[float, float, float]:
    """The largest significant level of a side, where such begin, px, and the largest close one."""
    largest, from_px, close = 0.0, np.inf, 0.0
    for k in range(level.size):
        if seen[k]:
            largest, from_px = max(largest, abs(level[k])), min(from_px, distance_px[k])
            if distance_px[k] <= close_px:
                close = max(close, abs(level[k]))
    return largest, from_px, close


def _close(spans: list[_Span], close_px: float, limits: Limits, sides: tuple[str, str]) -> Check:
    """How much the ground steps where the blur ends: a step closer still is taken for blur."""
    levels = [close for _, _, close in spans]
    worst = 0 if levels[0] >= levels[1] else 1
    found = (
        f"{PLACES[sides[worst]]} the ground steps by {100 * levels[worst]:.1f} % of the contrast "
        f"within {close_px:.1f} px of the target"
    )
    return answer("close_ground", levels[worst], found, limits)


def _mirrored(fit: SplineEdge, spans: list[_Span], limits: Limits, steps: int) -> Check:
    """Whether the ground on one side is the mirror image of that on the other.

    Ground is not; ringing of a sharpened product, which is as far out on both sides, is: opposite
    in sign beside an edge, of one sign beside a pulse. The likeness is the correlation of the steps
    on both sides, where the levels they add up to are large enough to matter.
    """
    before, behind = fit.ground
    count = min(before.step.size, behind.step.size)
    one, other = before.step[:count], (-1) ** steps * behind.step[:count]
    power = math.sqrt(float(one @ one) * float(other @ other))
    large = min(spans)[0] > _MIN_LEVEL
    value = max(float(one @ other) / power, 0.0) if large else 0.0
    found = f"what lies beside the target is to {100 * value:.0f} % mirrored on its other side"
    return answer("mirrored_ground", value, found, limits)
