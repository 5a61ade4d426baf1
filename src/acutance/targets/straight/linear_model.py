"""A straight target to first order about a start: all its unknowns in one linear model.

Unknown are the dark level, the LSF's departure from the plain blur (`fit.prior`), the trends of
the ground (`fit.ground`), the line's turn and, of a pulse, its width (if free) and its fall, in
this order. What the pixels say of them hangs on the start alone, but for the columns of turn, width
and fall: they are derivatives of the response, and follow the LSF as it becomes known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.lorentz_tail import tail_esf
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.numerics.noise import side_variances
from acutance.targets.straight import lsf_prior
from acutance.targets.straight.first_fit import FirstFit
from acutance.targets.straight.gradients import plateau_trends
from acutance.targets.straight.lsf import LsfModel
from acutance.targets.straight.pixels import Pixels
from acutance.targets.straight.spline import CELLS, HALF_SUPPORT, combine, edge_weights
from acutance.targets.straight.spline_equations import Stencil
from acutance.targets.straight.step_profile import Profile
from acutance.targets.straight.tuned import (
    APERTURE_PX,
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
    TAIL_WIDTH,
    TREND_LOG_AMPLITUDE,
)

__all__ = ["Linear", "NoiseModel"]

_NOISE_FLOOR = 2e-4


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """How the noise varies over the pixels, before its level is fitted.

    Attributes
    ----------
    sides : (2,) array
        Variance on dark and on bright ground, relative to `scale`.
    scale : float
        Their mean, in image units squared.
    relative : (n,) array
        Variance of every pixel, relative to `scale`.
    """

    sides: Floats
    scale: float
    relative: Floats


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear model of a target's pixels about a start.

    Attributes
    ----------
    start : FirstFit
        Line, blur, levels and profile the model departs from.
    s, t : (n,) arrays
        Distance of the pixels from the first step along the normal, and along the line.
    seen : pairs of (n,) arrays
        For every step, the plain blur's ESF and LSF at the pixels.
    mean, slope : (n,) arrays
        Response of the start (0 dark, 1 bright) and its derivative.
    departure : (n,) array
        The pixels less what the start makes of them.
    stencils : pairs of arrays
        For every step, each pixel's place in the ESF's spline; see `spline.edge_weights`.
    fixed : (q, n) array
        Regressors beside the spline that hang on the start alone.
    derivatives : int
        Number of those that hang on the LSF: turn, width, fall.
    directions : Directions
        In which the LSF may depart from the blur.
    design : (CELLS + 3 + k, r) array
        What level, directions and tail do to the spline and to the first k of the regressors beside
        it. Every other regressor has an unknown of its own.
    prior : Prior
    """

    start: FirstFit
    s: Floats
    t: Floats
    seen: list[tuple[Floats, Floats]]
    mean: Floats
    slope: Floats
    departure: Floats
    stencils: list[Stencil]
    fixed: Floats
    derivatives: int
    directions: lsf_prior.Directions
    design: Floats
    prior: Prior

    @classmethod
    def about(cls, start: FirstFit, pixels: Pixels, *, fit_width: bool) -> Linear:
        """The model about a `start`, of a width that is free or held."""
        profile, width = start.profile, start.blur.width_px
        s = start.line.normal_distance(pixels.row, pixels.col)
        t = start.line.tangent_distance(pixels.row, pixels.col)
        seen = profile.seen(start.blur, s)
        mean, slope = profile.response(seen)
        stencils = []
        for distance, share in zip(profile.distances(s), profile.shares, strict=True):
            cell, basis = edge_weights(distance / width)
            stencils.append((cell, basis if share == 1 else share * basis))
        trends = plateau_trends(profile.sides(seen, s), t)
        beside = [_beyond(profile, s, width)]
        is_edge = len(profile.shares) == 1
        if not is_edge:
            # The dark level is under every pixel once, whatever the steps.
            beside.append(np.ones(s.size))
        derivatives = 1 if is_edge else 2 + fit_width
        directions = lsf_prior.directions(start.blur)
        departure = pixels.value - start.dark - start.height * mean
        # A bad pixel pulls by no more than a whole height.
        np.clip(departure, -start.height, start.height, out=departure)
        return cls(
            start, s, t, seen, mean, slope, departure,
            stencils, np.vstack([*beside, trends]), derivatives, directions,
            _design(directions, len(beside)),
            _prior(start, directions, len(trends), derivatives),
        )  # fmt: skip

    @property
    def half_length_px(self) -> float:
        """How far the pixels reach along the line."""
        return float(np.max(np.abs(self.t)))

    @property
    def steepness(self) -> Floats:
        """Squared slope of the start's image relative to the largest, (n,)."""
        steep: Floats = self.slope / max(float(np.max(np.abs(self.slope))), 1e-12)
        return steep * steep

    def noise(self, outlier: Floats, roughness: float) -> NoiseModel:
        """The noise as the pixels' departures show it, outliers weighed by `outlier`.

        A ragged edge moves by fractions of a pixel from row to row: `roughness` is the noise
        variance this adds where the image is steepest, relative to the rest.
        """
        sides = np.array(side_variances(self.departure * np.sqrt(outlier), self.mean))
        floor = (_NOISE_FLOOR * self.start.height) ** 2
        scale = float(0.5 * (sides[0] + sides[1])) + floor
        share = np.minimum(np.maximum(self.mean, 0.0), 1.0)
        relative = (sides[0] + floor + (sides[1] - sides[0]) * share) / scale
        if roughness > 0:
            relative *= 1 + roughness * self.steepness
        return NoiseModel(sides / scale, scale, relative)

    def columns(self, model: LsfModel | None) -> Floats:
        """All regressors beside the spline, those that hang on the LSF at the end.

        How well a pulse's width is told hangs on the LSF itself, not on the blur it departs from:
        as soon as there is a `model` of it, its derivatives are taken.
        """
        profile, height = self.start.profile, self.start.height
        if model is None:
            known = [(height * esf, height * lsf) for esf, lsf in self.seen]
        else:
            known = [
                model.step(distance, blurred)
                for distance, blurred in zip(profile.distances(self.s), self.seen, strict=True)
            ]
        _, slope = profile.response(known)
        by_parameter = [self.t * slope]
        if len(known) > 1:
            esf, lsf = known[1]
            by_parameter += [-profile.shares[1] * lsf, -esf][-(self.derivatives - 1) :]
        return np.vstack([self.fixed, *by_parameter])

    def image(self, columns: Floats, beta: Floats) -> Floats:
        """What the unknowns make of the pixels, beside the start, (n,)."""
        r = self.design.shape[1]
        coefficients = self.design @ beta[:r]
        beside = np.concatenate([coefficients[CELLS + 3 :], beta[r:]])
        image = beside @ columns
        for cell, basis in self.stencils:
            image = image + combine(cell, basis, coefficients[: CELLS + 3])
        return image

    def model(self, posterior: Posterior) -> LsfModel:
        """The LSF the unknowns make: the tail has its own closed form beside the spline."""
        inner, tail = self.directions.esf[:, :-1], self.directions.block.size
        beta, factor = posterior.beta, posterior.factor
        latent = np.vstack([inner @ factor[1:tail], factor[tail]])
        spline = inner @ beta[1:tail]
        return LsfModel(self.start.blur, self.start.height, spline, float(beta[tail]), latent)


