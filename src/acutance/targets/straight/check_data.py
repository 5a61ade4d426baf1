"""The data of the checks of a straight target: its pixels, with their places, after the fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.noise import (
    Correlation,
    correlation,
    median,
    outlier_weights,
    robust_scale,
    side_variances,
)
from acutance.targets.check import MAX_RATIO
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.tuned import NOISE_FLOOR

__all__ = ["MISFIT", "PLACES", "CheckData", "ratio_in_words"]

PLACES = {
    "dark": "on the dark side",
    "bright": "on the bright side",
    "before": "before the pulse",
    "behind": "behind the pulse",
}
"""Where a target's two plateaus lie."""

MISFIT = 3e-4
"""Residuals below this share of the contrast are the model's own, not noise."""

_FAR_WIDTHS, _NEAR_WIDTHS = 2.0, 1.5
_OUTLYING = 4.0
_MEDIAN_SQUARE = 0.455
"""Median of the square of a standard normal variable."""


@dataclass(frozen=True, eq=False)
class CheckData:
    """The pixels of a fit with their places, as the checks read them.

    Distances in pixels, values and residuals as shares of the contrast. `before` and `behind` are
    the distances outwards from the target's first and last step: of an edge, its dark and its
    bright side.
    """

    trimmed: EdgePixels
    fit: EdgeFit
    before: Floats
    behind: Floats

    @classmethod
    def of(cls, trimmed: EdgePixels, fit: EdgeFit, last_px: float = 0.0) -> CheckData:
        """Check data of a fit whose last step lies `last_px` behind its first."""
        return cls(trimmed, fit, -fit.distance_px, fit.distance_px - last_px)

    @property
    def rows(self) -> Floats:
        """Rows of the pixels."""
        return self.trimmed.pixels.row

    @property
    def cols(self) -> Floats:
        """Columns of the pixels."""
        return self.trimmed.pixels.col

    @cached_property
    def t(self) -> Floats:
        """Distance of the pixels along the target."""
        return self.fit.line.tangent_distance(self.rows, self.cols)

    @property
    def value(self) -> Floats:
        """The pixels, 0 on the dark and 1 on the bright plateau."""
        return self.fit.value

    @property
    def residual(self) -> Floats:
        """Residual of the pixels, as a share of the contrast."""
        return self.fit.residual

    @property
    def fwhm_px(self) -> float:
        """Full width at half maximum (FWHM) of the line spread function (LSF); 1 if undefined."""
        fwhm = self.fit.response.fwhm_px.value
        return fwhm if math.isfinite(fwhm) else 1.0

    @cached_property
    def outside(self) -> Floats:
        """Distance from the target's nearest step outwards (negative within a pulse)."""
        return np.maximum(self.before, self.behind)

    @cached_property
    def far_px(self) -> float:
        """From here on a plateau is flat for every usual blur."""
        return max(_FAR_WIDTHS * self.fwhm_px, 2.0)

    @cached_property
    def plateaus(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which pixels lie on the plateau before the target, and on that behind it."""
        return self.before > self.far_px, self.behind > self.far_px

    @cached_property
    def fitted(self) -> Floats:
        """The fitted image, (n,)."""
        return self.value - self.residual

    @cached_property
    def variances(self) -> tuple[float, float]:
        """Variance of the noise on the dark and on the bright side, outliers aside."""
        return side_variances(self.residual, self.fitted)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the noise, outliers aside: the fit's own estimate of it.

        The root of the mean of the variances on the two sides.
        """
        dark, bright = self.variances
        return math.sqrt(0.5 * (dark + bright))

    @cached_property
    def weights(self) -> Floats:
        """Inverse variance of the pixels, (n,), for noise that correlates along the normal.

        Outliers count for less, and all pixels where those near the target leave the fit by more
        than their noise, as on a rough border.
        """
        dark, bright = self.variances
        share = np.minimum(np.maximum(self.fitted, 0.0), 1.0)
        variance = (dark + NOISE_FLOOR**2) + (bright - dark) * share
        square = self.residual * self.residual / variance
        near = square[self.outside < _NEAR_WIDTHS * self.fwhm_px]
        excess = max(median(near) / _MEDIAN_SQUARE, 1.0) if near.size else 1.0
        excess *= self.inflation
        return outlier_weights(np.sqrt(square / excess)) / (variance * excess)

    @property
    def inflation(self) -> float:
        """Power of the noise along the normal over that of white noise."""
        return self.across.inflation

    @cached_property
    def across(self) -> Correlation:
        """Correlation of the plateaus' noise, and its power along the normal."""
        return self._correlation(self.fit.line.normal)

    @cached_property
    def smoothness(self) -> float:
        """Variance of a fit to many pixels under this noise over that under white noise.

        The largest ratio of the plateaus' noise power to that of white noise of the same variance,
        along the normal times along the target.
        """
        if not self.across.significant:
            return 1.0
        x, y = self.fit.line.normal
        return self.inflation * self._correlation((-y, x)).inflation

    def _correlation(self, direction: tuple[float, float]) -> Correlation:
        """Correlation of the plateaus' noise, and its power along a direction (x, y).

        On the plateaus alone, each about its own level: across the edge a method's own misfit
        looks like correlation, and so does a level that a published method takes from few pixels.
        """
        flat = self.outside > self.far_px
        residual = self.residual[flat]
        behind = self.behind[flat] > 0
        for side in (behind, ~behind):
            if side.any():
                residual[side] -= np.mean(residual[side])
        noise = robust_scale(residual) if residual.size else 0.0
        if noise <= MISFIT:
            return Correlation(1.0, 0.0, 0.0)
        rows, cols = (at[flat] for at in self.trimmed.pixels.at)
        bounded = np.clip(residual / noise, -_OUTLYING, _OUTLYING)
        return correlation(bounded, rows, cols, [direction])

    @cached_property
    def plateau_std(self) -> float:
        """Mean standard deviation of the two plateaus."""
        sides = (self.value[side > self.far_px] for side in (self.before, self.behind))
        stds = [_std(side) for side in sides if side.size > 1]
        return sum(stds) / len(stds) if stds else 0.0

    @cached_property
    def slope(self) -> Floats:
        """How much every pixel changes when the first step moves by one pixel against s."""
        lsf = self.fit.response.lsf
        return np.interp(-self.before, lsf.distance_px, lsf.value, left=0.0, right=0.0)


def _std(values: Floats) -> float:
    """Standard deviation, faster than `numpy.std`."""
    centred = values - float(np.add.reduce(values)) / values.size
    return math.sqrt(float(centred @ centred) / values.size)


def ratio_in_words(ratio: float) -> str:
    """A ratio in words: beyond `MAX_RATIO` only that it is larger."""
    return f"more than {MAX_RATIO:.0f}" if ratio >= MAX_RATIO else f"{ratio:.0f}"
