"""The reference estimator of points: one joint fit of all sources, their PSF free.

Every pixel sees ``background + sum_k flux_k * PSF(x - x_k, y - y_k)``. The PSF is that of a plain
blur (`fit.point_start`) plus the directions of its prior (`fit.psf_prior`), whose amplitudes the
data decide (`fit.posterior`). Flux, place, background and slope of every source are unknowns of
the same linear problem (`fit.point_blocks`), solved again where they have moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.numerics.noise import Correlation, robust_scale
from acutance.targets.points.amplitudes import (
    averaged_posterior,
    felt_directions,
    likelier_growth,
    likelier_posterior,
)
from acutance.targets.points.background import Ground, ground_levels
from acutance.targets.points.first_fit import BlurredPoints, own_columns
from acutance.targets.points.noise import NOISE_FLOOR, PointNoise, grows, noise_around
from acutance.targets.points.per_source import Blocks, eliminate
from acutance.targets.points.psf import PsfModel
from acutance.targets.points.psf_prior import LOG_AMPLITUDE, LOG_AMPLITUDE_STD, PsfDirections
from acutance.targets.points.stamps import Stamps

__all__ = ["PointsFit", "fit_points"]

_FEWEST_PASSES, _MAX_PASSES = 3, 14
_NEGLIGIBLE = 0.15
"""Share of the noise that the errors of second order may have."""
_BEND = 3.0
"""Half of a peak's curvature, in peaks per square pixel, for a rather sharp system."""
_LONGEST_STEP_PX = 0.15
_HARDLY_BETTER = 0.997
_WORST = 0.3


@dataclass(frozen=True, eq=False)
class PointsFit:
    """Sources and their common PSF.

    Parameters
    ----------
    stamps : Stamps
        The pixels used.
    model : PsfModel
        The PSF with its covariance.
    places, places_std : (k, 2) arrays
        Sources as (row, col).
    fluxes, fluxes_std : (k,) arrays
        Light of each, summed over all pixels, seen or not.
    grounds : (k, 3) array
        Background at the pixel nearest to a source, and its slopes down and to the right per px.
    grounds_std : (k,) array
        Standard deviation of the background.
    light, fitted : (n,) arrays
        What its own source, and the model as a whole, gives every pixel.
    weight : (n,) array
        1 where a pixel is no outlier.
    noise : float
        Standard deviation of the background's noise.
    gain : float
        Variance of the noise per unit of light, 0 where the noise does not grow with it.
    correlation : Correlation
        Of the noise between neighbouring pixels.
    """

    stamps: Stamps
    model: PsfModel
    places: Floats
    places_std: Floats
    fluxes: Floats
    fluxes_std: Floats
    grounds: Floats
    grounds_std: Floats
    light: Floats
    fitted: Floats
    weight: Floats
    noise: float
    gain: float
    correlation: Correlation

    @property
    def residual(self) -> Floats:
        """What the model leaves of every pixel, (n,)."""
        return self.stamps.value - self.fitted

    @property
    def pixel_noise(self) -> Floats:
        """Standard deviation of every pixel's noise, (n,)."""
        return np.sqrt(self.noise**2 + self.gain * np.maximum(self.light, 0.0))

    @property
    def peaks(self) -> Floats:
        """What each source would add to a pixel right under it, (k,)."""
        nought = np.zeros(1)
        return self.fluxes * float(self.model.psf(nought, nought)[0])


