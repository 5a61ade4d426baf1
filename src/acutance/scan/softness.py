"""How soft the objects of a scene may be: ideal, soft by some law, or none of this sensor's edges.

Softness is the standard deviation of the Gaussian through which an object's border looks blurred.
Soft objects are a mixture of laws of several sizes, some of which have many nearly ideal objects
(half-normal) and some none (Rayleigh): the edges decide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["FREE", "KINDS", "PARTS", "PSEUDO_COUNTS", "START", "STRANGE", "law_densities"]

_HALF_NORMAL_PX: Final = (0.4, 0.8, 1.6)
"""Narrower ones would be a sensor a little sharper under objects that are all a little soft: no
edges tell the two apart."""
_RAYLEIGH_PX: Final = (0.3, 0.6, 1.2)
_LAWS: Final = len(_HALF_NORMAL_PX) + len(_RAYLEIGH_PX)
PARTS: Final = (
    "ideal",
    *(f"half-normal {scale:g} px" for scale in _HALF_NORMAL_PX),
    *(f"Rayleigh {scale:g} px" for scale in _RAYLEIGH_PX),
    "strange",
)
"""What an edge may be."""
KINDS: Final[dict[str, slice]] = {
    "ideal": slice(0, 1), "soft": slice(1, -1), "strange": slice(-1, None)
}  # fmt: skip
"""The parts in words: which law a soft object follows is hardly told by its edges."""
FREE: Final[Floats] = np.linalg.svd(np.ones((1, len(PARTS))))[2][1:]
"""Directions in which shares may change: their sum is one."""
STRANGE: Final = 100.0
"""Variance of strange edges, in units of that of the pixels."""
PSEUDO_COUNTS: Final[Floats] = np.array([1.0, *(_LAWS * [0.2]), 0.2])
"""Edges that each part has before any is seen: some objects are ideal."""
START: Final[Floats] = np.array([0.6, *(_LAWS * [0.3 / _LAWS]), 0.1])
"""Shares of the parts before any edge is seen."""


def law_densities(softness_px: Floats) -> Floats:
    """Probability density of softness (...) by every law, per pixel, (6, ...)."""
    return np.array(
        [
            math.sqrt(2 / math.pi) / scale * np.exp(-0.5 * (softness_px / scale) ** 2)
            for scale in _HALF_NORMAL_PX
        ]
        + [
            softness_px / scale**2 * np.exp(-0.5 * (softness_px / scale) ** 2)
            for scale in _RAYLEIGH_PX
        ]
    )
