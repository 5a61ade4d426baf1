"""A straight target to first order about a first fit: all its unknowns in one linear model.

Unknown are the dark level, the correction of the line spread function (LSF) of the first fit
(`lsf_prior`), the trends of the plateaus (`gradients`) and the ground beside them (`ground_steps`),
rotation and curvature of the line and, of a pulse, its width (if free) and its height ratio
(falling over rising side), in this order. The regressors depend on the first fit alone, but for
those of line, width and height ratio: they are derivatives of the response, and depend on the LSF.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.lorentz_tail import tail_step
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.numerics.noise import side_variances
from acutance.targets.straight import lsf_prior
from acutance.targets.straight.error_causes import FitCauses
from acutance.targets.straight.first_fit import FirstFit
from acutance.targets.straight.gradients import ground_tilts, plateau_trends
from acutance.targets.straight.ground_steps import Ground, GroundSide
from acutance.targets.straight.lsf import LsfModel
from acutance.targets.straight.model_prior import GROUND_BLOCK, model_prior
from acutance.targets.straight.pixels import Pixels
from acutance.targets.straight.rounding import Rounding, rounding_of
from acutance.targets.straight.spline import CELLS, HALF_SUPPORT, combine
from acutance.targets.straight.spline_equations import Stencil, step_stencils
from acutance.targets.straight.tuned import (
    CURVATURE_STD_PER_PX,
    NOISE_FLOOR,
    TAIL_WIDTH,
)

__all__ = ["Linear", "NoiseModel"]


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """How the noise varies over the pixels, before its level is fitted.

    Attributes
    ----------
    sides : (2,) array
        Variance on the dark and on the bright plateau, relative to `scale`.
    scale : float
        Their mean, in image units squared.
    relative : (n,) array
        Variance of every pixel, relative to `scale`.
    log_ratio : float
        Logarithm of the variance of the bright plateau over that of the dark one.
    """

    sides: Floats
    scale: float
    relative: Floats
    log_ratio: float


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear model of a target's pixels about a first fit.

    Attributes
    ----------
    first_fit : FirstFit
        Line, blur, levels and profile about which the model is linear.
    s, t : (n,) arrays
        Distance of the pixels from the first step along the normal, and along the line.
    seen : pairs of (n,) arrays
        For every step, the edge spread function (ESF) and the LSF of the first fit at the pixels.
    mean, slope : (n,) arrays
        Response of the first fit (0 dark, 1 bright) and its derivative.
    first_residual : (n,) array
        The pixels minus the first fit, in image units.
    stencils : pairs of arrays
        For every step, each pixel's place in the ESF's spline; see `spline.edge_weights`.
    fixed : list of (q, n) arrays
        Regressors other than the spline that depend on the first fit alone.
    derivatives : int
        Number of those that depend on the LSF: rotation, curvature, width, height ratio.
    directions : Directions
        In which the LSF may differ from that of the first fit.
    design : (CELLS + 3 + k, r) array
        Coefficients of the spline and of the first k further regressors for a unit of level,
        directions and tail. Every other regressor has an unknown of its own.
    prior : Prior
    rounding : Rounding
        Of the image's numbers; its modes are the last of the fixed regressors.
    """

    first_fit: FirstFit
    s: Floats
    t: Floats
    seen: list[tuple[Floats, Floats]]
    mean: Floats
    slope: Floats
    first_residual: Floats
    stencils: list[Stencil]
    fixed: list[Floats]
    derivatives: int
    directions: lsf_prior.Directions
    design: Floats
    prior: Prior
    rounding: Rounding

    @classmethod
    def about(
        cls,
        first_fit: FirstFit,
        pixels: Pixels,
        *,
        fit_width: bool,
        fitted: Floats | None = None,
    ) -> Linear:
        """The model about a first fit, of a width that is free or held.

        `fitted` is the image of an earlier solution, (n,), by which rounding is judged; without it
        that of the first fit.
        """
        profile, width = first_fit.profile, first_fit.blur.width_px
        s, t = first_fit.line.distances(pixels.row, pixels.col)
        seen = profile.seen(first_fit.blur, s)
        mean, slope = profile.response(seen)
        sides, is_edge = profile.sides(seen, s), profile.is_edge
        trends = plateau_trends(sides, t)
        beside = [away / width for _, away in sides]
        if is_edge:
            ground = Ground.beside_edge(beside)
        else:
            ground = Ground.beside_pulse(beside, profile.positions_px[-1] / width)
        further = _beyond(s, profile.steps, width)[None]
        if not is_edge:
            # The dark level adds to every pixel once, whatever the steps.
            further = np.vstack([further, np.ones(s.size)])
        derivatives = 2 if is_edge else 3 + fit_width
        directions = lsf_prior.directions(first_fit.blur)
        height, image = first_fit.height, first_fit.dark + first_fit.height * mean
        # A bad pixel counts with no more than a whole height.
        residual = np.minimum(np.maximum(pixels.value - image, -height), height)
        rounding = _rounding(first_fit, pixels, s, image if fitted is None else fitted)
        fixed = [further, trends, ground.columns]
        if rounding.std.size:
            fixed.append(rounding.modes)
        free_std = [rounding.std]
        if not is_edge:
            fixed.append(ground_tilts(sides, t))
            free_std.append(np.full(len(fixed[-1]), height))
        # Rotation (radians), width (pixels) and height ratio are known to about one.
        by_parameter = [1.0, CURVATURE_STD_PER_PX, *[1.0] * (derivatives - 2)]
        prior = model_prior(
            first_fit.blur, height, directions, ground, len(trends),
            np.concatenate([*free_std, by_parameter]), rounding.floor,
        )  # fmt: skip
        return cls(
            first_fit, s, t, seen, mean, slope, residual,
            step_stencils(profile, s, width), fixed, derivatives,
            directions, _design(directions, ground, len(further)),
            prior, rounding,
        )  # fmt: skip

    @property
    def half_length_px(self) -> float:
        """How far the pixels reach along the line."""
        return float(np.max(np.abs(self.t)))

    @property
    def steepness(self) -> Floats:
        """Squared slope of the first fit relative to the largest, (n,)."""
        steep: Floats = self.slope / max(float(np.max(np.abs(self.slope))), 1e-12)
        return steep * steep

    def noise(self, residual: Floats, outlier: Floats, roughness: float) -> NoiseModel:
        """The noise of residuals, outliers weighted by `outlier`.

        A rough edge moves by fractions of a pixel from row to row: `roughness` is the noise
        variance this adds where the image is steepest, relative to the rest.
        """
        sides = np.array(side_variances(residual * np.sqrt(outlier), self.mean))
        sides = np.maximum(sides, self.rounding.floor**2)
        floor = (NOISE_FLOOR * self.first_fit.height) ** 2
        scale = float(0.5 * (sides[0] + sides[1])) + floor
        both = (sides + floor) / scale
        relative = self.over_pixels(both)
        if roughness > 0:
            relative *= 1 + roughness * self.steepness
        return NoiseModel(sides / scale, scale, relative, math.log(both[1] / both[0]))

    def over_pixels(self, sides: Floats) -> Floats:
        """Variance of the noise of every pixel, (n,), from that on the two plateaus, (2,)."""
        return _between_levels(self.mean, float(sides[0]), float(sides[1]))

    def columns(self, model: LsfModel | None) -> list[Floats]:
        """All regressors other than the spline, those that depend on the LSF in the last array.

        The uncertainty of a pulse's width depends on the LSF itself, not on the first fit: as soon
        as there is a `model` of it, its derivatives are taken.
        """
        profile, height = self.first_fit.profile, self.first_fit.height
        if model is None:
            known = [(height * esf, height * lsf) for esf, lsf in self.seen]
        else:
            known = [
                model.step(distance, blurred)
                for distance, blurred in zip(profile.distances(self.s), self.seen, strict=True)
            ]
        _, slope = profile.response(known)
        # A line bent towards the bright side leaves its pixels nearer to the dark one.
        by_parameter = [self.t * slope, -0.5 * self.t**2 * slope]
        if len(known) > 1:
            esf, lsf = known[1]
            by_parameter += [-profile.shares[1] * lsf, -esf][-(self.derivatives - 2) :]
        return [*self.fixed, np.stack(by_parameter)]

    def coefficients(self, beta: Floats) -> Floats:
        """Coefficients of spline and regressors of the unknowns."""
        r = self.design.shape[1]
        return np.concatenate([self.design @ beta[:r], beta[r:]])

    def image(self, columns: Sequence[Floats], coefficients: Floats) -> Floats:
        """The image of coefficients, to be added to the first fit, (n,)."""
        further = coefficients[CELLS + 3 :]
        image, *others = (combine(*own, coefficients[: CELLS + 3]) for own in self.stencils)
        for other in others:
            image += other
        first = 0
        for some in columns:
            image += further[first : first + len(some)] @ some
            first += len(some)
        return image

    def model(self, posterior: Posterior) -> LsfModel:
        """The LSF of the unknowns: the tail is added to the spline in closed form."""
        esf, tail, block = self.directions
        factor = self.latent(posterior)[: block.size]
        latent = np.empty((len(esf) + 1, factor.shape[1]))
        latent[:-1], latent[-1] = esf @ factor, tail @ factor
        return replace(self.mean_model(posterior), latent=latent)

    def mean_model(self, posterior: Posterior) -> LsfModel:
        """The same as if it were known exactly."""
        esf, tail, block = self.directions
        beta, exact = posterior.beta[1 : 1 + block.size], np.zeros((len(esf) + 1, 0))
        return LsfModel(
            self.first_fit.blur, self.first_fit.height, esf @ beta, float(tail @ beta), exact
        )

    def latent(self, posterior: Posterior) -> Floats:
        """Factor of the covariance of the unknowns of the LSF, then of line and profile, (k, k).

        In no more latent variables than these unknowns need, of all that the posterior has.
        """
        own = slice(1, 1 + self.directions.block.size)
        factor = posterior.factor
        rows = np.concatenate([factor[own], factor[-self.derivatives :]])
        return np.asarray(np.linalg.qr(rows.T, mode="r")).T

    @property
    def lsf_columns(self) -> Floats:
        """Spline and tail of the LSF by its unknowns, (CELLS + 4, n); the first is the dark level,
        which is no part of it."""
        esf, tail, block = self.directions
        design = np.zeros((esf.shape[0] + 1, 1 + block.size))
        design[:-1, 1:], design[-1, 1:] = esf, tail
        return design

    def causes(self, posterior: Posterior, information: Floats) -> FitCauses:
        """What the uncertainty of the LSF consists of.

        `information` is what pixels say of level and LSF where all other unknowns are known.
        """
        design = self.lsf_columns
        n = design.shape[1]
        background = posterior.beta.size - n - self.derivatives
        width = ("pulse_width",) * (self.derivatives - 3)
        height_ratio = ("background",) * (self.derivatives > 2)
        group = ("background",) * background + ("line", "line", *width, *height_ratio)
        return FitCauses(design, posterior.factor[:n], information, group)

    def ground(self, posterior: Posterior) -> tuple[GroundSide, GroundSide]:
        """The ground before and behind the target, as shares of its first step's height."""
        height, width = self.first_fit.height, self.first_fit.blur.width_px
        sides = [
            GroundSide.of(posterior.beta[own] / height, posterior.factor[own] / height, width)
            for own in (self.prior.block == GROUND_BLOCK + number for number in (0, 1))
        ]
        return sides[0], sides[1]


