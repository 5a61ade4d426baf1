"""Bands of a trend on a grid of dates: what a figure draws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["TrendBands", "mixture_quantiles"]

_HALVINGS: Final = 40
_REACH: Final = 12.0


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
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_low = share @ ndtr((middle - mean) / np.maximum(std, 1e-300)) < level
        low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
    return np.asarray(0.5 * (low + high))
