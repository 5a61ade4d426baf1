"""The reference estimator of points: one joint fit of all sources, their PSF free.

Every pixel holds ``background + sum_k flux_k * PSF(x - x_k, y - y_k)``. The PSF is a Gaussian
through a pixel (`first_fit`) plus the directions of its prior (`psf_prior`), whose amplitudes the
data decide (`amplitudes`); in the last pass it is that of a sensor (`among_sensors`). Flux, place,
background and slope of every source are unknowns of the same linear problem (`per_source`), solved
again where they have moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.targets.points import tuned
from acutance.targets.points.among_sensors import AmongSensors, Equations, among_sensors
from acutance.targets.points.amplitudes import (
    determined_directions,
    likelier_posterior,
    likeliest_growth,
)
from acutance.targets.points.background import Background
from acutance.targets.points.first_fit import FirstFit, own_columns
from acutance.targets.points.noise import PointNoise, noise_around, noise_grows
from acutance.targets.points.pads import Pads, PadsFound, find_pads, pads_image
from acutance.targets.points.per_source import Blocks, SourceProblem
from acutance.targets.points.points_fit import PointsFit
from acutance.targets.points.psf import PsfModel
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.stamps import Stamps

__all__ = ["fit_points"]

_MIN_PASSES, _MAX_PASSES = 3, 14
_MAX_STEP_PX = 0.15
_MAX_FLUX_STEP = 0.3
_HARDLY_BETTER = 0.997
_WORSE = 1.05
_MAX_FLOOR = 0.3
_DARK = 0.01


def fit_points(stamps: Stamps, first: FirstFit, *, robust: bool = True) -> PointsFit:
    """Fit all sources with one free PSF.

    Parameters
    ----------
    stamps : Stamps
    first : FirstFit
        Where one Gaussian through a pixel found them.
    robust : bool, optional
        Bound the weight of outlying pixels.

    Notes
    -----
    Where no PSF explains the pixels, numpy's ``LinAlgError`` is raised: of the normal equations, or
    because the PSF found has no light in all, or none at its centre.
    """
    background = Background.of(stamps, first)
    state = _first_state(stamps, first)
    settled = _settle(stamps, first, state, background, robust)
    among = settled.among_sensors()
    pads = _pads_beside(stamps, first, settled, among)
    if pads is not None and pads.sure:
        image = pads_image(stamps, settled.state.places, first.blur, pads.side_px)
        background = background.with_pads(image, _pad_contrast(first))
        settled = _settle(stamps, first, state, background, robust)
        among = settled.among_sensors()
    posterior = among.posterior
    if pads is not None and not pads.sure:
        posterior = pads.averaged(posterior)
    state = _updated(stamps, settled.state, background, settled.blocks, posterior)
    fit = _points_fit(stamps, state, background, settled.blocks, posterior, settled.noise)
    if not (fit.model.volume > 0 and (fit.peaks > 0).all()):
        raise np.linalg.LinAlgError("the point spread function has no light at its centre")
    doubt = np.zeros((posterior.beta.size, 0))
    if pads is not None and not pads.sure:
        doubt = pads.doubt(among.posterior)
    fit = replace(fit, families=among.share, posterior=settled.posterior, doubt=doubt)
    if pads is None or not pads.likely:
        return fit
    return replace(fit, pads=Pads.of(pads.side_px, posterior if pads.sure else pads.posterior))


def _pads_beside(
    stamps: Stamps, first: FirstFit, settled: _Settled, without: AmongSensors
) -> PadsFound | None:
    """Pads under the sources, where the noise and the number of these allow to see them."""
    contrast_std = _pad_contrast(first)
    quiet = settled.posterior.variance < (contrast_std * tuned.PAD_MIN_NOISE) ** 2
    if quiet or settled.blocks.own_data.shape[0] < tuned.MIN_TIED_SOURCES:
        return None
    state = settled.state
    sides_px = (tuned.NO_PAD_PX, *tuned.PAD_SIDES_PX)
    return find_pads(
        settled.problem,
        settled.blocks,
        [pads_image(stamps, state.places, state.model.blur, one) for one in sides_px],
        contrast_std,
        settled.weight,
        without,
        state.model.directions,
    )


def _pad_contrast(first: FirstFit) -> float:
    """Prior standard deviation of the contrast of pads, in image units."""
    return tuned.PAD_CONTRAST * float((first.fluxes * first.blur.peak).max())


@dataclass(frozen=True, eq=False)
class _State:
    """Where the fit stands: PSF for unit flux of the mean blur, sources, light and residuals."""

    model: PsfModel
    places: Floats
    fluxes: Floats
    backgrounds: Floats
    light: Floats
    residual: Floats

    def rms(self, weight: Floats) -> float:
        """Root mean square of the residuals, of a pixel of weight 1."""
        return math.sqrt(float(np.mean(weight * self.residual**2)))


class _Settled(NamedTuple):
    """The last linear problem: where it was posed, and its solution by the normal prior."""

    state: _State
    problem: SourceProblem
    weight: Floats
    blocks: Blocks
    prior: Prior
    posterior: Posterior
    noise: PointNoise

    def among_sensors(self) -> AmongSensors:
        """The solution with the density of sensors as the prior of the PSF."""
        inflation = self.noise.correlation.inflation
        equations = Equations(self.blocks.normal, self.prior, inflation, self.posterior)
        return among_sensors(equations, self.state.model.directions)


def _settle(
    stamps: Stamps, first: FirstFit, state: _State, background: Background, robust: bool
) -> _Settled:
    """Solve the linear problem again until nothing moves: the last one, and where it was posed.

    No least squares of fixed weights: every pass finds the prior's amplitudes by the marginal
    likelihood of its linear problem, and weights, correlation and growth of the noise from what is
    left.
    """
    peaks = first.fluxes * first.blur.peak
    brightest = float(peaks.max())
    min_floor = max(tuned.NOISE_FLOOR * brightest, stamps.least_noise)
    floor = max(min_floor, _first_bend(stamps, first, peaks))
    found, earlier = PointNoise.white(stamps.value.size), None
    for passes in range(_MAX_PASSES):
        noise = found
        # Until the sources are in place, the linear problem leaves errors of second order: they
        # are taken for noise, lest the PSF explain them.
        prior = _prior(state.model.directions, background, floor)
        weight, inflation = noise.weight(state.light), noise.correlation.inflation
        variance = max(float(weight @ state.residual**2) / stamps.value.size, floor**2)
        problem = _linear_problem(stamps, state, background, math.sqrt(variance))
        blocks = problem.eliminated(weight)
        posterior = likelier_posterior(blocks.normal, prior, variance, inflation, earlier)
        before, state = state, _updated(stamps, state, background, blocks, posterior)
        # By the weights of this pass: those of other noise have another minimum.
        rms_before, rms = before.rms(weight), state.rms(weight)
        if rms > _WORSE * max(rms_before, floor) and floor < _MAX_FLOOR * brightest:
            state, floor, earlier = before, 4 * floor, None
            continue
        earlier = posterior
        bend = _bend(peaks, blocks.own(posterior.beta)[:, 1:3], noise)
        if bend <= rms:
            growth = _growth(stamps, problem, blocks, noise, prior, posterior, before.light, state)
            found = noise_around(stamps, state.residual, state.light, growth, robust=robust)
        negligible = max(min_floor, tuned.NEGLIGIBLE_BEND * rms)
        if bend < negligible and floor < max(2 * min_floor, rms) and noise.agrees(found):
            break
        # Where the PSF differs over the region, sources and PSF would go on chasing each other.
        chasing = rms > _HARDLY_BETTER * rms_before and noise.grows_as(found)
        if chasing and passes > _MIN_PASSES and max(bend, floor) < rms_before:
            break
        floor = max(min_floor, bend)
    return _Settled(before, problem, weight, blocks, prior, posterior, noise)


def _first_bend(stamps: Stamps, first: FirstFit, peaks: Floats) -> float:
    """The errors of second order to expect of the first fit, in image units.

    What it leaves of a source beyond noise, as a share of its peak, is about how far off its place
    may be in pixels.
    """
    power = np.bincount(stamps.owner, first.residual**2, peaks.size)
    count = np.bincount(stamps.owner, minlength=peaks.size)
    excess = np.maximum(power - count * stamps.noise_of(first.residual) ** 2, 0.0)
    away = np.minimum(np.sqrt(excess) / peaks, _MAX_STEP_PX)
    return tuned.BEND * float((peaks * away**2).max())


def _bend(peaks: Floats, updates: Floats, noise: PointNoise) -> float:
    """The errors of second order left by updates of the places, (k, 2), in image units.

    They are held against the noise of the bright pixels they are in.
    """
    moves = np.abs(updates).max(axis=1)
    bends = tuned.BEND * peaks * np.minimum(moves, _MAX_STEP_PX) ** 2
    return float((bends / np.sqrt(1 + noise.growth * peaks)).max())


def _prior(directions: PsfDirections, background: Background, noise_floor: float) -> Prior:
    block = np.concatenate([directions.block, np.full(background.scale.size, -1)])
    return Prior(
        block.astype(float), np.concatenate([directions.scale, background.scale]),
        np.zeros(block.size), tuned.LOG_AMPLITUDE, tuned.LOG_AMPLITUDE_STD, 1.0, noise_floor,
    )  # fmt: skip


def _linear_problem(
    stamps: Stamps, state: _State, background: Background, noise: float
) -> SourceProblem:
    """What the unknowns of all sources do to the pixels near a state; noise for unit weight."""
    directions = state.model.directions
    psf, by_x, by_y = directions.sum_with_slopes(*stamps.offsets(state.places), state.model.weights)
    columns, blur = directions.summed(
        *stamps.all_offsets(state.places), stamps.lights(state.fluxes), stamps.lit_pixel
    )
    return SourceProblem(
        own_columns(stamps, state.places, state.fluxes, (psf, by_x, by_y)),
        np.hstack([columns, background.columns]),
        stamps.value - blur,
        stamps.starts,
        background.tie(noise),
    )


def _first_state(stamps: Stamps, first: FirstFit) -> _State:
    directions = PsfDirections(first.blur)
    weights = np.zeros(directions.size)
    fluxes = first.fluxes * (1 + first.wings * directions.wings_share)
    model = PsfModel(directions, weights, weights[:, None])
    return _state_of(stamps, model, first.places, fluxes, first.backgrounds)


def _updated(
    stamps: Stamps, state: _State, background: Background, blocks: Blocks, posterior: Posterior
) -> _State:
    own = blocks.own(posterior.beta)
    size = state.model.directions.size
    change = np.clip(own[:, 0] / state.fluxes, -_MAX_FLUX_STEP, _MAX_FLUX_STEP)
    return _state_of(
        stamps,
        PsfModel(state.model.directions, posterior.beta[:size], posterior.factor[:size]),
        state.places + np.clip(own[:, [2, 1]], -_MAX_STEP_PX, _MAX_STEP_PX),
        state.fluxes * (1 + change),
        own[:, 3:] + background.common(posterior.beta[size:]),
        background.light_of_pads(posterior.beta[size:]),
    )


def _state_of(
    stamps: Stamps,
    model: PsfModel,
    places: Floats,
    fluxes: Floats,
    backgrounds: Floats,
    pads: Floats | float = 0.0,
) -> _State:
    """The state with its light and its residuals."""
    psf = model.directions.sum(*stamps.all_offsets(places), model.weights)
    residual = stamps.value - stamps.summed(fluxes, psf) - stamps.levels(places, backgrounds)
    residual -= pads
    light = fluxes[stamps.owner] * psf[: stamps.value.size]
    return _State(model, places, fluxes, backgrounds, light, residual)


def _growth(
    stamps: Stamps,
    problem: SourceProblem,
    blocks: Blocks,
    noise: PointNoise,
    prior: Prior,
    posterior: Posterior,
    light: Floats,
    state: _State,
) -> float:
    """Variance of the noise per unit of light over that of the background.

    `light` is that of the state in which the problem was posed, `state` what its solution leaves.
    """
    if noise.growth == 0:
        inflated = posterior.variance * noise.correlation.inflation
        leverage = _leverage(blocks, posterior.factor / math.sqrt(inflated), state.light)
        if not noise_grows(stamps, state.residual, state.light, leverage, prior.noise_floor):
            return 0.0
    dark = state.light < _DARK * float(state.light.max())
    if not dark.any():
        # Sources so close that no pixel shows the background alone.
        return noise.growth
    variance = max(stamps.noise_of(state.residual[dark]), prior.noise_floor) ** 2
    inflated = variance * noise.correlation.inflation
    axes = determined_directions(blocks.normal, prior, posterior.log_amplitude, inflated)
    determined = replace(problem, shared=problem.shared @ axes)

    def solved(growth: float) -> tuple[Blocks, float]:
        weight = replace(noise, growth=growth).weight(light)
        return determined.eliminated(weight), float(np.log(weight).sum())

    return likeliest_growth(solved, variance, float(light.max()))


def _leverage(blocks: Blocks, factor: Floats, light: Floats) -> Floats:
    """How much of its own noise the fit took up in every pixel; of dark ones, the sources' part.

    `factor` is that of the covariance of the shared unknowns at a noise of one.
    """
    leverage = blocks.leverage.copy()
    bright = np.flatnonzero(light > _DARK * light.max())
    shared = blocks.shared[bright] @ factor
    leverage[bright] += np.einsum("ij,ij->i", shared, shared)
    return np.asarray(np.minimum(leverage, 1.0))


def _points_fit(
    stamps: Stamps,
    state: _State,
    background: Background,
    blocks: Blocks,
    posterior: Posterior,
    noise: PointNoise,
) -> PointsFit:
    """The settled state with its standard deviations."""
    model = state.model
    std = math.sqrt(posterior.variance * noise.correlation.inflation)
    alone, shared = blocks.own_factor(std, posterior.factor)
    both = np.concatenate([alone, shared], axis=2)
    both[:, 3, alone.shape[2] :] += background.common_factor(posterior.factor[model.weights.size :])
    own_std = np.sqrt(np.einsum("kij,kij->ki", both, both))
    # A flux counts the light of the whole plane, and so depends on the PSF's volume.
    flux_shared = model.volume * shared[:, 0] + state.fluxes[:, None] * model.volume_gradient
    flux_std = np.sqrt(
        (model.volume * alone[:, 0]) ** 2 @ np.ones(alone.shape[2])
        + np.einsum("ij,ij->i", flux_shared, flux_shared)
    )
    return PointsFit(
        stamps, model, state.places, own_std[:, [2, 1]], state.fluxes * model.volume, flux_std,
        state.backgrounds, own_std[:, 3], state.light, stamps.value - state.residual,
        math.sqrt(posterior.variance), noise.growth * posterior.variance, noise.correlation,
    )  # fmt: skip
