"""From sampled curves to a `Response`, with a covariance by drawing the rows again.

The non-parametric pipelines smooth and differentiate, so their errors have no closed form.
Instead the rows of the edge are drawn with replacement and everything after the location of
the edge in each row (line, ESF, line spread function (LSF), OTF) is repeated. The scatter of the
repetitions is the scatter that another image of the same edge would show; a bias of the pipeline is
the same in every repetition and is NOT covered.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.grid import Floats, crossing
from acutance.curves.metrics import RerCentre
from acutance.errors import AcutanceError, NoEdgeError, OptionError, SupportError
from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published.row_profiles import LocatedRows, RowLine

__all__ = [
    "FREQ_CPP",
    "GRID_PX",
    "STEP_PX",
    "SampledEdge",
    "covariance_factor",
    "crossing_of_half",
    "draw_rows",
    "edge_fit",
    "fit_with_bootstrap",
    "normalised",
    "require_draws",
]

STEP_PX = 0.05
GRID_PX: Floats = np.arange(-100.0, 101.0) * STEP_PX
"""Distances of the ESF and the LSF, 0 at the 50 % point."""

FREQ_CPP: Floats = np.arange(101.0) * 0.01
"""Frequencies of the optical transfer function (OTF)."""

Complexes = NDArray[np.complex128]
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class SampledEdge:
    """What a pipeline makes of one set of rows, on its own regular grids.

    Parameters
    ----------
    line : RowLine
        The edge in the turned image.
    per_row_px : float
        Length on the distance axis per pixel along a row: the cosine of the edge's angle when
        the axis is normal to the edge, 1 when it runs along the rows.
    esf_distance_px, esf : (n,) arrays
        From the line; in the image's units.
    dark, bright : float
        Levels that become 0 and 1.
    lsf_distance_px, lsf : (m,) arrays
        What is transformed, smoothed and windowed already; any unit.
    correction : (101,) array or None
        Factor the pipeline applies to its OTF at `FREQ_CPP`.
    """

    line: RowLine
    per_row_px: float
    esf_distance_px: Floats
    esf: Floats
    dark: float
    bright: float
    lsf_distance_px: Floats
    lsf: Floats
    correction: Floats | None = None

    def normalised_esf(self) -> Floats:
        """The ESF from 0 to 1, (n,)."""
        return normalised(self.esf, self.dark, self.bright)

    def middle_px(self) -> float:
        """Where the ESF passes 50 %; NaN where it never does."""
        return crossing_of_half(self.esf_distance_px, self.normalised_esf())

    def otf(self) -> Complexes:
        """Fourier transform of the LSF at `FREQ_CPP`, 1 at 0, phase from the centroid, (101,)."""
        total = self.lsf.sum()
        centroid = self.lsf @ self.lsf_distance_px / total
        # The frequencies are multiples of one, so each wave is the previous one turned again.
        turn = np.exp(-2j * np.pi * FREQ_CPP[1] * (self.lsf_distance_px - centroid))
        waves = np.cumprod(np.broadcast_to(turn, (FREQ_CPP.size - 1, turn.size)), axis=0)
        otf = np.concatenate(([1.0 + 0j], np.einsum("fx,x->f", waves, self.lsf) / total))
        return np.asarray(otf if self.correction is None else otf * self.correction)


def normalised(esf: Floats, dark: float, bright: float) -> Floats:
    """An ESF from 0 to 1.

    Raises
    ------
    NoEdgeError
        If the bright level is not above the dark one.
    """
    if not bright > dark:
        raise NoEdgeError(
            f"the profile across the edge must rise, found levels {dark:g} and {bright:g}: "
            "use a region with one edge and more contrast"
        )
    return (esf - dark) / (bright - dark)


def crossing_of_half(distance_px: Floats, esf: Floats) -> float:
    """Where a normalised ESF passes 50 % in its steep part; NaN where it never does."""
    steepest = int(np.argmax(np.diff(esf)))
    below = np.flatnonzero(esf[: steepest + 2] < 0.5)
    if below.size == 0:
        return math.nan
    return crossing(distance_px, esf, 0.5, float(distance_px[below[-1]]))


def _on_grid(edge: SampledEdge) -> tuple[Floats, Floats, Complexes] | None:
    """ESF and LSF on the common grid and the OTF; None when the ESF has no 50 % point.

    Beyond its ends the ESF keeps its last value and the LSF is 0.
    """
    from scipy.interpolate import CubicSpline

    middle = edge.middle_px()
    if math.isnan(middle):
        return None
    places = np.clip(GRID_PX + middle, edge.esf_distance_px[0], edge.esf_distance_px[-1])
    esf = CubicSpline(edge.esf_distance_px, edge.normalised_esf())(places)
    step = edge.lsf_distance_px[1] - edge.lsf_distance_px[0]
    density = edge.lsf / (edge.lsf.sum() * step)
    lsf = CubicSpline(edge.lsf_distance_px, density, extrapolate=False)(GRID_PX + middle)
    return esf, np.nan_to_num(lsf, nan=0.0), edge.otf()


def fit_with_bootstrap(
    trimmed: EdgePixels,
    rows: LocatedRows,
    pipeline: Callable[[LocatedRows, Floats], SampledEdge],
    *,
    replicates: int,
    rng: np.random.Generator,
    rer_centre: RerCentre = "half",
) -> EdgeFit:
    """Run `pipeline` on all rows and on `replicates` draws of them.

    Parameters
    ----------
    trimmed : EdgePixels
    rows : LocatedRows
    pipeline : callable
        Takes the rows and how often each one counts (n,), gives a `SampledEdge`.
    replicates : int
        How many draws; 0 gives curves without standard deviations.
    rng : numpy.random.Generator
        Draws the rows.
    rer_centre : {"half", "peak"}, optional
        What the response centres its relative edge response (RER) on.

    Raises
    ------
    NoEdgeError
        If the fitted ESF never passes its 50 % level.
    SupportError
        If fewer than half of the draws can be measured.
    """
    count = rows.row.size
    edge = pipeline(rows, np.ones(count))
    curves = _on_grid(edge)
    if curves is None:
        raise NoEdgeError(
            "the fitted edge spread function never passes 50 % of its own contrast: "
            "use a region with wider and more even plateaus"
        )
    kept = draw_rows(
        rows, lambda weight: _on_grid(pipeline(rows, weight)), replicates=replicates, rng=rng
    )
    esf, lsf, otf = (np.stack(part, axis=1) for part in zip(curves, *kept, strict=True))
    response = Response(
        Esf(GRID_PX, curves[0], covariance_factor(esf[:, 1:])),
        Lsf(GRID_PX, curves[1], covariance_factor(lsf[:, 1:])),
        Mtf(FREQ_CPP, otf[:, 0], covariance_factor(otf[:, 1:])),
        rer_centre=rer_centre,
    )
    line = rows.frame.line_in_region(edge.line)
    per_normal_px = edge.per_row_px / edge.line.cosine
    return edge_fit(
        trimmed,
        line.moved(edge.middle_px() / per_normal_px, 0.0),
        response,
        dark=edge.dark,
        bright=edge.bright,
        per_normal_px=per_normal_px,
    )


def require_draws(replicates: int, seed: int) -> None:
    """Refuse numbers of draws, and seeds of their generator, that there are not.

    Raises
    ------
    OptionError
        If one is below zero.
    """
    for name, value in (("replicates", replicates), ("seed", seed)):
        if value < 0:
            raise OptionError(f"{name} must be 0 or more, found {value}")


def draw_rows(
    rows: LocatedRows,
    measure: Callable[[Floats], T | None],
    *,
    replicates: int,
    rng: np.random.Generator,
) -> list[T]:
    """Measure `replicates` draws of the rows, with replacement.

    Parameters
    ----------
    rows : LocatedRows
    measure : callable
        Takes how often each row counts (n,); ``None`` or an error where that cannot be measured.
    replicates : int
    rng : numpy.random.Generator

    Raises
    ------
    SupportError
        If fewer than half of the draws can be measured.
    """
    count = rows.row.size
    kept = []
    for weight in rng.multinomial(count, np.full(count, 1.0 / count), size=replicates):
        try:
            drawn = measure(weight.astype(float))
        except AcutanceError:
            continue
        if drawn is not None:
            kept.append(drawn)
    if len(kept) < replicates / 2:
        raise SupportError(
            f"only {len(kept)} of {replicates} draws of the {count} rows can be measured, at "
            "least half are needed for a standard deviation: use a region with more rows"
        )
    return kept


def covariance_factor(drawn: NDArray[Any]) -> NDArray[Any]:
    """Factor of the covariance of columns that were drawn, (n, replicates); (n, 0) for one."""
    if drawn.shape[1] < 2:
        return drawn[:, :0]
    centred: NDArray[Any] = drawn - drawn.mean(axis=1, keepdims=True)
    return centred / math.sqrt(drawn.shape[1] - 1)


def edge_fit(
    trimmed: EdgePixels,
    line: Line,
    response: Response,
    *,
    dark: float,
    bright: float,
    per_normal_px: float = 1.0,
) -> EdgeFit:
    """The fit of an edge by its curves, with every usable pixel's distance, value and residual.

    Parameters
    ----------
    trimmed : EdgePixels
    line : Line
        Through the 50 % point, in pixels of the region.
    response : Response
    dark, bright : float
        Levels of the plateaus.
    per_normal_px : float, optional
        Length on the curves' distance axis per pixel along the normal.
    """
    from scipy.interpolate import CubicSpline

    pixels = trimmed.pixels
    distance = line.normal_distance(pixels.row, pixels.col)
    value = (pixels.value - dark) / (bright - dark)
    esf = response.esf
    places = np.clip(distance * per_normal_px, esf.distance_px[0], esf.distance_px[-1])
    model = CubicSpline(esf.distance_px, esf.value)(places)
    return EdgeFit(line, response, dark, bright, distance, value, value - model)
