"""The reference estimator: every straight target is one linear model.

The image of a straight target is ``dark + height * sum_k share_k R(s - position_k)`` with s the
normal distance and R the response to a unit step (`fit.profile`). R is that of the plain blurred
edge (`fit.start`) plus a free spline and a tail (`fit.spline`, `fit.prior`), whose amplitudes the
data decide (`fit.posterior`). The line's direction and, of a pulse, its width and its fall are
further unknowns of the same linear model, solved again where they have moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.fit import ground
from acutance.fit import prior as lsf_prior
from acutance.fit.band import Pixels
from acutance.fit.ground import ground_trends
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
from acutance.fit.profile import Profile
from acutance.fit.spline import CELLS, HALF_SUPPORT, combine, edge_weights
from acutance.fit.start import BlurredEdge

__all__ = ["Solution", "Solved", "solve"]

_NOISE_FLOOR = 2e-4
_SETTLED_PX = 0.01
_SETTLED_FALL = 0.003
"""A linear step this short leaves less than 1e-4 of the edge's height behind."""
_MAX_PASSES = 10
_MIN_STEEP = 20
_SIGNIFICANT = 4.0
_OUTLYING = 4.0


@dataclass(frozen=True, eq=False)
class Solved:
    """A straight target, solved.

    Attributes
    ----------
    start : BlurredEdge
        What the linear model departs from: line, blur, levels and profile as they settled.
    solution : Solution
        The last pass.
    outlier : (n,) array
        Weight of every pixel, 1 where it is no outlier.
    correlation : Correlation
        What the residuals say of the noise's correlation.
    """

    start: BlurredEdge
    solution: Solution
    outlier: Floats
    correlation: Correlation

    @property
    def model(self) -> LsfModel:
        """The LSF the coefficients make: the tail has its own closed form beside the spline."""
        return self.solution.model(self.start)

    @property
    def dark(self) -> float:
        """Level before the first step."""
        return self.start.dark + float(self.solution.posterior.beta[0])


@dataclass(frozen=True, eq=False)
class Solution:
    """One pass of the linear model at a fixed line and profile.

    Attributes
    ----------
    posterior : Posterior
        Of the coefficients: dark, the LSF's directions (the tail the last), the line's turn,
        the changes of the free step parameters, the ground's trends.
    directions : Directions
    residual, noise : (n,) arrays
        What is left of every pixel, and the noise's standard deviation there, in image units.
    transition : (n,) bool array
        Pixels within a blur's width of a step.
    side_noise : (float, float)
        Standard deviation of the noise on dark and on bright ground.
    turn_rad, turn_std_rad : float
        How the line wants to turn, and how well that is known.
    steps, steps_std : (k,) arrays
        How the free step parameters want to change, and their standard deviations.
    half_length_px : float
    roughness : float
        Noise variance the edge's raggedness adds where the image is steepest, relative to the
        rest.
    """

    posterior: Posterior
    directions: lsf_prior.Directions
    residual: Floats
    noise: Floats
    transition: NDArray[np.bool_]
    side_noise: tuple[float, float]
    turn_rad: float
    turn_std_rad: float
    steps: Floats
    steps_std: Floats
    half_length_px: float
    roughness: float

    def model(self, start: BlurredEdge) -> LsfModel:
        """The LSF that departs from the `start` of this pass."""
        inner, tail = self.directions.esf[:, :-1], self.directions.block.size
        beta, factor = self.posterior.beta, self.posterior.factor
        latent = np.vstack([inner @ factor[1:tail], factor[tail]])
        return LsfModel(start.blur, start.height, inner @ beta[1:tail], float(beta[tail]), latent)


