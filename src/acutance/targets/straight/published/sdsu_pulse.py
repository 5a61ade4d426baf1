"""South Dakota State University's pulse method: the pulse's profile over the pulse's spectrum.

Sources: Helder, Choi, "Generic sensor modeling using pulse method" (2005), section 2.3, and
Helder, Choi, Rangaswamy, "Quickbird satellite in-orbit modulation transfer function (MTF)
measurement using edge, pulse and impulse methods for summer 2003" (2005), section 3.3.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_types
from acutance.curves import Esf, Estimate, Lsf, Mtf, Response
from acutance.curves.grid import Floats, crossing
from acutance.errors import NoEdgeError, OptionError, SupportError
from acutance.targets.straight.fit_pulse import PulsePixels
from acutance.targets.straight.pixels import EdgeFit
from acutance.targets.straight.published.edge_location import fermi_locations
from acutance.targets.straight.published.local_polynomial import modified_savitzky_golay
from acutance.targets.straight.published.resampled_response import (
    FREQ_CPP,
    GRID_PX,
    STEP_PX,
    covariance_factor,
    crossing_of_half,
    draw_rows,
    require_draws,
)
from acutance.targets.straight.published.row_profiles import (
    LocatedRows,
    RowLine,
    locate_rows,
    require_phases_for,
)

__all__ = ["PublishedPulse", "SdsuPulseOptions", "sdsu_2005_pulse"]

Complexes = NDArray[np.complex128]

_MIN_SINC = 1e-6
_MARGIN_PX = 1.5
_END_PX = 1.0
_EDGE_PX: Floats = np.arange(-130.0, 131.0) * STEP_PX


@dataclass(frozen=True)
class SdsuPulseOptions:
    """Choices of `sdsu_2005_pulse`.

    Parameters
    ----------
    order : {2, 4}
        Degree of the polynomial of the modified Savitzky-Golay interpolation. The report names
        both: "second order polynomial" and "4th order polynomial". Order 2 gives its
        under-estimate of 4.1 % at Nyquist, order 4 half of that.
    distance : {"row", "normal"}
        Axis of the profile. "row" is what the report does: rows are shifted until their edges
        coincide, so that M(f) becomes M(f / cos(angle)). "normal" removes that.
    width : {"stated", "axis"}
        Width in the spectrum the profile's is divided by: "stated" is the width along the
        normal as it stands, whatever the axis; "axis" divides it by cos(angle) where the axis
        runs along the rows, the report's "cosine correction".
    trim_px : float
        Length of the profile that is transformed; 10 px (200 sub-pixels) in the reports.
    replicates : int
        Draws of the rows for the standard deviations; 0 gives none.
    seed : int
        Of the generator that draws them.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    order: Literal[2, 4] = 2
    distance: Literal["row", "normal"] = "row"
    width: Literal["stated", "axis"] = "stated"
    trim_px: float = 10.0
    replicates: int = 60
    seed: int = 2005

    def __post_init__(self) -> None:
        require_types(self)
        require_draws(self.replicates, self.seed)
        if not 6.0 <= self.trim_px <= 40.0:
            raise OptionError(f"trim_px must be 6 to 40 px, found {self.trim_px}")


_DEFAULT = SdsuPulseOptions()


@dataclass(frozen=True, eq=False)
class PublishedPulse(EdgeFit):
    """A pulse measured by the ratio of two spectra.

    Attributes
    ----------
    pulse_width : Estimate
        The width along the normal that was stated; the method takes it and does not check it.
    height_ratio : Estimate
        Height of the falling side over that of the rising one, from the plateaus at both ends
        of the profile.
    prf_distance_px : (n,) array
        Distances of the pulse response function from the middle of its half-height points, on
        the axis of the profile.
    prf : (n,) array
        Pulse response function, plateaus 0; 1 is the height of the pulse, its area over
        `ratio_width_px`.
    prf_fwhm_px : Estimate
        Its width at half of its maximum, on the axis of the profile.
    ratio_width_px : float
        Width in the spectrum the profile's was divided by.
    px_per_normal : float
        Length on the axis of the profile per pixel along the normal: 1 / cos(angle) along rows.
    """

    pulse_width: Estimate
    height_ratio: Estimate
    prf_distance_px: Floats
    prf: Floats
    prf_fwhm_px: Estimate
    ratio_width_px: float
    px_per_normal: float


