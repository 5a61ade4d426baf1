"""The noise of pixels around point sources, from the residuals of a fit.

A source's flux and place take up much of the noise of its few bright pixels: what is left there
is held against the share that the fit leaves (one less the leverage).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.noise import Correlation, correlation, outlier_weights
from acutance.targets.points import tuned
from acutance.targets.points.stamps import Stamps

__all__ = ["PointNoise", "noise_around", "noise_grows"]

_WHITE: Final = Correlation(1.0, 0.0, 0.0)
_MIN_PIXELS: Final = 20


@dataclass(frozen=True, eq=False)
class PointNoise:
    """Noise around point sources.

    Parameters
    ----------
    outlier : (n,) array
        1 where a pixel is no outlier.
    growth : float
        Variance per unit of light over that of the background.
    correlation : Correlation
        Between neighbouring pixels.
    """

    outlier: Floats
    growth: float
    correlation: Correlation

    @classmethod
    def white(cls, size: int) -> PointNoise:
        """The same everywhere."""
        return cls(np.ones(size), 0.0, _WHITE)

    def weight(self, light: Floats) -> Floats:
        """Inverse variance of every pixel, 1 on the background."""
        return np.asarray(self.outlier / (1 + self.growth * np.maximum(light, 0.0)))

    def agrees(self, other: PointNoise) -> bool:
        """Whether a fit with the other noise would find about the same."""
        even = math.isclose(self.correlation.inflation, other.correlation.inflation, rel_tol=0.1)
        outliers = float(np.abs(self.outlier - other.outlier).mean())
        return self.grows_as(other) and even and outliers < 0.004

    def grows_as(self, other: PointNoise) -> bool:
        """Whether the other noise grows about as much with the light."""
        return math.isclose(self.growth, other.growth, rel_tol=0.2, abs_tol=1e-12)


def noise_around(
    stamps: Stamps, residual: Floats, light: Floats, growth: float, *, robust: bool
) -> PointNoise:
    """Outliers and correlation of the noise, from the residuals.

    Parameters
    ----------
    stamps : Stamps
    residual, light : (n,) arrays
        What the fit leaves of every pixel, and what the pixel's source gives it.
    growth : float
        Variance per unit of light over that of the background.
    robust : bool
        Bound the weight of outlying pixels.
    """
    floor = tuned.NOISE_FLOOR * float(light.max())
    per_dark = np.sqrt(1 + growth * np.maximum(light, 0.0))
    standard = residual / per_dark
    scale = math.hypot(stamps.noise_of(standard), floor)
    standard = standard / np.hypot(scale, tuned.MODEL_ERROR * light / per_dark)
    outlier = outlier_weights(standard) if robust else np.ones(standard.size)
    if float(np.sqrt(np.mean(residual**2))) < 3 * floor:
        return PointNoise(outlier, growth, _WHITE)
    bounded = np.clip(standard, -3, 3)
    rows, cols = stamps.row.astype(np.intp), stamps.col.astype(np.intp)
    rows, cols = rows - rows.min(), cols - cols.min()
    return PointNoise(outlier, growth, correlation(bounded, rows, cols))


def noise_grows(
    stamps: Stamps, residual: Floats, light: Floats, leverage: Floats, least: float
) -> bool:
    """Whether bright pixels scatter significantly more than the background.

    Parameters
    ----------
    stamps : Stamps
    residual, light : (n,) arrays
        What a fit with equal weights leaves of every pixel, and what the sources give it.
    leverage : (n,) array
        How much of a pixel's own noise the fit took up, 0 to 1.
    least : float
        The smallest noise, that of rounding and of the model.
    """
    bright = light > tuned.BRIGHT_SHARE * float(light.max())
    dark, bright = ~bright, bright & (leverage < tuned.MAX_LEVERAGE)
    if bright.sum() < _MIN_PIXELS or dark.sum() < _MIN_PIXELS:
        return False
    base = math.hypot(stamps.noise_of(residual[dark]), least)
    free = 1 - leverage[bright]
    power = np.maximum(residual[bright] ** 2 - (tuned.SHAPE_ERROR * light[bright]) ** 2, 0.0)
    excess = float(power.sum()) / base**2 - float(free.sum())
    return excess > tuned.SIGNIFICANT_GROWTH * math.sqrt(2 * float(free @ free))