def fit_points(stamps: Stamps, start: BlurredPoints, *, robust: bool = True) -> PointsFit:
    """Fit all sources with one free PSF.

    Parameters
    ----------
    stamps : Stamps
    start : BlurredPoints
        Where the plain blur found them.
    robust : bool, optional
        Bound the weight of outlying pixels.
    """
    directions = PsfDirections(start.blur)
    nothing = np.zeros(directions.size)
    model = PsfModel(directions, nothing, nothing[:, None])
    fluxes = start.fluxes * (1 + start.foot * directions.foot_share)
    state = _seen(stamps, model, start.places, fluxes, start.grounds)
    noise = PointNoise.white(stamps.value.size)
    peaks = start.fluxes * start.blur.peak
    least = NOISE_FLOOR * float(peaks.max())
    floor = max(least, _misfit(stamps, start, peaks))
    ground = Ground.of(stamps, start)
    before, earlier = state, None
    for passes in range(_MAX_PASSES):
        # Until the sources are in place, the linear problem leaves errors of second order: they
        # are taken for noise, lest the PSF explain them.
        prior = _prior(directions, ground, floor)
        system = _linear(stamps, state, noise, ground, prior.noise_floor)
        blocks = system.eliminated(noise.weight(state.light))
        posterior = likelier_posterior(
            blocks.normal, prior, system.variance, noise.correlation.inflation, earlier
        )
        moves = np.abs(blocks.own(posterior.beta)[:, 1:3]).max(axis=1)
        tried = _moved(stamps, state, ground, blocks, posterior)
        if tried.rms > 1.05 * max(state.rms, floor) and floor < _WORST * float(peaks.max()):
            floor, earlier = 4 * floor, None
            continue
        before, state, earlier = state, tried, posterior
        bends = _BEND * peaks * np.minimum(moves, _LONGEST_STEP_PX) ** 2
        # What counts is how they compare with the noise of the bright pixels they are in.
        bend = float((bends / np.sqrt(1 + noise.growth * peaks)).max())
        quiet = noise
        if bend <= state.rms:
            growth = _growth(before, state, system, blocks, noise, prior, posterior)
            quiet = noise_around(stamps, state.residual, state.light, growth, robust=robust)
        enough = max(least, _NEGLIGIBLE * state.rms)
        if bend < enough and floor < max(2 * least, state.rms) and noise.agrees(quiet):
            break
        # Where the PSF differs over the region, sources and PSF would go on chasing each other.
        chasing = state.rms > _HARDLY_BETTER * before.rms
        if chasing and passes > _FEWEST_PASSES and max(bend, floor) < before.rms:
            break
        floor, noise = max(least, bend), quiet
    posterior = averaged_posterior(blocks.normal, prior, noise.correlation.inflation, posterior)
    state = _moved(stamps, before, ground, blocks, posterior)
    return _found(stamps, state, ground, blocks, posterior, noise)


@dataclass(frozen=True, eq=False)
class _State:
    """Where the fit stands: PSF for unit flux of the mean blur, sources, light and residuals."""

    model: PsfModel
    places: Floats
    fluxes: Floats
    grounds: Floats
    light: Floats
    residual: Floats

    @property
    def rms(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residual**2)))


@dataclass(frozen=True, eq=False)
class _Linear:
    """What the unknowns of all sources do to the pixels, near a state; noise for unit weight."""

    own: Floats
    shared: Floats
    data: Floats
    starts: NDArray[np.intp]
    tie: Floats
    variance: float

    def eliminated(self, weight: Floats) -> Blocks:
        """The same without the sources' own unknowns."""
        return eliminate(self.own, self.shared, self.data, weight, self.starts, self.tie)


def _misfit(stamps: Stamps, start: BlurredPoints, peaks: Floats) -> float:
    """The errors of second order to expect of the start, in image units.

    What the plain blur leaves of a source beyond noise, as a share of its peak, is about how far
    off its place may be in pixels.
    """
    power = np.bincount(stamps.owner, start.residual**2, peaks.size)
    count = np.bincount(stamps.owner, minlength=peaks.size)
    excess = np.maximum(power - count * robust_scale(start.residual) ** 2, 0.0)
    away = np.minimum(np.sqrt(excess) / peaks, _LONGEST_STEP_PX)
    return _BEND * float((peaks * away**2).max())


def _prior(directions: PsfDirections, ground: Ground, noise_floor: float) -> Prior:
    block = np.concatenate([directions.block, np.full(ground.scale.size, -1)])
    return Prior(
        block.astype(float), np.concatenate([directions.scale, ground.scale]),
        np.zeros(block.size), LOG_AMPLITUDE, LOG_AMPLITUDE_STD, 1.0, noise_floor,
    )  # fmt: skip


def _linear(
    stamps: Stamps, state: _State, noise: PointNoise, ground: Ground, noise_floor: float
) -> _Linear:
    """The linear problem about the state."""
    directions = state.model.directions
    psf = state.model.with_slopes(*stamps.offsets(state.places))
    own = own_columns(stamps, state.places, state.fluxes, psf)
    columns, blur = directions.with_mean(*stamps.all_offsets(state.places))
    mean = stamps.summed(state.fluxes, blur)
    shared = np.hstack([stamps.summed(state.fluxes, columns), ground.columns])
    weight = noise.weight(state.light)
    variance = max(float(weight @ state.residual**2) / stamps.value.size, noise_floor**2)
    tie = ground.tie(math.sqrt(variance))
    return _Linear(own, shared, stamps.value - mean, stamps.starts, tie, variance)


