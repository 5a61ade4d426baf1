"""The reference estimator: every straight target is one linear model.

The image of a straight target is ``dark + height * sum_k share_k R(s - position_k)`` with s the
normal distance and R the response to a unit step (`step_profile`). R is that of the first fit
(`first_fit`) plus a free spline and a tail (`spline`, `lsf_prior`), whose amplitudes the data
determine (`marginal_likelihood`). The line's direction and, of a pulse, its width and its height
ratio are further unknowns of the same linear model (`linear_model`), solved again where they have
moved. In the last pass the LSF is one of the sensors that optics make (`among_sensors`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.numerics.noise import Correlation, correlation, outlier_weights, robust_scale
from acutance.targets.steps import Steps
from acutance.targets.straight.among_sensors import AmongSensors, among_sensors
from acutance.targets.straight.coloured_noise import ColouredNoise
from acutance.targets.straight.error_causes import FitCauses
from acutance.targets.straight.first_fit import FirstFit
from acutance.targets.straight.ground_steps import GroundSide
from acutance.targets.straight.linear_model import Linear
from acutance.targets.straight.lsf import LsfModel
from acutance.targets.straight.pixels import Pixels
from acutance.targets.straight.pixels_alone import PixelsAlone
from acutance.targets.straight.solution import OUTLYING, Solution, solved_pass
from acutance.targets.straight.step_profile import Profile
from acutance.targets.straight.tuned import MIN_SPECTRUM_PIXELS, MISFIT

__all__ = ["Solved", "solve"]

_SETTLED_PX = 0.01
_SETTLED_BEND_PX = 0.03
"""At the ends of the target, the only places where it is that much."""
_SETTLED_RATIO = 0.003
"""Updates below these: the error of linearity is less than 1e-4 of the edge's height."""
_SETTLED_NOISE = 0.2
"""Of the logarithm of the ratio of the sides' variances."""
_NEGLIGIBLE_SIGMAS = 3.0
_MAX_PASSES = 10


@dataclass(frozen=True, eq=False)
class Solved:
    """A straight target, solved.

    Attributes
    ----------
    solution : Solution
        The last pass, among sensors.
    seen : AmongSensors
        What the last pass found.
    outlier : (n,) array
        Weight of every pixel, 1 where it is no outlier.
    correlation : Correlation
        Correlation of the noise, from the residuals.
    """

    solution: Solution
    seen: AmongSensors
    outlier: Floats
    correlation: Correlation

    @property
    def random_profile(self) -> Floats:
        """What noise that correlates is taken to add to every pixel, in image units, (n,)."""
        return self.solution.likeliest_noise

    @property
    def causes(self) -> FitCauses:
        """What the uncertainty of the LSF consists of."""
        return self.solution.linear.causes(self.solution.posterior, self.seen.information)

    @property
    def pixels_alone(self) -> PixelsAlone:
        """What the pixels say of the LSF, the prior apart."""
        seen, first_fit = self.seen, self.first_fit
        return PixelsAlone(
            first_fit.blur, first_fit.height, seen.linear.lsf_columns,
            seen.alone, seen.projection, seen.linear.prior.mean[: seen.projection.size],
            seen.broad_prior,
        )  # fmt: skip

    @property
    def first_fit(self) -> FirstFit:
        """Line, blur, levels and profile about which the last linear model was made."""
        return self.solution.linear.first_fit

    @property
    def model(self) -> LsfModel:
        """The line spread function (LSF)."""
        return self.solution.model

    @property
    def ground(self) -> tuple[GroundSide, GroundSide]:
        """The ground before and behind the target."""
        return self.solution.linear.ground(self.solution.posterior)

    @property
    def dark(self) -> float:
        """Level before the first step."""
        return self.first_fit.dark + float(self.solution.posterior.beta[0])


def solve(
    pixels: Pixels, first_fit: FirstFit, *, robust: bool = True, fit_width: bool = False
) -> Steps[Solved]:
    """Solve the linear model until line, profile, outliers and noise have settled, in steps.

    Parameters
    ----------
    pixels : Pixels
    first_fit : FirstFit
        Line, blur, levels and profile to begin with.
    robust : bool, optional
        Bound the weight of outliers.
    fit_width : bool, optional
        Whether a pulse's width is unknown (its height ratio always is).
    """
    linear = Linear.about(first_fit, pixels, fit_width=fit_width)
    outlier = np.ones(pixels.value.size)
    whiteness = Correlation(1.0, 0.0, 0.0)
    coloured: ColouredNoise | None = None
    earlier: Solution | None = None
    roughness = 0.0
    for _ in range(_MAX_PASSES):
        solved = solved_pass(linear, outlier, whiteness.inflation, coloured, roughness, earlier)
        standard = solved.standard
        has_noise = first_fit.profile.is_edge or _has_settled_noise(solved, outlier)
        heavy = robust and has_noise and float(np.abs(standard).max()) > OUTLYING
        again = _reweighted(standard, linear) if heavy else outlier
        found = correlation(_bounded(standard), *pixels.at, [linear.first_fit.line.normal])
        short = _are_short(solved, fit_width)
        # The phase of rounding follows the wings, which the first fit does not have.
        is_unphased = earlier is None and linear.rounding.floor > 0
        settled = (
            short
            and not is_unphased
            # The derivative by the width is that of the first fit until there is an LSF.
            and not (fit_width and earlier is None)
            and np.max(np.abs(again - outlier)) < 0.05
            and abs(found.inflation / whiteness.inflation - 1) < 0.05
            and abs(solved.roughness - roughness) < 0.1 * (1 + roughness)
            and has_noise
        )
        if settled:
            break
        outlier, whiteness, earlier = again, found, solved
        coloured = _coloured(solved, found, pixels)
        roughness = solved.roughness
        has_moved = not (short and _is_at_rest(solved))
        if has_moved or is_unphased:
            about = _updated(solved, fit_width) if has_moved else linear.first_fit
            fitted = pixels.value - solved.residual
            linear = Linear.about(about, pixels, fit_width=fit_width, fitted=fitted)
    yield
    seen = among_sensors(
        solved.linear, solved.left, solved.equations, solved.posterior, solved.inflation
    )
    return Solved(_seen_again(solved, seen), seen, outlier, whiteness)