@compiled
def _between_levels(response: Floats, dark: float, bright: float) -> Floats:
    """What rises from the dark plateau to the bright one with the response (0 dark, 1 bright)."""
    found = np.empty(response.size)
    for k in range(response.size):
        found[k] = dark + (bright - dark) * min(max(response[k], 0.0), 1.0)
    return found


@compiled
def _beyond(s: Floats, steps: Floats, width: float) -> Floats:
    """The part of the tail beyond the spline's support, of all steps of a profile, (n,)."""
    low, high = tail_step(-HALF_SUPPORT, TAIL_WIDTH)[0], tail_step(HALF_SUPPORT, TAIL_WIDTH)[0]
    total = np.zeros(s.size)
    for step in range(steps.shape[1]):
        for k in range(s.size):
            u = (s[k] - steps[0, step]) / width
            if abs(u) > HALF_SUPPORT:
                end = low if u < 0 else high
                total[k] += steps[1, step] * (tail_step(u, TAIL_WIDTH)[0] - end)
    return total


def _design(directions: lsf_prior.Directions, ground: Ground, further: int) -> Floats:
    """Coefficients of spline and further regressors for a unit of level, directions and ground.

    A tail is part of the spline within the support, and the first regressor beyond. The dark level
    lifts all ESF coefficients equally, because the B-splines sum to one, unless it has a
    regressor of its own: the second.
    """
    after = 1 + directions.block.size
    design = np.zeros((CELLS + 3 + further, after + ground.spline.shape[1]))
    design[: CELLS + 3, 1:after] = directions.esf
    design[: CELLS + 3, 1:after] += np.outer(lsf_prior.tail_spline(), directions.tail)
    design[CELLS + 3, 1:after] = directions.tail
    design[: CELLS + 3, after:] = ground.spline
    if further > 1:
        design[CELLS + 4, 0] = 1.0
    else:
        design[: CELLS + 3, 0] = 1.0
    return design


def _rounding(first_fit: FirstFit, pixels: Pixels, s: Floats, fitted: Floats) -> Rounding:
    """Rounding of the pixels: of the plateaus before, between and behind the steps."""
    ends = [-np.inf, *first_fit.profile.positions_px, np.inf]
    groups = [(s >= start) & (s < stop) for start, stop in pairwise(ends)]
    share = (fitted - first_fit.dark) / first_fit.height
    dark, bright = side_variances(pixels.value - fitted, share)
    variances = np.array([dark, bright, dark])[: len(groups)]
    return rounding_of(
        pixels.value, fitted, first_fit.profile.outside(s), groups, first_fit.height, variances
    )