def _beyond(profile: Profile, s: Floats, width: float) -> Floats:
    """What the tail adds beyond the spline's support, (n,)."""
    total = np.zeros(s.size)
    for distance, share in zip(profile.distances(s), profile.shares, strict=True):
        far = np.abs(distance) > HALF_SUPPORT * width
        u = distance[far] / width
        end = tail_esf(np.array([-HALF_SUPPORT, HALF_SUPPORT]), TAIL_WIDTH)
        total[far] += share * (tail_esf(u, TAIL_WIDTH) - np.where(u < 0, *end))
    return total


def _design(directions: lsf_prior.Directions, beside: int) -> Floats:
    """What level, directions and tail do to the spline and to the regressors beside it.

    The tail is the last direction, within the support and beyond: the first regressor. The dark
    level lifts every ESF coefficient alike, because the B-splines sum to one, unless it has a
    regressor of its own: the second.
    """
    design = np.zeros((CELLS + 3 + beside, 1 + directions.block.size))
    design[: CELLS + 3, 1:] = directions.esf
    design[CELLS + 3, -1] = 1.0
    if beside > 1:
        design[CELLS + 4, 0] = 1.0
    else:
        design[: CELLS + 3, 0] = 1.0
    return design


def _prior(
    start: FirstFit, directions: lsf_prior.Directions, trends: int, derivatives: int
) -> Prior:
    """The prior of all unknowns."""
    after_tail = 1 + directions.block.size
    m = after_tail + trends + derivatives
    block = np.full(m, -1)
    block[1:after_tail] = np.where(directions.block >= 2, directions.block - 2, -1)
    log_amplitude = LOG_AMPLITUDE
    block[after_tail : after_tail + trends] = log_amplitude.size
    log_amplitude = np.append(log_amplitude, TREND_LOG_AMPLITUDE)
    scale = np.ones(m)
    # Turn (radians), width (pixels) and fall are known to about one before the pixels are seen.
    scale[-derivatives:] = 1 / start.height
    aperture, aperture_std = APERTURE_PX
    mean = np.zeros(m)
    where = 1 + int(np.flatnonzero(directions.block == 1)[0])
    scale[where] = aperture_std
    mean[where] = (aperture - start.blur.aperture_px) * start.height
    return Prior(
        block, scale, mean, log_amplitude, LOG_AMPLITUDE_STD,
        start.height, _NOISE_FLOOR * start.height,
    )  # fmt: skip