@dataclass(frozen=True, eq=False)
class _Profile:
    """A trimmed profile across the pulse, about its middle, minus the mean of its two plateaus.

    `middle_px` counts from the line, on the axis of the profile, as do all distances.
    """

    line: RowLine
    width_px: float
    px_per_normal: float
    middle_px: float
    distance_px: Floats
    value: Floats
    left: float
    right: float
    fwhm_px: float

    @property
    def height(self) -> float:
        return float(self.value.sum()) * STEP_PX / self.width_px

    @property
    def bright(self) -> float:
        return 0.5 * (self.left + self.right) + self.height

    @property
    def height_ratio(self) -> float:
        return (self.bright - self.right) / (self.bright - self.left)

    def otf(self) -> Complexes:
        """Transform of the profile over that of a pulse, 1 at 0, phase from the centroid."""
        total = self.value.sum()
        centroid = self.value @ self.distance_px / total
        # The frequencies are multiples of one, so each wave is the previous one turned again.
        turn = np.exp(-2j * np.pi * FREQ_CPP[1] * (self.distance_px - centroid))
        waves = np.cumprod(np.broadcast_to(turn, (FREQ_CPP.size - 1, turn.size)), axis=0)
        spectrum = np.concatenate(([1.0 + 0j], waves @ self.value / total))
        pulse = np.sinc(self.width_px * FREQ_CPP)
        pulse = np.where(np.abs(pulse) < _MIN_SINC, _MIN_SINC, pulse)
        return np.asarray(spectrum / pulse)

    def edge(self) -> tuple[Floats, Floats]:
        """The step the profile is a difference of: distances from the rising one, values.

        P(s) = E(s) - E(s - w), so E(s) is the sum of P at s, s - w, s - 2 w ..., and 1 minus that
        at s + w, s + 2 w ...: the first is short before the pulse, the second behind it. Over
        the pulse one passes into the other.
        """
        w = self.width_px
        value = self.value / self.height

        def summed(first: int, way: int) -> Floats:
            count = math.ceil(2 * _EDGE_PX[-1] / w) + 2
            place = _EDGE_PX - 0.5 * w + way * w * np.arange(first, first + count)[:, None]
            return np.asarray(np.interp(place, self.distance_px, value, 0.0, 0.0).sum(axis=0))

        share = np.clip(_EDGE_PX / w + 0.5, 0.0, 1.0)
        return _EDGE_PX, (1.0 - share) * summed(0, -1) + share * (1.0 - summed(1, 1))


@dataclass(frozen=True, eq=False)
class _Curves:
    """What one profile gives on the common grids; `middle_px` from the rising step's place."""

    esf: Floats
    lsf: Floats
    otf: Complexes
    middle_px: float
    fwhm_px: float
    height_ratio: float


def _curves(profile: _Profile) -> _Curves:
    from scipy.interpolate import CubicSpline

    places, edge = profile.edge()
    middle = crossing_of_half(places, edge)
    if not abs(middle) < _MARGIN_PX:
        raise NoEdgeError(
            f"a pulse {profile.width_px:.3g} px wide does not fit the profile: check the width"
        )
    spline = CubicSpline(places, edge)
    x = GRID_PX + middle
    return _Curves(
        spline(x), spline(x, 1), profile.otf(), middle, profile.fwhm_px, profile.height_ratio
    )


def sdsu_2005_pulse(trimmed: PulsePixels, options: SdsuPulseOptions = _DEFAULT) -> PublishedPulse:
    """Measure a pulse the way of South Dakota State University.

    Fermi function through the 7 pixels nearest the largest difference of each row's rising
    edge, straight line through the centres, all rows on one axis, local polynomial of a 1 px
    window every 0.05 px, trim to 10 px, Fourier transform over that of a pulse of the stated
    width.

    The report places the left edges of its pulse, which were aligned by a transit. Here it is the
    edge at which the given line lies, turned so that it rises: for a pulse with parallel borders
    and one level both give the same. Its sum of Fermi functions for products with MTF compensation
    (see `SdsuOptions`) takes more pixels than a pulse of 3 px has and is left to edges.

    The ratio is kept as it is: near the zeros of the pulse's spectrum, the multiples of
    1 / ratio_width_px, it has no meaning. The mean of the plateaus at both ends is subtracted
    from the profile first.

    Parameters
    ----------
    trimmed : PulsePixels
        Its `pulse_width_px` is the stated width.
    options : SdsuPulseOptions, optional

    Returns
    -------
    PublishedPulse
        Distances and frequencies run along the ROWS unless ``options.distance == "normal"``.
        The reports give MTF and PRF. Edge spread function (ESF) and line spread function (LSF), and
        so relative edge response (RER) and full width at half maximum (FWHM), are an addition: the
        profile is the difference of two steps a width apart, and is summed up to one of them. The
        covariance comes from draws of the rows: scatter, not bias.

    Raises
    ------
    SupportError
        If there are too few rows or the plateaus are too short.
    NoEdgeError, PhaseError
        See `locate_rows`; also if the profile is no pulse, and if the samples have too few
        phases for a polynomial of that order.
    """
    rows = locate_rows(trimmed, fermi_locations)
    require_phases_for(options.order, rows)
    profile = _profile(rows, np.ones(rows.row.size), trimmed.pulse_width_px, options)
    curves = _curves(profile)
    drawn = draw_rows(
        rows,
        lambda weight: _curves(_profile(rows, weight, trimmed.pulse_width_px, options)),
        replicates=options.replicates,
        rng=np.random.default_rng(options.seed),
    )
    response = Response(
        Esf(GRID_PX, curves.esf, _factor([each.esf for each in drawn], GRID_PX.size)),
        Lsf(GRID_PX, curves.lsf, _factor([each.lsf for each in drawn], GRID_PX.size)),
        Mtf(FREQ_CPP, curves.otf, _factor([each.otf for each in drawn], FREQ_CPP.size)),
    )
    rising_px = profile.middle_px - 0.5 * profile.width_px + curves.middle_px
    line = rows.frame.line_in_region(profile.line).moved(rising_px / profile.px_per_normal, 0.0)
    pixels = trimmed.pixels
    distance = line.normal_distance(pixels.row, pixels.col)
    height = profile.height
    value = (pixels.value - profile.left) / (profile.bright - profile.left)
    place = distance * profile.px_per_normal + rising_px - profile.middle_px
    # Beyond the trimmed profile lie the two plateaus, which may differ.
    step = profile.right - profile.left
    model = np.interp(place, profile.distance_px, profile.value, -0.5 * step, 0.5 * step)
    model += 0.5 * step
    return PublishedPulse(
        line=line,
        response=response,
        dark=profile.left,
        bright=profile.bright,
        distance_px=distance,
        value=value,
        residual=value - model / (profile.bright - profile.left),
        pulse_width=Estimate(trimmed.pulse_width_px),
        height_ratio=Estimate(
            profile.height_ratio, _scatter([each.height_ratio for each in drawn])
        ),
        prf_distance_px=profile.distance_px,
        prf=profile.value / height,
        prf_fwhm_px=Estimate(profile.fwhm_px, _scatter([each.fwhm_px for each in drawn])),
        ratio_width_px=profile.width_px,
        px_per_normal=profile.px_per_normal,
    )


