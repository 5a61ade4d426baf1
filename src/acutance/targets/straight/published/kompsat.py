"""The twelve steps of the KOMPSAT-3 team's edge method.

Source: Lee, Helder, Christopherson, Storey, Seo, Stensaas, "RER, FWHM, MTF processing step for
edge target (draft) and standard edge targets by KOMPSAT-3" (2014). Steps 1 to 4 (choice and
health of the target) belong to the region and to the checks of a measurement.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.curves.metrics import RerCentre
from acutance.errors import NoEdgeError, OptionError, SupportError
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published.edge_location import cubic_locations
from acutance.targets.straight.published.fermi_sum import fit_profile
from acutance.targets.straight.published.resampled_response import (
    STEP_PX,
    SampledEdge,
    fit_with_bootstrap,
    require_draws,
)
from acutance.targets.straight.published.row_profiles import LocatedRows, locate_rows
from acutance.targets.straight.published.smoothing_spline import fit_smoothing_spline

__all__ = ["KompsatOptions", "kompsat_2014", "start_points"]

_MAX_START_PX = 4.0


@dataclass(frozen=True)
class KompsatOptions:
    """Choices of `kompsat_2014`; the letters are those of the draft's steps.

    Parameters
    ----------
    distance : {"normal", "as-drafted"}
        6a. "normal" multiplies row distances by the cosine of the edge's angle. The draft's
        words divide by it, which costs -31 to -39 % of the MTF at Nyquist at 20
        degrees; "as-drafted" does that, for comparison with results obtained so.
    start : {"inflection", "bend"}
        7a. Where the plateaus start: the inflection points of the line spread function (LSF), as
        the draft says, which for a Gaussian lie at one standard deviation; or "bend", where its
        second derivative is largest, at the ends of the LSF. With 1 px of each plateau the
        inflection points cut the wings of wide ones: a Gaussian through a pixel has +0.3 % of the
        MTF at Nyquist at 0.5 px against "bend", -1 % at 0.6 px, -16 to -23 % at 0.8 px.
    start_smoothness : float
        7a. The csaps p of the first spline, which only finds where the plateaus start; the
        draft leaves it open.
    plateau_px : float
        7b. How much of each plateau is kept.
    esf : {"spline", "fermi"}
        8a. Cubic smoothing spline, or one Fermi function.
    smoothness : float
        8a. The csaps p of the spline, 0.98 in the draft's figures.
    rer_centre : {"peak", "half"} or None
        9. None follows the draft: the peak of the LSF with a spline (9b), the 50 % point with a
        Fermi function (9d).
    replicates : int
        Draws of the rows for the standard deviations; 0 gives none.
    seed : int
        Of the generator that draws them.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    distance: Literal["normal", "as-drafted"] = "normal"
    start: Literal["inflection", "bend"] = "inflection"
    start_smoothness: float = 0.5
    plateau_px: float = 1.0
    esf: Literal["spline", "fermi"] = "spline"
    smoothness: float = 0.98
    rer_centre: RerCentre | None = None
    replicates: int = 60
    seed: int = 2014

    def __post_init__(self) -> None:
        require_types(self)
        require_draws(self.replicates, self.seed)
        if not (0 < self.smoothness < 1 and 0 < self.start_smoothness < 1):
            raise OptionError(
                f"smoothness is {self.smoothness} and start_smoothness {self.start_smoothness}: "
                "give both between 0 and 1"
            )
        if self.plateau_px <= 0:
            raise OptionError(f"plateau_px must be positive, found {self.plateau_px}")


_DEFAULT = KompsatOptions()


def kompsat_2014(trimmed: EdgePixels, options: KompsatOptions = _DEFAULT) -> EdgeFit:
    """Measure an edge by the steps of the KOMPSAT-3 draft.

    Inflection of the cubic through 4 pixels of each row, straight line, distance of every
    pixel, start of the plateaus at the inflection points of a first line spread function (LSF),
    trim, cubic smoothing spline, its derivative every 0.05 px, Fourier transform.

    Known bias: a smoothing spline over r samples per pixel passes a frequency f with the gain
    1 / (1 + (1 - p) / p (2 pi f)^4 / r), -4.7 % at Nyquist for p = 0.98 and 40 rows;
    and trimming cuts the tails of the LSF.

    Parameters
    ----------
    trimmed : EdgePixels
    options : KompsatOptions, optional

    Returns
    -------
    EdgeFit
        Curves along the normal (with ``distance="as-drafted"`` on the draft's axis). Beyond
        the trimmed length the edge spread function (ESF) is its plateau and the LSF 0. The
        covariance comes from draws of the rows: scatter, not bias.

    Raises
    ------
    SupportError
        If the plateaus end before the length to be kept, and as in `locate_rows`.
    NoEdgeError, PhaseError
        See `locate_rows`.
    """
    rows = locate_rows(trimmed, cubic_locations)
    centre: RerCentre = "peak" if options.esf == "spline" else "half"
    return fit_with_bootstrap(
        trimmed,
        rows,
        partial(_sample, options=options),
        replicates=options.replicates,
        rng=np.random.default_rng(options.seed),
        rer_centre=options.rer_centre or centre,
    )