def _seen_again(solved: Solution, seen: AmongSensors) -> Solution:
    """The last pass, with its own unknowns."""
    linear, posterior = seen.linear, seen.posterior
    image = linear.image(solved.columns, linear.coefficients(posterior.beta))
    residual = linear.first_residual - image
    return replace(solved, linear=linear, posterior=posterior, residual=residual)


def _coloured(solved: Solution, found: Correlation, pixels: Pixels) -> ColouredNoise | None:
    """Spectra of the noise beside a target, where it is known to correlate."""
    linear, first_fit = solved.linear, solved.linear.first_fit
    bright = int(np.count_nonzero(linear.mean >= 0.5))
    sides = sorted([bright, linear.mean.size - bright])
    # A pulse may be narrow: its noise is bounded by that of the ground.
    few = sides[0 if first_fit.profile.is_edge else 1] < MIN_SPECTRUM_PIXELS
    if few or not found.by_lag or max(solved.side_noise) < MISFIT * first_fit.height:
        return None
    standard = _bounded(solved.standard)
    noise = ColouredNoise.of(standard, pixels.at, linear.mean, first_fit.line.normal)
    borders = first_fit.profile.distances(linear.s)
    scatter = noise.scatter_along(standard, borders, linear.t, first_fit.blur.width_px)
    return None if solved.roughness > 0 or scatter.is_more else noise


def _has_settled_noise(solved: Solution, outlier: Floats) -> bool:
    """Whether the sides differ in noise as assumed: what first fits leave of slopes is none."""
    found = solved.linear.noise(solved.residual, outlier, solved.roughness)
    return abs(found.log_ratio - solved.noise_log_ratio) < _SETTLED_NOISE


def _are_short(solved: Solution, fit_width: bool) -> bool:
    """Whether the updates of line and profile are short enough for the linear model.

    The error of a linear update of the width is about its square in pixels, of one of the height
    ratio a twentieth: it has to be much smaller than the standard deviation.
    """
    half_px = solved.linear.half_length_px
    if abs(solved.rotation_rad) * half_px >= _SETTLED_PX:
        return False
    if abs(solved.curvature_per_px) * half_px**2 / 2 >= _SETTLED_BEND_PX:
        return False
    updates, stds = np.abs(solved.updates), solved.updates_std
    tolerance = np.maximum(_SETTLED_RATIO, 6.0 * stds)
    if fit_width:
        tolerance[0] = max(_SETTLED_PX, math.sqrt(0.06 * stds[0]))
    return bool(np.all(updates < tolerance))


def _is_at_rest(solved: Solution) -> bool:
    """Whether the updates of line and profile are within their standard deviations."""
    still = np.abs(solved.updates) < _NEGLIGIBLE_SIGMAS * solved.updates_std
    return bool(
        abs(solved.rotation_rad) < _NEGLIGIBLE_SIGMAS * solved.rotation_std_rad
        and abs(solved.curvature_per_px) < _NEGLIGIBLE_SIGMAS * solved.curvature_std_per_px
        and np.all(still)
    )


def _updated(solved: Solution, fit_width: bool) -> FirstFit:
    """The first fit with the line and the profile of the solution."""
    first_fit = solved.linear.first_fit
    if not (math.isfinite(solved.rotation_rad) and np.all(np.isfinite(solved.updates))):
        raise NoEdgeError(
            "the fit of the target did not settle: its pixels do not follow one straight line; "
            "choose a region with one straight target"
        )
    # A rotation too large for the linear model is cut: three pixels at the ends a pass.
    most = 3.0 / max(solved.linear.half_length_px, 1.0)
    line = first_fit.line.moved(0.0, math.degrees(float(np.clip(solved.rotation_rad, -most, most))))
    line = line.bent(solved.curvature_per_px)
    if not solved.updates.size:
        return replace(first_fit, line=line)
    width_px, height_ratio = first_fit.profile.positions_px[1], -first_fit.profile.shares[1]
    if fit_width:
        # An update too large for the linear model is cut: half the width a pass.
        width_px += float(np.clip(solved.updates[0], -0.5 * width_px, 0.5 * width_px))
    half = 0.5 * height_ratio
    height_ratio += float(np.clip(solved.updates[-1], -half, half))
    profile = Profile((0.0, width_px), (1.0, -height_ratio))
    return replace(first_fit, line=line, profile=profile)


def _bounded(standard: Floats) -> Floats:
    """Residuals in standard deviations, outliers bounded."""
    return np.minimum(np.maximum(standard, -OUTLYING), OUTLYING)


def _reweighted(standard: Floats, linear: Linear) -> Floats:
    """Weights of the pixels by their standardised residuals.

    An outlier differs from pixels like itself. Where many residuals are large, as in the
    transition when the model does not yet follow the edge, no pixel is an outlier.
    """
    first_fit = linear.first_fit
    transition = first_fit.profile.near(linear.s, first_fit.blur.width_px)
    bulk = [robust_scale(standard[place]) for place in (transition, ~transition) if place.any()]
    return outlier_weights(standard / min(max(bulk), 1.0))
