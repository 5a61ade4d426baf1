"""South Dakota State University's edge method: Fermi location and modified Savitzky-Golay.

Sources: Helder, Choi, "Generic sensor modeling using pulse method" (2005), section 2.3, and
Helder, Choi, Rangaswamy, "Quickbird satellite in-orbit modulation transfer function (MTF)
measurement using edge, pulse and impulse methods for summer 2003" (2005), section 3.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError, OptionError, SupportError
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published.edge_location import fermi_locations, fermi_sum_locations
from acutance.targets.straight.published.local_polynomial import modified_savitzky_golay
from acutance.targets.straight.published.resampled_response import (
    STEP_PX,
    SampledEdge,
    crossing_of_half,
    fit_with_bootstrap,
    normalised,
    require_draws,
)
from acutance.targets.straight.published.row_profiles import (
    Locate,
    LocatedRows,
    RowLine,
    locate_rows,
    require_phases_for,
)

__all__ = ["SdsuOptions", "sdsu_2005"]

_SMOOTHING_ORDER = 4


@dataclass(frozen=True)
class SdsuOptions:
    """Choices of `sdsu_2005`.

    Parameters
    ----------
    order : {4, 2}
        Degree of the polynomial of the modified Savitzky-Golay interpolation. The reports
        name both: "a quadratic function" and "the 4th order polynomial".
    distance : {"row", "normal"}
        Axis of the profile. "row" is what the reports do: rows are shifted until their edges
        coincide. It raises the frequency axis by 1 / cos(angle): M(f) becomes
        M(f / cos(angle)). "normal" removes that.
    location : {"fermi", "fermi-sum"}
        What places the edge in each row: one Fermi function through 7 pixels, or the sum that the
        report of 2005 uses for products with MTF compensation, whose edges under- and overshoot
        (see `fermi_sum_locations` for what it leaves open). Behind sharpening kernels of 3 taps
        one function turns the line by 0.09 degrees over 40 rows and 0.4 over 20, the sum by 0.01
        and 0.04; without such lobes the sum has the more noise, 0.07 for 0.03 degrees over 40
        rows at SNR 57. A region has to hold 6 px on each side of the edge.
    trim_px : float
        Length of the line spread function (LSF) that is transformed; 10 px (200 sub-pixels) in the
        reports.
    smoothing_points : int
        Frame of the fourth-order Savitzky-Golay filter on the LSF, odd, 7 or more, or 0 for
        none. The reports do not print it; 21 points are one pixel, the window of the
        interpolation.
    replicates : int
        Draws of the rows for the standard deviations; 0 gives none.
    seed : int
        Of the generator that draws them.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    order: Literal[2, 4] = 4
    distance: Literal["row", "normal"] = "row"
    location: Literal["fermi", "fermi-sum"] = "fermi"
    trim_px: float = 10.0
    smoothing_points: int = 21
    replicates: int = 60
    seed: int = 2005

    def __post_init__(self) -> None:
        require_types(self)
        require_draws(self.replicates, self.seed)
        if not 4.0 <= self.trim_px <= 40.0:
            raise OptionError(f"trim_px must be 4 to 40 px, found {self.trim_px}")
        frame = self.smoothing_points
        if frame != 0 and (frame < 7 or frame % 2 == 0):
            raise OptionError(f"smoothing_points must be 0 or odd and at least 7, found {frame}")


_DEFAULT = SdsuOptions()
_LOCATIONS: dict[str, Locate] = {"fermi": fermi_locations, "fermi-sum": fermi_sum_locations}