def _moved(
    stamps: Stamps, state: _State, ground: Ground, blocks: Blocks, posterior: Posterior
) -> _State:
    own = blocks.own(posterior.beta)
    size = state.model.directions.size
    return _seen(
        stamps,
        PsfModel(state.model.directions, posterior.beta[:size], posterior.factor[:size]),
        state.places + np.clip(own[:, [2, 1]], -_LONGEST_STEP_PX, _LONGEST_STEP_PX),
        state.fluxes * (1 + np.clip(own[:, 0] / state.fluxes, -0.3, 0.3)),
        own[:, 3:] + ground.common(posterior.beta[size:]),
    )


def _seen(
    stamps: Stamps, model: PsfModel, places: Floats, fluxes: Floats, grounds: Floats
) -> _State:
    """The state with its light and its residuals."""
    psf = model.directions.sum(*stamps.all_offsets(places), model.weights)
    residual = stamps.value - stamps.summed(fluxes, psf) - ground_levels(stamps, places, grounds)
    light = fluxes[stamps.owner] * psf[: stamps.value.size]
    return _State(model, places, fluxes, grounds, light, residual)


def _growth(
    before: _State,
    state: _State,
    system: _Linear,
    blocks: Blocks,
    noise: PointNoise,
    prior: Prior,
    posterior: Posterior,
) -> float:
    """Variance of the noise per unit of light over that of the background."""

    if noise.growth == 0:
        leverage = _leverage(blocks, posterior, state.light)
        if not grows(state.residual, state.light, leverage):
            return 0.0
    dark = state.light < 0.01 * float(state.light.max())
    variance = max(robust_scale(state.residual[dark]), prior.noise_floor) ** 2
    brightest = float(before.light.max())
    inflated = variance * noise.correlation.inflation
    axes = felt_directions(blocks.normal, prior, posterior.log_amplitude, inflated)
    felt = replace(system, shared=system.shared @ axes)

    def solved(growth: float) -> tuple[Blocks, float]:
        weight = replace(noise, growth=growth).weight(before.light)
        return felt.eliminated(weight), float(np.log(weight).sum())

    return likelier_growth(solved, inflated, brightest)


def _leverage(blocks: Blocks, posterior: Posterior, light: Floats) -> Floats:
    """How much of its own noise the fit took up in every pixel; of dark ones, the sources' part."""
    leverage = blocks.leverage.copy()
    bright = np.flatnonzero(light > 0.01 * light.max())
    found = blocks.shared[bright] @ posterior.factor
    leverage[bright] += np.einsum("ij,ij->i", found, found) / posterior.variance
    return np.asarray(np.minimum(leverage, 1.0))


def _found(
    stamps: Stamps,
    state: _State,
    ground: Ground,
    blocks: Blocks,
    posterior: Posterior,
    noise: PointNoise,
) -> PointsFit:
    model = state.model
    std = math.sqrt(posterior.variance * noise.correlation.inflation)
    alone, shared = blocks.own_factor(std, posterior.factor)
    both = np.concatenate([alone, shared], axis=2)
    both[:, 3, alone.shape[2] :] += ground.common_factor(posterior.factor[model.weights.size :])
    flux_shared = model.volume * shared[:, 0] + state.fluxes[:, None] * model.volume_gradient
    flux_std = np.sqrt(
        (model.volume * alone[:, 0]) ** 2 @ np.ones(alone.shape[2])
        + np.einsum("ij,ij->i", flux_shared, flux_shared)
    )
    own_std = np.sqrt(np.einsum("kij,kij->ki", both, both))
    return PointsFit(
        stamps, model, state.places, own_std[:, [2, 1]], state.fluxes * model.volume, flux_std,
        state.grounds, own_std[:, 3], state.light, stamps.value - state.residual, noise.outlier,
        math.sqrt(posterior.variance), noise.growth * posterior.variance, noise.correlation,
    )  # fmt: skip