def solve(
    pixels: Pixels, start: BlurredEdge, *, robust: bool = True, fit_width: bool = False
) -> Solved:
    """Solve the linear model until line, profile, outliers and noise have settled.

    Parameters
    ----------
    pixels : Pixels
    start : BlurredEdge
        Line, blur, levels and profile to depart from.
    robust : bool, optional
        Bound the weight of outliers.
    fit_width : bool, optional
        Whether a pulse's width is unknown (its fall always is).
    """
    outlier = np.ones(pixels.value.size)
    whiteness = Correlation(1.0, 0.0, 0.0)
    earlier: Solution | None = None
    roughness = 0.0
    for _ in range(_MAX_PASSES):
        solved = _pass(pixels, start, outlier, whiteness.inflation, earlier, roughness, fit_width)
        standard = solved.residual / solved.noise
        heavy = robust and float(np.abs(standard).max()) > _OUTLYING
        again = _reweighted(standard, solved.transition) if heavy else outlier
        found = correlation(_bounded(standard), *pixels.at, start.line.normal)
        settled = (
            abs(solved.turn_rad) * solved.half_length_px < _SETTLED_PX
            # The derivative by the width is that of the blur until there is an LSF.
            and not (fit_width and earlier is None)
            and _are_short(solved, fit_width)
            and np.max(np.abs(again - outlier)) < 0.05
            and abs(found.inflation / whiteness.inflation - 1) < 0.05
            and abs(solved.roughness - roughness) < 0.1 * (1 + roughness)
        )
        if settled:
            break
        outlier, whiteness, earlier = again, found, solved
        roughness = solved.roughness
        start = _moved(start, solved, fit_width)
    return Solved(start, solved, outlier, whiteness)


def _are_short(solved: Solution, fit_width: bool) -> bool:
    """Whether a pulse's width and fall are so near their end that the linear model serves.

    What a linear step in the width leaves behind is about its square in pixels, of a step in the
    fall a twentieth: it has to be small beside the standard deviation.
    """
    steps, stds = np.abs(solved.steps), solved.steps_std
    tolerance = np.maximum(_SETTLED_FALL, 6.0 * stds)
    if fit_width:
        tolerance[0] = max(_SETTLED_PX, math.sqrt(0.06 * stds[0]))
    return bool(np.all(steps < tolerance))


def _moved(start: BlurredEdge, solved: Solution, fit_width: bool) -> BlurredEdge:
    """The start, with the line and the profile moved to where the solution wants them."""
    if not (math.isfinite(solved.turn_rad) and np.all(np.isfinite(solved.steps))):
        raise NoEdgeError(
            "the fit of the target did not settle: its pixels do not follow one straight line; "
            "choose a region with one straight target"
        )
    # A turn that is too large for the linear model is cut: three pixels at the ends a pass.
    most = 3.0 / max(solved.half_length_px, 1.0)
    line = start.line.moved(0.0, math.degrees(float(np.clip(solved.turn_rad, -most, most))))
    if not solved.steps.size:
        return replace(start, line=line)
    width_px, fall = start.profile.positions_px[1], -start.profile.shares[1]
    if fit_width:
        # A step that is too long for the linear model is cut: half the width a pass.
        width_px += float(np.clip(solved.steps[0], -0.5 * width_px, 0.5 * width_px))
    fall += float(np.clip(solved.steps[-1], -0.5 * fall, 0.5 * fall))
    profile = Profile((0.0, width_px), (1.0, -fall))
    return replace(start, line=line, profile=profile)


