"""The reference estimator: one edge, one linear model, one covariance.

The image of an edge is ``dark + ESF(s)`` with s the normal distance. The ESF is the plain blurred
edge (`fit.start`) plus a free spline and a tail (`fit.spline`, `fit.prior`), whose amplitudes the
data decide (`fit.posterior`). The line's direction is one more unknown of the same linear model,
solved again where the line has moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.fit import ground
from acutance.fit import prior as lsf_prior
from acutance.fit.band import EdgeBand, EdgeFit
from acutance.fit.blur import Blur
from acutance.fit.ground import ground_trends, is_uneven
from acutance.fit.lsf_model import LsfModel
from acutance.fit.noise import (
    Correlation,
    correlation,
    outlier_weights,
    robust_scale,
    side_variances,
)
from acutance.fit.normal import accumulate
from acutance.fit.posterior import Posterior, Prior, regress
from acutance.fit.spline import CELLS, HALF_SUPPORT, combine, edge_weights
from acutance.fit.start import BlurredEdge, fit_blurred_edge

__all__ = ["SplineEdge", "fit_edge"]

_NOISE_FLOOR = 2e-4
_SETTLED_PX = 1e-3
_MAX_PASSES = 6


@dataclass(frozen=True, eq=False)
class SplineEdge(EdgeFit):
    """The reference estimator's fit, with what its checks ask for.

    Attributes
    ----------
    blur : Blur
        The plain blur that explains the edge best.
    noise_dark, noise_bright : float
        Standard deviation of the noise on either side, in image units.
    correlation : Correlation
        What the residuals say of the noise's correlation.
    weights : (n,) array
        Weight of every pixel used, 1 where it is no outlier.
    tail : float
        Share of the LSF in the 1/x^2 tail.
    """

    blur: Blur
    noise_dark: float
    noise_bright: float
    correlation: Correlation
    weights: Floats
    tail: float


@dataclass(frozen=True, eq=False)
class _Pixels:
    row: Floats
    col: Floats
    value: Floats


def fit_edge(band: EdgeBand, *, robust: bool = True) -> SplineEdge:
    """Measure the edge of a band.

    Parameters
    ----------
    band : EdgeBand
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoEdgeError
        If the band holds no step.
    """
    rows, cols = np.nonzero(np.isfinite(band.image))
    pixels = _Pixels(rows.astype(float), cols.astype(float), band.image[rows, cols])
    start = _start(band, pixels)
    outlier = np.ones(pixels.value.size)
    spread_of_noise = Correlation(1.0, 0.0, 0.0)
    earlier: Posterior | None = None
    uneven = False
    for _ in range(_MAX_PASSES):
        solved = _solve(pixels, start, outlier, spread_of_noise.inflation, earlier, uneven)
        moved = abs(solved.turn_rad) * solved.half_length_px
        standard = solved.residual / solved.noise
        heavy = robust and bool(np.any(np.abs(standard) > 4.0))
        again = _reweighted(standard, solved.transition) if heavy else outlier
        whiteness = correlation(np.clip(standard, -4, 4), rows, cols, start.line.normal)
        settled = (
            (uneven or not solved.uneven)
            and moved < _SETTLED_PX
            and np.max(np.abs(again - outlier)) < 0.05
            and abs(whiteness.inflation / spread_of_noise.inflation - 1) < 0.05
        )
        if settled:
            break
        # With the trends there is one amplitude more: nothing earlier to start it from.
        earlier = solved.posterior if uneven or not solved.uneven else None
        outlier, spread_of_noise, uneven = again, whiteness, uneven or solved.uneven
        start = replace(start, line=start.line.moved(0.0, math.degrees(solved.turn_rad)))
    return _finish(band, pixels, start, solved, spread_of_noise, outlier)


def _start(band: EdgeBand, pixels: _Pixels) -> BlurredEdge:
    """The plain blurred edge the linear model departs from."""
    if band.blur is not None:
        return BlurredEdge(band.line, band.blur, band.dark, band.bright - band.dark, band.noise)
    return fit_blurred_edge(
        pixels.row, pixels.col, pixels.value, band.line,
        dark=band.dark, bright=band.bright, sigma_px=band.width_px, noise=band.noise,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Solution:
    """One pass of the linear model at a fixed line."""

    posterior: Posterior
    directions: lsf_prior.Directions
    residual: Floats
    noise: Floats
    transition: NDArray[np.bool_]
    side_noise: tuple[float, float]
    turn_rad: float
    turn_std_rad: float
    half_length_px: float
    uneven: bool


def _solve(
    pixels: _Pixels,
    start: BlurredEdge,
    outlier: Floats,
    inflation: float,
    earlier: Posterior | None,
    uneven: bool,
) -> _Solution:
    """Solve for the LSF's departures from the start, the levels and the line's direction."""
    line, blur, height = start.line, start.blur, start.height
    width = blur.width_px
    s = line.normal_distance(pixels.row, pixels.col)
    t = line.tangent_distance(pixels.row, pixels.col)
    u = s / width
    mean_esf, mean_lsf = blur.esf_and_lsf(s)
    departure = pixels.value - start.dark - height * mean_esf
    variance_dark, variance_bright = side_variances(departure * np.sqrt(outlier), mean_esf)
    floor = (_NOISE_FLOOR * height) ** 2
    scale = 0.5 * (variance_dark + variance_bright) + floor
    relative = (variance_dark + floor + (variance_bright - variance_dark) * mean_esf) / scale

    # Regressors beside the spline: the tail beyond the support, and the turn of the line.
    beyond = lsf_prior.tail_esf(u) - lsf_prior.tail_esf(np.clip(u, -HALF_SUPPORT, HALF_SUPPORT))
    trends = height * ground_trends(s, t, mean_esf) if uneven else np.empty((0, s.size))
    columns = np.vstack([beyond, height * t * mean_lsf, trends])
    cell, basis = edge_weights(u)
    directions = lsf_prior.directions(blur)
    design = _design(directions, len(trends))
    normal = accumulate(cell, basis, departure, outlier / relative, columns).combined(design)
    # What an outlier does not weigh, it does not count.
    normal = replace(normal, count=float(np.sum(outlier)))
    posterior = regress(normal, _prior(start, directions, len(trends)), scale, inflation, earlier)

    coefficients = design @ posterior.beta
    fitted = combine(cell, basis, coefficients[: CELLS + 3]) + coefficients[CELLS + 3 :] @ columns
    noise = np.sqrt(posterior.variance * relative)
    standard = np.clip((departure - fitted) / noise, -4, 4)
    turn = directions.block.size + 1
    side_noise = np.sqrt(posterior.variance / scale * np.array([variance_dark, variance_bright]))
    return _Solution(
        posterior, directions, departure - fitted, noise, np.abs(u) < 1.0,
        (float(side_noise[0]), float(side_noise[1])),
        float(posterior.beta[turn]), float(np.linalg.norm(posterior.factor[turn])),
        float(np.max(np.abs(t))), is_uneven(standard, s, t, width),
    )  # fmt: skip


def _reweighted(standard: Floats, transition: NDArray[np.bool_]) -> Floats:
    """Weights of the pixels by their standardised residuals.

    An outlier stands out from pixels like itself. Where many depart together, as in the
    transition when the model does not yet follow the edge, nobody is one.
    """
    bulk = [robust_scale(standard[place]) for place in (transition, ~transition) if place.any()]
    return outlier_weights(standard / min(max(bulk), 1.0))


def _design(directions: lsf_prior.Directions, trends: int) -> Floats:
    """What every coefficient (dark, the LSF's directions, turn, trends) does to spline and columns.

    The dark level lifts every ESF coefficient alike, because the B-splines sum to one; the tail
    is the last direction, within the support and beyond.
    """
    last = directions.block.size
    beside = 2 + trends
    design = np.zeros((CELLS + 3 + beside, last + beside))
    design[: CELLS + 3, 0] = 1.0
    design[: CELLS + 3, 1 : last + 1] = directions.esf
    design[CELLS + 3 :, last:] = np.eye(beside)
    return design


def _prior(start: BlurredEdge, directions: lsf_prior.Directions, trends: int) -> Prior:
    """The prior of all coefficients: dark, mean blur, processes, tail, turn, trends."""
    last = directions.block.size
    m = last + 2 + trends
    block = np.full(m, -1)
    block[1 : last + 1] = np.where(directions.block >= 2, directions.block - 2, -1)
    log_amplitude = lsf_prior.LOG_AMPLITUDE
    if trends:
        block[last + 2 :] = log_amplitude.size
        log_amplitude = np.append(log_amplitude, ground.LOG_AMPLITUDE)
    scale = np.ones(m)
    aperture, aperture_std = lsf_prior.APERTURE_PX
    mean = np.zeros(m)
    where = 1 + int(np.flatnonzero(directions.block == 1)[0])
    scale[where] = aperture_std
    mean[where] = (aperture - start.blur.aperture_px) * start.height
    return Prior(
        block, scale, mean, log_amplitude, lsf_prior.LOG_AMPLITUDE_STD,
        start.height, _NOISE_FLOOR * start.height,
    )  # fmt: skip


def _finish(
    band: EdgeBand,
    pixels: _Pixels,
    start: BlurredEdge,
    solved: _Solution,
    whiteness: Correlation,
    outlier: Floats,
) -> SplineEdge:
    """Turn the coefficients into curves about the 50 % point, with their covariance."""
    model = _lsf_model(start, solved)
    middle = model.half_point()
    response = model.response(middle)
    line = start.line.moved(middle, math.degrees(solved.turn_rad))
    t = line.tangent_distance(pixels.row, pixels.col)
    s = line.normal_distance(pixels.row, pixels.col)
    near = np.abs(s) < start.blur.width_px
    length = float(np.ptp(t[near])) if near.any() else math.nan
    dark = start.dark + float(solved.posterior.beta[0])
    height = model.height
    value = (pixels.value - dark) / height
    line = replace(
        line,
        angle_std_deg=math.degrees(solved.turn_std_rad),
        offset_std_px=model.half_point_std(response),
        length_px=length,
    )
    return SplineEdge(
        line, response, dark, dark + height, s, value, solved.residual / height,
        start.blur, *solved.side_noise, whiteness, outlier, model.tail / height,
    )  # fmt: skip


def _lsf_model(start: BlurredEdge, solved: _Solution) -> LsfModel:
    """The LSF the coefficients make: the tail has its own closed form beside the spline."""
    inner, tail = solved.directions.esf[:, :-1], solved.directions.block.size
    beta, factor = solved.posterior.beta, solved.posterior.factor
    latent = np.vstack([inner @ factor[1:tail], factor[tail]])
    return LsfModel(start.blur, start.height, inner @ beta[1:tail], float(beta[tail]), latent)
