"""Bands of a trend on a grid of dates: what a figure draws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.special import ndtr, ndtri

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["TrendBands", "mixture_quantiles"]

_MOST_STEPS: Final = 60
_CLOSE: Final = 1e-10
_REACH: Final = 12.0
_FAR: Final = 38.0
"""Standard deviations beyond which a normal density is zero."""


@dataclass(frozen=True, eq=False)
class TrendBands(ShortRepr):
    """A trend on n dates.

    Attributes
    ----------
    when : (n,) array
        Years with decimals.
    mean : (n,) array
        Median of the posterior of the sensor's mean.
    band50, band95 : pair of (n,) array
        Lower and upper ends of its intervals.
    images95 : pair of (n,) array
        Between which 95 % of single images lie.
    """

    when: Floats
    mean: Floats
    band50: tuple[Floats, Floats]
    band95: tuple[Floats, Floats]
    images95: tuple[Floats, Floats]

    def to_dict(self) -> dict[str, Any]:
        """All columns as lists."""
        return {
            "when": self.when.tolist(),
            "mean": self.mean.tolist(),
            **{name: [end.tolist() for end in getattr(self, name)]
               for name in ("band50", "band95", "images95")},
        }  # fmt: skip


def mixture_quantiles(share: Floats, mean: Floats, std: Floats, level: float) -> Floats:
    """Quantiles of n mixtures of q normal densities, (n,).

    Parameters
    ----------
    share : (q,) array
    mean, std : (q, n) array
    level : float
    """
    low, high = (mean - _REACH * std).min(axis=0), (mean + _REACH * std).max(axis=0)
    std = np.maximum(std, 1e-300)
    close = _CLOSE * (high - low)
    centre = share @ mean
    spread = np.sqrt(share @ ((mean - centre) ** 2 + std**2))
    place = np.clip(centre + ndtri(level) * spread, low, high)
    # Newton's steps, and a halving where one would leave what is known to hold the quantile.
    for _ in range(_MOST_STEPS):
        off = np.clip((place - mean) / std, -_FAR, _FAR)
        excess = share @ ndtr(off) - level
        low, high = np.where(excess < 0, place, low), np.where(excess < 0, high, place)
        density = share @ (np.exp(-0.5 * off**2) / std) / math.sqrt(2 * math.pi)
        step = place - excess / np.maximum(density, 1e-300)
        new = np.where((low <= step) & (step <= high), step, 0.5 * (low + high))
        is_close = np.abs(new - place) <= close
        place = new
        if is_close.all():
            break
    return np.asarray(place)