def _pass(
    pixels: Pixels,
    start: BlurredEdge,
    outlier: Floats,
    inflation: float,
    earlier: Solution | None,
    roughness: float,
    fit_width: bool,
) -> Solution:
    """Solve for the LSF's departures from the start, the levels, the line and the steps."""
    line, blur, height, profile = start.line, start.blur, start.height, start.profile
    width = blur.width_px
    s = line.normal_distance(pixels.row, pixels.col)
    t = line.tangent_distance(pixels.row, pixels.col)
    seen = profile.seen(blur, s)
    mean, slope = profile.response(seen)
    departure = pixels.value - start.dark - height * mean
    variance_dark, variance_bright = side_variances(departure * np.sqrt(outlier), mean)
    floor = (_NOISE_FLOOR * height) ** 2
    scale = 0.5 * (variance_dark + variance_bright) + floor
    share = np.minimum(np.maximum(mean, 0.0), 1.0)
    relative = (variance_dark + floor + (variance_bright - variance_dark) * share) / scale
    # A ragged edge moves by fractions of a pixel from row to row: noise where the image is steep.
    steep = (slope / max(float(np.max(np.abs(slope))), 1e-12)) ** 2
    relative *= 1 + roughness * steep

    sides = profile.sides(seen, s)
    known = _known_steps(start, s, seen, earlier)
    steps = _step_columns(profile, known, fit_width)
    trends = ground_trends(sides, t)
    turn_column = t * profile.response(known)[1]
    columns = np.vstack([_beyond(profile, s, width), turn_column, steps, trends])
    stencils = []
    for distance, part in zip(profile.distances(s), profile.shares, strict=True):
        cell, basis = edge_weights(distance / width)
        stencils.append((cell, basis if part == 1 else part * basis))
    directions = lsf_prior.directions(blur)
    design = _design(directions, len(columns))
    if len(profile.shares) > 1:
        # The dark level is under every pixel once, whatever the steps.
        columns = np.vstack([columns, np.ones(s.size)])
        design = np.vstack([design, np.zeros(design.shape[1])])
        design[: CELLS + 3, 0], design[-1, 0] = 0.0, 1.0
    normal = accumulate(
        stencils, departure, outlier / relative, columns, float(np.add.reduce(outlier))
    ).combined(design)
    prior = _prior(start, directions, len(steps), len(trends))
    posterior = regress(
        normal, prior, scale, inflation, None if earlier is None else earlier.posterior
    )

    coefficients = design @ posterior.beta
    fitted = coefficients[CELLS + 3 :] @ columns
    for cell, basis in stencils:
        fitted = fitted + combine(cell, basis, coefficients[: CELLS + 3])
    noise = np.sqrt(posterior.variance * relative)
    standard = _bounded((departure - fitted) / noise)
    side_noise = np.sqrt(posterior.variance / scale * np.array([variance_dark, variance_bright]))
    turn = directions.block.size + 1
    own = slice(turn + 1, turn + 1 + len(steps))
    return Solution(
        posterior, directions, departure - fitted, noise,
        profile.near(s, width),
        (float(side_noise[0]), float(side_noise[1])),
        float(posterior.beta[turn]), _norm(posterior.factor[turn]),
        posterior.beta[own], np.array([_norm(row) for row in posterior.factor[own]]),
        float(np.max(np.abs(t))),
        _raggedness(standard, np.where(np.abs(standard) < _OUTLYING, steep, 0.0), roughness),
    )  # fmt: skip


def _raggedness(standard: Floats, steep: Floats, assumed: float) -> float:
    """How much noisier the steep pixels are than the rest, beyond what chance explains."""
    there = steep > 0.25
    count = int(np.count_nonzero(there))
    if count < _MIN_STEEP:
        return assumed
    # Per pixel, in units of the noise without raggedness.
    power = float(np.mean(standard[there] ** 2 * (1 + assumed * steep[there])))
    if assumed == 0 and power < 1 + _SIGNIFICANT * math.sqrt(2 / count):
        return 0.0
    return max((power - 1) / float(np.mean(steep[there])), 0.0)


def _beyond(profile: Profile, s: Floats, width: float) -> Floats:
    """What the tail adds beyond the spline's support, (n,)."""
    total = np.zeros(s.size)
    for distance, share in zip(profile.distances(s), profile.shares, strict=True):
        far = np.abs(distance) > HALF_SUPPORT * width
        u = distance[far] / width
        end = lsf_prior.tail_esf(np.array([-HALF_SUPPORT, HALF_SUPPORT]))
        total[far] += share * (lsf_prior.tail_esf(u) - np.where(u < 0, *end))
    return total


