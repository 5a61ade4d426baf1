"""The heavy half of a measurement of bars or of a star: the pixels and their residuals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.noise import robust_scale

__all__ = ["PeriodicDetails"]


@dataclass(frozen=True, eq=False)
class PeriodicDetails(ShortRepr):
    """The heavy half of a measurement of bars or of a star.

    Attributes
    ----------
    pixels : (rows, cols) array
        The region; NaN where there is nothing to use.
    residual : (rows, cols) array
        Residuals of the pixels used (NaN elsewhere), image units.
    """

    pixels: Floats
    residual: Floats

    @property
    def noise(self) -> float:
        """Standard deviation of the residuals, outliers aside, image units."""
        return robust_scale(self.residual[np.isfinite(self.residual)])
