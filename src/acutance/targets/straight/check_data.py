"""The data of the checks of a straight target: its pixels, with their places, after the fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.numerics.noise import (
    Correlation,
    correlation,
    median,
    outlier_weights,
    robust_scale,
    rounding_std,
    side_variances,
)
from acutance.targets.check import MAX_RATIO
from acutance.targets.straight.check_loops import (
    blocks_of,
    border_offsets,
    largest_odd_part,
    mean_std,
    parts_along,
    pixels_far,
    slope_and_bend,
    standard_squares,
)
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.tuned import MISFIT, NOISE_FLOOR, STRUCTURE_OUTLIER_SIGMAS

__all__ = ["STEEP_SHARE", "Border", "CheckData", "ratio_in_words", "regular"]

STEEP_SHARE: Final = 0.3
"""Pixels steeper than this share of the steepest lie on the border."""

_FAR_WIDTHS, _NEAR_WIDTHS = 2.0, 1.5
_OUTLYING = 4.0
_REACH_WIDTHS: Final = 4.0
_WHITE = 0.1
"""Correlation of neighbours' noise below which no product was interpolated at one phase: of 118
products with an uneven LSF, their noise interpolated with them, nine in ten have more."""
_MIN_ROUNDINGS = 2.0
"""Noise over that of rounding from which on it is told whether it is white: three quarters of its
power are then no rounding."""
_COARSE: Final = 10
_PART_PX, _MIN_PARTS, _MAX_PARTS = 5.0, 3, 12
_MIDDLES_PX: Final[Floats] = np.linspace(-0.3, 0.3, 31)
_APART_WIDTHS: Final[Floats] = np.linspace(0.0, 2.0, 21)
_MEDIAN_SQUARE = 0.455
"""Median of the square of a standard normal variable."""


class CoarseEsf(NamedTuple):
    """Some places of an edge spread function (ESF), half a pixel apart.

    Attributes
    ----------
    distance_px, value, std : (n,) arrays
    factor : (n, k) array
        Of their covariance.
    """

    distance_px: Floats
    value: Floats
    std: Floats
    factor: Floats

    def nearest(self, place: int) -> int:
        """The number of the place nearest to one of the whole curve."""
        return min(round(place / _COARSE), self.value.size - 1)


class Border(NamedTuple):
    """What is left of the pixels where the image is steep.

    Attributes
    ----------
    pixels : int
        How many they are.
    power, noise : float
        Their mean square residual, and that of the noisier plateau.
    steepness : float
        Their mean square slope.
    """

    pixels: int
    power: float
    noise: float
    steepness: float


@dataclass(frozen=True, eq=False)
class CheckData:
    """The pixels of a fit with their places, as the checks read them.

    Distances in pixels, values and residuals as shares of the contrast. `before` and `behind` are
    the distances outwards from the target's first and last step: of an edge, its dark and its
    bright side. `behind_border` are the curves behind a border of stated softness, if there is one.
    """

    trimmed: EdgePixels
    fit: EdgeFit
    before: Floats
    behind: Floats
    behind_border: Response | None = None

    @classmethod
    def of(
        cls,
        trimmed: EdgePixels,
        fit: EdgeFit,
        last_px: float = 0.0,
        behind_border: Response | None = None,
    ) -> CheckData:
        """Check data of a fit whose last step lies `last_px` behind its first."""
        return cls(trimmed, fit, -fit.distance_px, fit.distance_px - last_px, behind_border)

    @property
    def sensor(self) -> Response:
        """The curves of the sensor: those of the image, a stated border divided out."""
        return self.fit.response if self.behind_border is None else self.behind_border

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

    @cached_property
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
        dark, bright = (variance + NOISE_FLOOR**2 for variance in self.variances)
        square, variance = standard_squares(self.residual, self.fitted, dark, bright)
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
    def is_noise_white(self) -> bool:
        """Whether the noise of neighbouring pixels is known to be independent.

        Noise below the model's own misfit, and noise that is mostly rounding, tell nothing: numbers
        are rounded after whatever mixed their pixels.
        """
        rounding = rounding_std(self.trimmed.pixels.value) / (self.fit.bright - self.fit.dark)
        if self.noise <= max(MISFIT, _MIN_ROUNDINGS * rounding):
            return False
        return abs(self.across.strongest) < _WHITE

    @cached_property
    def smoothness(self) -> float:
        """Variance of a fit to many pixels under this noise over that under white noise.

        The largest ratio of the plateaus' noise power to that of white noise of the same variance,
        along the normal and along the target.
        """
        if not self.across.significant:
            return 1.0
        x, y = self.fit.line.normal
        return self._correlation((x, y), (-y, x)).inflation

    def _correlation(self, *directions: tuple[float, float]) -> Correlation:
        """Correlation of the plateaus' noise, and its largest power along directions (x, y).

        On the plateaus alone, each about its own level: across the edge a method's own misfit
        looks like correlation, and so does a level that a published method takes from few pixels.
        """
        residual, rows, cols = pixels_far(
            self.residual, *self.trimmed.pixels.at, self.before, self.behind, self.far_px
        )
        noise = robust_scale(residual) if residual.size else 0.0
        if noise <= MISFIT:
            return Correlation(1.0, 0.0, 0.0)
        bounded = np.minimum(np.maximum(residual / noise, -_OUTLYING), _OUTLYING)
        return correlation(bounded, rows, cols, directions)

    @cached_property
    def plateau_std(self) -> float:
        """Mean standard deviation of the two plateaus."""
        return mean_std(self.value, self.before, self.behind, self.far_px)

    @cached_property
    def near(self) -> NDArray[np.intp]:
        """Which pixels lie within the reach of the blur from the first step."""
        return (np.abs(self.before) < _REACH_WIDTHS * self.fwhm_px).nonzero()[0]

    @property
    def slope(self) -> Floats:
        """How much every near pixel changes when the first step moves by one pixel against s."""
        return self._lsf_at_near_pixels[0]

    @property
    def bend(self) -> Floats:
        """The derivative of the LSF at every near pixel, 1/px^2."""
        return self._lsf_at_near_pixels[1]

    @cached_property
    def _lsf_at_near_pixels(self) -> tuple[Floats, Floats]:
        grid, value = self.fit.response.lsf.distance_px, self.fit.response.lsf.value
        return slope_and_bend(value, *regular(grid), self.before, self.near)

    @cached_property
    def border(self) -> Border:
        """What is left of the pixels of the first step's border."""
        return Border(
            *border_offsets(
                self.residual, self.slope, self.near, self.before, self.behind, self.far_px,
                STEEP_SHARE,
            )
        )  # fmt: skip

    @cached_property
    def coarse_esf(self) -> CoarseEsf:
        """Every tenth place of the ESF."""
        esf, some = self.fit.response.esf.thinned, slice(None, None, _COARSE // 2)
        return CoarseEsf(
            esf.distance_px[some], esf.value[some], esf.std[some], esf.covariance_factor[some]
        )

    @cached_property
    def blocks(self) -> NDArray[np.intp]:
        """The block of 4 x 4 pixels in which every pixel lies, (n,)."""
        return blocks_of(*self.trimmed.pixels.at)

    @cached_property
    def bounded(self) -> Floats:
        """The residuals, outliers bounded, (n,)."""
        return self._bounded(self.residual)

    @cached_property
    def unexplained(self) -> Floats:
        """The same without what noise that correlates is taken to add to the profile, (n,)."""
        explained = self.fit.random_profile if isinstance(self.fit, SplineEdge) else 0.0
        return self._bounded(self.residual - explained)

    def _bounded(self, residual: Floats) -> Floats:
        most = STRUCTURE_OUTLIER_SIGMAS * self.noise
        return np.minimum(np.maximum(residual, -most), most)

    @cached_property
    def along(self) -> tuple[NDArray[np.intp], int]:
        """The part of the target's length in which every near pixel lies, and how many there are.

        As many parts as there are 5 px of pixels next to the first step, 3 to 12, over the whole
        length.
        """
        return parts_along(self.t, self.before, self.near, _PART_PX, _MIN_PARTS, _MAX_PARTS)

    @cached_property
    def asymmetry(self) -> float:
        """Largest odd part of the ESF about the middle where it is smallest, within two widths."""
        esf = self.fit.response.esf
        return largest_odd_part(
            esf.value, *regular(esf.distance_px), _MIDDLES_PX, _APART_WIDTHS * self.fwhm_px
        )


def regular(grid: Floats) -> tuple[float, float]:
    """The first place of a regular grid, and its step."""
    first = grid.item(0)
    return first, grid.item(1) - first


def ratio_in_words(ratio: float) -> str:
    """A ratio in words: beyond `MAX_RATIO` only that it is larger."""
    return f"more than {MAX_RATIO:.0f}" if ratio >= MAX_RATIO else f"{ratio:.3g}"