def sdsu_2005(trimmed: EdgePixels, options: SdsuOptions = _DEFAULT) -> EdgeFit:
    """Measure an edge the way of South Dakota State University.

    Fermi function through the 7 pixels nearest the largest difference of each row, straight
    line through the centres, all rows on one axis, local polynomial of a 1 px window every
    0.05 px, difference of neighbours, fourth-order Savitzky-Golay, trim, Fourier transform.

    Known gains at Nyquist on the axis of the profile: .99958 (order 4) or .98016 (order 2)
    for the window, .99897 for the difference, .99958 for the default smoothing.

    Parameters
    ----------
    trimmed : EdgePixels
    options : SdsuOptions, optional

    Returns
    -------
    EdgeFit
        Distances and frequencies of its response run along the ROWS unless
        ``options.distance == "normal"``. The covariance comes from draws of the rows: scatter,
        not bias.

    Raises
    ------
    SupportError
        If rows or plateaus do not suffice.
    NoEdgeError, PhaseError
        See `locate_rows`; PhaseError also where the samples have too few phases for a polynomial
        of that order.
    """
    rows = locate_rows(trimmed, _LOCATIONS[options.location])
    require_phases_for(options.order, rows)
    return fit_with_bootstrap(
        trimmed,
        rows,
        partial(_sample, options=options),
        replicates=options.replicates,
        rng=np.random.default_rng(options.seed),
    )


def _sample(rows: LocatedRows, weight: Floats, options: SdsuOptions) -> SampledEdge:
    line = rows.line(weight)
    per_row_px = line.cosine if options.distance == "normal" else 1.0
    distance = rows.row_distance(line) * per_row_px
    margin_px = (options.smoothing_points // 2 + 4) * STEP_PX
    half = math.ceil((options.trim_px / 2 + margin_px) / STEP_PX)
    grid = np.arange(-half, half + 1, dtype=float) * STEP_PX
    _require_reach(rows, line, per_row_px, half * STEP_PX)
    used = np.isfinite(rows.value) & (weight[:, None] > 0)
    share = np.broadcast_to(weight[:, None], used.shape)[used]
    esf = modified_savitzky_golay(distance[used], rows.value[used], share, grid, options.order)
    rough = np.diff(esf)
    lsf = _smooth(rough, options.smoothing_points)
    places = grid[:-1] + STEP_PX / 2
    dark, bright = _plateaus(grid, esf, options.trim_px)
    middle = crossing_of_half(grid, normalised(esf, dark, bright))
    if math.isnan(middle):
        raise NoEdgeError(
            "the interpolated edge never passes half of its contrast: choose a region with one "
            "edge between uniform plateaus"
        )
    count = round(options.trim_px / STEP_PX)
    first = round((middle - places[0]) / STEP_PX - (count - 1) / 2)
    first = min(max(first, 0), places.size - count)
    kept = slice(first, first + count)
    return SampledEdge(line, per_row_px, grid, esf, dark, bright, places[kept], lsf[kept])


def _require_reach(rows: LocatedRows, line: RowLine, per_row_px: float, half_px: float) -> None:
    """Refuse pixels whose rows do not hold the window of the profile."""
    low, high = (reach * per_row_px for reach in rows.reach_px(line))
    if min(low, high) < half_px:
        raise SupportError(
            f"the profile needs {half_px:.1f} px on each side of the edge, found {low:.1f} on "
            f"the dark and {high:.1f} on the bright side: use a wider region, or "
            "in Python method_options with a smaller trim_px"
        )


def _plateaus(grid: Floats, esf: Floats, trim_px: float) -> tuple[float, float]:
    """Levels of the ESF: its means over the last pixel of the trimmed length on each side."""
    outer = (np.abs(grid) >= trim_px / 2 - 1.0) & (np.abs(grid) <= trim_px / 2)
    return float(esf[outer & (grid < 0)].mean()), float(esf[outer & (grid > 0)].mean())


def _smooth(lsf: Floats, points: int) -> Floats:
    """Standard Savitzky-Golay filter of fourth order."""
    if points == 0:
        return lsf
    from scipy.signal import savgol_filter

    return np.asarray(savgol_filter(lsf, points, _SMOOTHING_ORDER))