def _factor(drawn: list[NDArray[Any]], size: int) -> NDArray[Any]:
    return covariance_factor(np.stack(drawn, axis=1)) if drawn else np.zeros((size, 0))


def _scatter(drawn: list[float]) -> float:
    return float(np.std(drawn, ddof=1)) if len(drawn) > 1 else 0.0


def _profile(
    rows: LocatedRows, weight: Floats, stated_px: float, options: SdsuPulseOptions
) -> _Profile:
    """Line, interpolated profile and its trimmed part."""
    line = rows.line(weight)
    per_row_px = line.cosine if options.distance == "normal" else 1.0
    px_per_normal = per_row_px / line.cosine
    width_px = stated_px * (px_per_normal if options.width == "axis" else 1.0)
    distance = rows.row_distance(line) * per_row_px
    half = round((0.5 * options.trim_px + _MARGIN_PX) / STEP_PX)
    grid = np.arange(-half, half + 1, dtype=float) * STEP_PX + 0.5 * width_px
    _require_reach(rows, line, per_row_px, grid)
    used = np.isfinite(rows.value) & (weight[:, None] > 0)
    share = np.broadcast_to(weight[:, None], used.shape)[used]
    value = modified_savitzky_golay(distance[used], rows.value[used], share, grid, options.order)
    left_px, right_px = _half_points(grid, value)
    middle = 0.5 * (left_px + right_px)
    count = round(options.trim_px / STEP_PX)
    first = round((middle - grid[0]) / STEP_PX - 0.5 * (count - 1))
    if not 0 <= first <= grid.size - count:
        raise NoEdgeError(
            f"the pulse's middle lies {middle:.1f} px behind its rising edge, where a width of "
            f"{stated_px:.3g} px is stated: check the width"
        )
    kept = value[first : first + count]
    end = round(_END_PX / STEP_PX)
    left, right = float(kept[:end].mean()), float(kept[-end:].mean())
    kept = kept - 0.5 * (left + right)
    if not kept.sum() > 0:
        raise NoEdgeError("the profile is no pulse above its plateaus: choose another region")
    return _Profile(
        line, width_px, px_per_normal, middle, grid[first : first + count] - middle,
        kept, left, right, right_px - left_px,
    )  # fmt: skip


def _half_points(grid: Floats, value: Floats) -> tuple[float, float]:
    """Where the profile passes half of its height above the plateaus at its ends."""
    end = round(_END_PX / STEP_PX)
    plateau = 0.5 * float(value[:end].mean() + value[-end:].mean())
    top = int(np.argmax(value))
    level = 0.5 * (plateau + float(value[top]))
    left, right = (crossing(grid, value, level, float(grid[top]), way) for way in (-1, 1))
    if math.isnan(left) or math.isnan(right):
        raise NoEdgeError(
            "the profile does not fall to half of its height on both sides: choose a region "
            "with a plateau on both sides of the pulse"
        )
    return left, right


def _require_reach(rows: LocatedRows, line: RowLine, per_row_px: float, grid: Floats) -> None:
    """Refuse pixels whose rows do not hold the profile."""
    low, high = (reach * per_row_px for reach in rows.reach_px(line))
    if low < -grid[0] or high < grid[-1]:
        raise SupportError(
            f"the profile needs {-grid[0]:.1f} px before and {grid[-1]:.1f} px behind the rising "
            f"edge, found {low:.1f} and {high:.1f}: use a wider region, or "
            "in Python method_options with a smaller trim_px"
        )
