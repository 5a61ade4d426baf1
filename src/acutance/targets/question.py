"""One question that is asked of a target: its limit, and what a failure means."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

__all__ = ["PLACES", "Question", "Sense", "Severity", "limit_range"]

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


_SHARES = frozenset((
    "saturation", "outliers", "full_scale", "rim", "left_out", "coherence", "agreement",
    "worst_member", "plain_sensor", "trusted_share", "ideal_share", "strange_share",
    "repeated_pixels", "positions", "phase_gap_px", "halo_share", "blur_uniformity", "double_edge",
    "scene_settled",
))  # fmt: skip
"""Questions whose answers are shares (of a pixel, too) or probabilities, or 0 and 1."""
_CORRELATIONS = frozenset((
    "correlated_noise", "correlation", "residual_correlation", "mirrored_ground"
))  # fmt: skip


def limit_range(name: str) -> tuple[float, float]:
    """The least and the greatest limit of a question that means something.

    Beyond it every answer would keep the limit, or none would.

    Parameters
    ----------
    name : str
    """
    if name in _CORRELATIONS:
        return -1.0, 1.0
    if name in _SHARES:
        return 0.0, 1.0
    return 0.0, 360.0 if name.endswith("_deg") else math.inf
