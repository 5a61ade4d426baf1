"""How soft the objects of a scene may be: ideal, soft by some law, or none of this sensor's edges.

Softness is the standard deviation of the Gaussian through which an object's border looks blurred.
Blur of several causes adds in squares: a law of softness is that of the root of the sum of the
squares of one, two or four normal numbers, a chi distribution (of one: half-normal; of two:
Rayleigh). The more causes, the fewer objects are nearly ideal. Soft objects are a mixture of such
laws of many sizes: the edges decide. Few laws would be knowledge of the sensor that nobody has: a
blur that no law allows to the objects would pass for the sensor's.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from scipy.special import erf

from acutance.curves.grid import Floats

__all__ = [
    "FREE",
    "KINDS",
    "NEARLY_IDEAL_PX",
    "PARTS",
    "PSEUDO_COUNTS",
    "STRANGE",
    "below_steps",
    "law_chances",
]

NEARLY_IDEAL_PX: Final = 0.1
"""Softness up to which an object counts as ideal: it takes 5 % of the MTF at Nyquist."""
_CAUSES: Final = {1: "half-normal", 2: "Rayleigh", 4: "chi of four"}
_SIZES_PX: Final = (0.15, 0.21, 0.3, 0.42, 0.6, 0.85, 1.2, 1.7)
"""Root mean squares of the laws."""
_LEAST_SPREAD_PX: Final = 0.09
"""Least standard deviation of a law. Narrower ones are one softness that all objects have, which no
edge tells from the sensor's; they took for softness what a field leaves (benchmarks/scenes.py,
corners: errors of .012 at Nyquist instead of .001)."""

_STEP_PX, _MOST_PX = 0.005, 12.0
"""Steps of tables of the laws, and where all of them end."""


def _spread(causes: int, size_px: float) -> float:
    """Standard deviation of a law, px."""
    mean = math.sqrt(2 / causes) * math.gamma(0.5 * (causes + 1)) / math.gamma(0.5 * causes)
    return size_px * math.sqrt(1 - mean**2)


_LAWS: Final = tuple(law for law in product(_CAUSES, _SIZES_PX) if _spread(*law) > _LEAST_SPREAD_PX)
PARTS: Final = (
    "ideal",
    *(f"{_CAUSES[causes]} {size:g} px" for causes, size in _LAWS),
    "strange",
)
"""What an edge may be."""
FREE: Final[Floats] = np.linalg.svd(np.ones((1, len(PARTS))))[2][1:]
"""Directions in which shares may change: their sum is one."""
STRANGE: Final = 100.0
"""Variance of strange edges, in units of that of the pixels."""
PSEUDO_COUNTS: Final[Floats] = np.array([1.0, *(len(_LAWS) * [1.2 / len(_LAWS)]), 0.2])
"""Edges that each part has before any is seen: some objects are ideal."""


def law_chances(borders_px: Floats) -> Floats:
    """Probability of every law in cells between borders (..., t + 1), (laws, ..., t)."""
    return np.array([np.diff(_up_to(borders_px, *law)) for law in _LAWS])


@cache
def below_steps() -> tuple[Floats, float]:
    """Probability of less than 0, 1, 2, ... steps by every law, (m, laws), and the step in px.

    Linear between them, since the steps are far narrower than the laws.
    """
    borders = np.asarray(_STEP_PX * np.arange(round(_MOST_PX / _STEP_PX) + 1), float)
    return np.array([_up_to(borders, *law) for law in _LAWS]).T.copy(), _STEP_PX


def _up_to(softness_px: Floats, causes: int, size_px: float) -> Floats:
    """Probability of no more than a softness."""
    half_square = 0.5 * causes * (softness_px / size_px) ** 2
    if causes == 1:
        return np.asarray(erf(np.sqrt(half_square)))
    beyond = np.exp(-half_square) * (1.0 if causes == 2 else 1 + half_square)
    return np.asarray(1 - beyond)


_IDEAL: Final[Floats] = np.array([1.0, *law_chances(np.array([0.0, NEARLY_IDEAL_PX]))[:, 0], 0.0])
_STRANGE: Final[Floats] = np.eye(len(PARTS))[-1]
KINDS: Final[dict[str, Floats]] = {
    "ideal": _IDEAL,
    "soft": 1 - _IDEAL - _STRANGE,
    "strange": _STRANGE,
}
"""The parts in words, as weights of their shares: which law an object follows is hardly told."""