def _sample(rows: LocatedRows, weight: Floats, options: KompsatOptions) -> SampledEdge:
    line = rows.line(weight)
    per_row_px = line.cosine if options.distance == "normal" else 1.0 / line.cosine
    distance = rows.row_distance(line) * per_row_px
    used = np.isfinite(rows.value) & (weight[:, None] > 0)
    x, y = distance[used], rows.value[used]
    share = np.broadcast_to(weight[:, None], used.shape)[used]

    low, high = (reach * per_row_px for reach in rows.reach_px(line))
    start, stop = start_points(x, y, share, -low, high, options.start_smoothness, options.start)
    start, stop = start - options.plateau_px, stop + options.plateau_px
    if start < -low or stop > high:
        raise SupportError(
            f"the transition and {options.plateau_px:g} px of each plateau run from {start:.1f} "
            f"to {stop:.1f} px, found pixels from {-low:.1f} to {high:.1f}: use a wider region"
        )
    kept = (x >= start) & (x <= stop)
    grid = start + np.arange(round((stop - start) / STEP_PX) + 1.0) * STEP_PX
    if options.esf == "spline":
        spline = fit_smoothing_spline(
            x[kept],
            y[kept],
            share[kept],
            smoothness=options.smoothness,
            start=start,
            stop=stop,
        )
        grid = spline.start + np.arange(spline.coefficient.size - 2.0) * spline.step
        esf, lsf = spline(grid), spline(grid, 1)
        dark, bright = float(esf[0]), float(esf[-1])
    else:
        level, fermi = fit_profile(x[kept], y[kept], share[kept])
        esf, lsf = level + fermi.value(grid), fermi.slope(grid)
        dark, bright = level, level + fermi.contrast
    return SampledEdge(line, per_row_px, grid, esf, dark, bright, grid, lsf)


def start_points(
    x: Floats,
    y: Floats,
    weight: Floats,
    low: float,
    high: float,
    smoothness: float,
    at: Literal["inflection", "bend"] = "inflection",
) -> tuple[float, float]:
    """Where the dark area ends and the bright one starts, step 7 of the draft.

    The second derivative of the LSF of a first smoothing spline passes zero at its two inflection
    points, where the LSF is steepest, and is largest at its two ends.

    Parameters
    ----------
    x, y, weight : (n,) arrays
        Distances, values and how often each counts.
    low, high : float
        Range of the spline, low < 0 < high.
    smoothness : float
        The csaps p of the spline.
    at : {"inflection", "bend"}
        Which of the two points are meant.

    Returns
    -------
    dark_end, bright_start : float

    Raises
    ------
    NoEdgeError
        If the spline is steepest at an end of the search.
    """
    kept = (x >= low) & (x <= high)
    step = (high - low) / math.ceil((high - low) / STEP_PX)
    spline = fit_smoothing_spline(
        x[kept], y[kept], weight[kept], smoothness=smoothness, start=low, stop=high, step=step
    )
    middles = low + (np.arange(spline.coefficient.size - 3.0) + 0.5) * step
    lsf, slope, bend = (spline(middles, order) for order in (1, 2, 3))
    near = np.abs(middles) <= _MAX_START_PX
    peak = middles[near][int(np.argmax(lsf[near]))]
    dark = near & (middles < peak)
    bright = near & (middles > peak)
    if not (dark.any() and bright.any()):
        raise NoEdgeError(
            f"the spline of kompsat-2014 is steepest at {peak:.2f} px from the edge, at the end of "
            "the search: something steeper lies next to the edge; choose a region with one edge, "
            "or the method spline"
        )
    rising, falling = (slope, -slope) if at == "inflection" else (bend, bend)
    return (
        float(middles[dark][int(np.argmax(rising[dark]))]),
        float(middles[bright][int(np.argmax(falling[bright]))]),
    )