def _norm(row: Floats) -> float:
    """Standard deviation that a row of a factor stands for."""
    return math.sqrt(float(row @ row))


def _bounded(standard: Floats) -> Floats:
    """Residuals in standard deviations, outliers bounded."""
    return np.minimum(np.maximum(standard, -_OUTLYING), _OUTLYING)


def _known_steps(
    start: BlurredEdge,
    s: Floats,
    seen: list[tuple[Floats, Floats]],
    earlier: Solution | None,
) -> list[tuple[Floats, Floats]]:
    """Response to every step and its derivative, in image units, as far as they are known.

    How well a pulse's width is told hangs on the LSF itself, not on the blur it departs from:
    after the first pass its solution is taken.
    """
    if earlier is None:
        return [(start.height * esf, start.height * lsf) for esf, lsf in seen]
    model = earlier.model(start)
    return [
        model.step(distance, blurred)
        for distance, blurred in zip(start.profile.distances(s), seen, strict=True)
    ]


def _step_columns(profile: Profile, known: list[tuple[Floats, Floats]], fit_width: bool) -> Floats:
    """Derivatives of the mean by a pulse's width (if free) and by its fall, (k, n)."""
    if len(known) == 1:
        return np.empty((0, known[0][0].size))
    esf, lsf = known[1]
    by_width, by_fall = -profile.shares[1] * lsf, -esf
    return np.array([by_width, by_fall] if fit_width else [by_fall])


def _reweighted(standard: Floats, transition: NDArray[np.bool_]) -> Floats:
    """Weights of the pixels by their standardised residuals.

    An outlier stands out from pixels like itself. Where many depart together, as in the
    transition when the model does not yet follow the edge, nobody is one.
    """
    bulk = [robust_scale(standard[place]) for place in (transition, ~transition) if place.any()]
    return outlier_weights(standard / min(max(bulk), 1.0))


def _design(directions: lsf_prior.Directions, beside: int) -> Floats:
    """What every coefficient does to the spline and to the columns beside it.

    The dark level lifts every ESF coefficient alike, because the B-splines sum to one; the tail
    is the last direction, within the support and beyond.
    """
    last = directions.block.size
    design = np.zeros((CELLS + 3 + beside, last + beside))
    design[: CELLS + 3, 0] = 1.0
    design[: CELLS + 3, 1 : last + 1] = directions.esf
    design[CELLS + 3 :, last:] = np.eye(beside)
    return design


def _prior(start: BlurredEdge, directions: lsf_prior.Directions, steps: int, trends: int) -> Prior:
    """The prior of all coefficients: dark, mean blur, processes, tail, turn, steps, trends."""
    last = directions.block.size
    m = last + 2 + steps + trends
    block = np.full(m, -1)
    block[1 : last + 1] = np.where(directions.block >= 2, directions.block - 2, -1)
    log_amplitude = lsf_prior.LOG_AMPLITUDE
    block[last + 2 + steps :] = log_amplitude.size
    log_amplitude = np.append(log_amplitude, ground.LOG_AMPLITUDE)
    scale = np.ones(m)
    # Turn (radians) and steps (pixels, shares) are known to about one before the pixels are seen.
    scale[last + 1 : last + 2 + steps] = 1 / start.height
    aperture, aperture_std = lsf_prior.APERTURE_PX
    mean = np.zeros(m)
    where = 1 + int(np.flatnonzero(directions.block == 1)[0])
    scale[where] = aperture_std
    mean[where] = (aperture - start.blur.aperture_px) * start.height
    return Prior(
        block, scale, mean, log_amplitude, lsf_prior.LOG_AMPLITUDE_STD,
        start.height, _NOISE_FLOOR * start.height,
    )  # fmt: skip
