"""The slanted-edge spatial frequency response of ISO 12233 (e-SFR).

Source: the e-SFR algorithm of ISO 12233:2023; what the steps leave open follows the reference
program, sfrmat5 by P. D. Burns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.errors import OptionError, SupportError
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published.edge_location import centroid_locations
from acutance.targets.straight.published.resampled_response import (
    FREQ_CPP,
    SampledEdge,
    fit_with_bootstrap,
    require_draws,
)
from acutance.targets.straight.published.row_profiles import LocatedRows, RowLine, locate_rows
from acutance.targets.straight.published.windows import hamming_window, tukey_window

__all__ = ["Iso12233Options", "iso12233"]

_SHORTEST_PX = 3.0
_MAX_CORRECTION = 10.0


@dataclass(frozen=True)
class Iso12233Options:
    """Choices of `iso12233`.

    Parameters
    ----------
    bins_per_px : int
        Bins per pixel along the row; 4 in the standard.
    edge_order : int
        Degree of the polynomial through the rows' centroids, 1 to 5. The edition of 2023 allows
        up to 5 for the bent edges of wide-angle lenses; edges on the ground are straight.
    window : {"tukey", "hamming"}
        Taper of the line spread function (LSF): Tukey since the edition of 2023, Hamming before.
    tukey_alpha : float
        Share of the Tukey window that is tapered, over 0 to 1; 1 (a Hann window) is what the
        reference program uses.
    replicates : int
        Draws of the rows for the standard deviations; 0 gives none.
    seed : int
        Of the generator that draws them.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    bins_per_px: int = 4
    edge_order: int = 1
    window: Literal["tukey", "hamming"] = "tukey"
    tukey_alpha: float = 1.0
    replicates: int = 60
    seed: int = 12233

    def __post_init__(self) -> None:
        require_types(self)
        require_draws(self.replicates, self.seed)
        if not 1 <= self.bins_per_px <= 16 or not 1 <= self.edge_order <= 5:
            raise OptionError(
                f"bins_per_px must be 1 to 16 and edge_order 1 to 5, "
                f"found {self.bins_per_px} and {self.edge_order}"
            )
        if not 0 < self.tukey_alpha <= 1:
            raise OptionError(f"tukey_alpha is {self.tukey_alpha}: give one above 0 and up to 1")


_DEFAULT = Iso12233Options()


def iso12233(trimmed: EdgePixels, options: Iso12233Options = _DEFAULT) -> EdgeFit:
    """Measure an edge by the slanted-edge method of ISO 12233.

    Centroid of the windowed derivative in each row, line through the centroids, a whole number
    of phase cycles of rows, bins of a quarter pixel, mean of each bin, central difference,
    window, Fourier transform, and the correction 1 / sinc(2 f h) of the difference with at
    most a factor of 10. The distance between bins is taken along the normal.

    Known gains that stay: sinc(f h) of the bins, -2.55 % at Nyquist, and that of the
    window, about 1 + [M''(f) / M(f) - M''(0)] / (4 W^2) for a Hann window of W px.

    Parameters
    ----------
    trimmed : EdgePixels
    options : Iso12233Options, optional

    Returns
    -------
    EdgeFit
        Curves along the normal. The covariance comes from draws of the rows: scatter, not
        bias.

    Raises
    ------
    SupportError, NoEdgeError, PhaseError
        See `locate_rows`; SupportError also when the bins reach less than 3 px.
    """
    rows = _whole_cycles(locate_rows(trimmed, centroid_locations))
    return fit_with_bootstrap(
        trimmed,
        rows,
        partial(_sample, options=options),
        replicates=options.replicates,
        rng=np.random.default_rng(options.seed),
    )


def _whole_cycles(rows: LocatedRows) -> LocatedRows:
    """The first rows, as many as make whole cycles of the sample phases (one at least)."""
    slope = abs(rows.line().slope)
    cycles = math.floor(rows.row.size * slope)
    return rows if cycles < 1 else rows.first(min(round(cycles / slope), rows.row.size))


def _sample(rows: LocatedRows, weight: Floats, options: Iso12233Options) -> SampledEdge:
    line = rows.line(weight)
    distance = rows.row_distance(line) - _bend(rows, line, weight, options.edge_order)[:, None]
    step = 1.0 / options.bins_per_px
    low, high = rows.reach_px(line)
    if min(low, high) < _SHORTEST_PX:
        raise SupportError(
            f"the bins must reach {_SHORTEST_PX:g} px on each side of the edge, found {low:.1f} "
            f"on the dark and {high:.1f} on the bright side: use a wider region"
        )
    first, last = math.ceil(-low / step), math.floor(high / step)
    esf = _bin_means(rows.value, distance, weight, step, first, last)
    lsf = (esf[2:] - esf[:-2]) / 2
    spacing_px = step * line.cosine
    places = (np.arange(first, last + 1, dtype=float) + 0.5) * spacing_px
    inner = places[1:-1]
    # The reference program moves the LSF so that its peak is in the middle of the window.
    from_peak = inner - inner[int(np.argmax(lsf))]
    half_width = inner.size * spacing_px / 2
    if options.window == "tukey":
        taper = tukey_window(from_peak, half_width, options.tukey_alpha)
    else:
        taper = hamming_window(from_peak, half_width)
    with np.errstate(divide="ignore"):
        correction = 1.0 / np.abs(np.sinc(2 * FREQ_CPP * spacing_px))
    return SampledEdge(
        line=line,
        per_row_px=line.cosine,
        esf_distance_px=places,
        esf=esf,
        dark=float(esf[places < places[0] / 2].mean()),
        bright=float(esf[places > places[-1] / 2].mean()),
        lsf_distance_px=inner,
        lsf=lsf * taper,
        correction=np.minimum(correction, _MAX_CORRECTION),
    )


def _bend(rows: LocatedRows, line: RowLine, weight: Floats, order: int) -> Floats:
    """How far the polynomial through the centroids lies from the line in each row, (n,)."""
    if order == 1:
        return np.zeros_like(rows.row)
    along = (rows.row - line.row) / line.rows
    straight = line.at(rows.row)
    polynomial = np.polyfit(along, rows.col - straight, order, w=np.sqrt(weight))
    return np.asarray(np.polyval(polynomial, along))


def _bin_means(
    value: Floats, distance: Floats, weight: Floats, step: float, first: int, last: int
) -> Floats:
    """Mean of the pixels in each bin from `first` to `last`; an empty bin gets its neighbours'."""
    number = np.floor(distance / step).astype(int) - first
    count = last - first + 1
    used = np.isfinite(value) & (number >= 0) & (number < count)
    share = np.broadcast_to(weight[:, None], value.shape)[used]
    total = np.bincount(number[used], share, minlength=count)
    sums = np.bincount(number[used], share * value[used], minlength=count)
    full = np.flatnonzero(total > 0)
    return np.interp(np.arange(count), full, sums[full] / total[full])
