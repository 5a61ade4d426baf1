"""A pulse whose values curve: an LSF of even and odd parts, and a curvature.

With u the linear image between the plateaus (0 dark, 1 bright), the values are

    v = u + c u (1 - u)

and u is linear in the line spread function (LSF), the levels, the pulse's width, its height ratio
and the ground beside it. The model is linear about one u and one c, and solved anew
where they have moved. All this depends on the distance from the line alone: pixels enter as their
means in narrow bins of it. Values are in shares of the contrast.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.marginal_likelihood import (
    Prior,
    likeliest_amplitudes,
    log_evidence,
    whiten,
)
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.first_fit import fit_first
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.ground_steps import Ground
from acutance.targets.straight.lsf_parity import LOG_AMPLITUDE_STD, LOG_AMPLITUDES, parts
from acutance.targets.straight.spline import combine, edge_and_line_weights, expand
from acutance.targets.straight.spline_equations import step_stencils
from acutance.targets.straight.step_profile import Profile, Sides, pulse_profile
from acutance.targets.straight.tuned import (
    GROUND_LOG_AMPLITUDE,
    NOISE_FLOOR,
    TREND_LOG_AMPLITUDE,
)

__all__ = [
    "AMPLITUDE_STEPS",
    "CURVATURE_STD",
    "CurvedModel",
    "MeanProfile",
    "Solved",
    "first_blur",
    "solve",
]

CURVATURE_STD: Final = 0.3
"""Prior of c: a gamma of 2.2 between 20 and 220 of 255 is .56, 1.3 between 50 and 200 .15."""
AMPLITUDE_STEPS: Final = 12
"""Of Newton's, for the amplitudes of a prior of which nothing is known yet."""
_MAX_STEP_PX: Final = 0.3
_SETTLED_AMPLITUDE: Final = 0.15
_APERTURE: Final = 3
_APERTURE_STD_PX: Final = 0.3
_NEAR_BIN, _FAR_BIN, _NEAR_WIDTHS = 0.06, 0.5, 3.0
"""Bins within so many widths of a step, and beyond: the mean over the former differs from the value
at their middle by 2e-4 at most."""


class MeanProfile(NamedTuple):
    """The pixels of a target, averaged in bins of their distance from it.

    Attributes
    ----------
    s, value, weight : (n,) arrays
        Mean distance from the first step, px, and mean value of the pixels of every bin; the
        inverse variance of that mean.
    """

    s: Floats
    value: Floats
    weight: Floats

    @classmethod
    def of(cls, data: CheckData, width_px: float) -> MeanProfile:
        """The means of the pixels in bins that follow a width, for noise as it is correlated."""
        weight = data.weights * (data.inflation / data.smoothness)
        s = data.fit.distance_px
        near = data.outside < _NEAR_WIDTHS * width_px
        size = width_px * np.where(near, _NEAR_BIN, _FAR_BIN)
        # Near and far bins of one number are different bins.
        number = 2 * np.floor((s - s.min()) / size).astype(np.intp) + near
        _, number = np.unique(number, return_inverse=True)
        total = np.bincount(number, weight)
        mean_s, mean = (np.bincount(number, weight * one) / total for one in (s, data.value))
        return cls(mean_s, mean, np.asarray(total, float))


@dataclass(frozen=True, eq=False)
class CurvedModel:
    """A pulse to first order about a Gaussian through a pixel, in shares of the contrast.

    Attributes
    ----------
    measured : MeanProfile
    blur : GaussianPixel
    profile : Profile
        The steps of the target.
    mean : (n,) array
        Response of the steps, blurred by the Gaussian through a pixel.
    design : (CELLS + 3, r) array
        Spline coefficients of the directions of the LSF.
    rows : (r + q, n) array
        Response of every bin to the unknowns other than the curvature: directions of the LSF,
        level, slopes of the plateaus, ground beside the pulse, its width and height ratio.
    block, scale : (r + q + 1,) arrays
        Of the prior; the last unknown is the curvature.
    ground : Ground
        Where its steps lie does not follow the width, which hardly moves.
    """

    measured: MeanProfile
    blur: GaussianPixel
    profile: Profile
    mean: Floats
    design: Floats
    rows: Floats
    block: NDArray[np.intp]
    scale: Floats
    ground: Ground

    @classmethod
    def about(
        cls,
        measured: MeanProfile,
        blur: GaussianPixel,
        profile: Profile,
        earlier: CurvedModel | None = None,
        beta: Floats | None = None,
    ) -> CurvedModel:
        """The model of a profile.

        The derivatives by a pulse's width and height ratio are those of an `earlier` model's
        solution `beta`, if there is one: they depend on the LSF.
        """
        s, width = measured.s, blur.width_px
        seen = profile.seen(blur, s)
        sides = profile.sides(seen, s)
        if earlier is None or beta is None:
            beside = [away / width for _, away in sides]
            ground = Ground.beside_pulse(beside, profile.positions_px[-1] / width)
            esf, lsf = seen[1]
        else:
            ground = earlier.ground
            esf, lsf = earlier.step(profile.distances(s)[1], beta)
        by_width, by_ratio = -profile.shares[1] * lsf, -esf
        lsf_parts = parts(blur)
        slopes, ground_first = LOG_AMPLITUDES.size, LOG_AMPLITUDES.size + 1
        block = np.concatenate([
            lsf_parts.block, [-1], np.full(2 * len(sides), slopes), ground_first + ground.side,
            [-1, -1, -1],
        ])  # fmt: skip
        scale = np.ones(block.size)
        scale[_APERTURE], scale[-1] = _APERTURE_STD_PX, CURVATURE_STD
        scale[block >= ground_first] = ground.scale
        splines = [expand(*stencil) for stencil in step_stencils(profile, s, width)]
        rows = np.vstack([
            lsf_parts.esf.T @ np.sum(splines, axis=0).T, np.ones(s.size), _slopes(sides),
            ground.columns, by_width, by_ratio,
        ])  # fmt: skip
        mean = profile.mean(blur, s)
        return cls(measured, blur, profile, mean, lsf_parts.esf, rows, block, scale, ground)

    def normal(self, u: Floats, c: float) -> Normal:
        """The equations of the unknowns about the linear image u, (n,), and a curvature c."""
        bend = u * (1 - u)
        slope = 1 + c * (1 - 2 * u)
        rows = np.vstack([self.rows * slope, bend])
        left = self.measured.value - u - c * bend + slope * (u - self.mean)
        weighted = rows * self.measured.weight
        data = float(np.sum(self.measured.weight * left**2))
        return Normal(weighted @ rows.T, weighted @ left, data, float(u.size))

    def step(self, s: Floats, beta: Floats) -> tuple[Floats, Floats]:
        """Response to a unit step and its derivative at distances s, (n,), of some unknowns."""
        coefficients = self.design @ beta[: self.design.shape[1]]
        cell, basis, slopes = edge_and_line_weights(s / self.blur.width_px)
        esf, lsf = self.blur.esf_and_lsf(s)
        esf = esf + combine(cell, basis, coefficients)
        lsf = lsf + combine(cell, slopes, coefficients) / self.blur.width_px
        return esf, lsf

    def renewed(self, beta: Floats) -> CurvedModel:
        """The model about the width and height ratio of some unknowns, and their LSF."""
        wider, higher = np.clip(beta[-3:-1], -_MAX_STEP_PX, _MAX_STEP_PX).tolist()
        width_px, ratio = self.profile.positions_px[1], -self.profile.shares[1]
        profile = pulse_profile(width_px + wider, ratio + higher)
        return CurvedModel.about(self.measured, self.blur, profile, self, beta)

    def response(self, beta: Floats) -> Floats:
        """The linear image of the unknowns, (n,)."""
        return np.asarray(self.mean + beta[:-1] @ self.rows)


def first_blur(data: CheckData, profile: Profile) -> GaussianPixel:
    """The Gaussian through a pixel that fits the target best."""
    if isinstance(data.fit, SplineEdge):
        return data.fit.blur
    pixels = data.trimmed.pixels
    return fit_first(
        pixels.row, pixels.col, data.value, data.fit.line, dark=0.0, bright=1.0,
        sigma_px=data.trimmed.width_px, noise=data.noise, profile=profile,
    ).blur  # fmt: skip


def _slopes(sides: Sides) -> Floats:
    """A slope and its square on either side, (4, n), each 1 at the farthest pixel."""
    modes = []
    for share, outwards in sides:
        away = np.maximum(outwards, 0.0)
        away /= max(float(away.max()), 1e-9)
        modes += [share * away, share * away**2]
    return np.stack(modes)


@dataclass(frozen=True, eq=False)
class Solved:
    """Some unknowns of a model.

    Attributes
    ----------
    beta : (m,) array
        Their means, 0 for the unknowns left out.
    last_std : float
        Standard deviation of the curvature, if it is one of them.
    log_amplitude : (k,) array
        Amplitudes of the prior, with which the next solution begins.
    normal : Normal
        The equations of the unknowns that are not left out.
    prior : Prior
    """

    beta: Floats
    last_std: float
    log_amplitude: Floats
    normal: Normal
    prior: Prior

    @cached_property
    def log_evidence(self) -> float:
        """Log evidence of the model, up to what all models of these pixels have in common."""
        return log_evidence(self.normal, self.prior, self.log_amplitude, 1.0)


def solve(
    normal: Normal,
    linear: CurvedModel,
    free: NDArray[np.bool_],
    c: float,
    earlier: Solved | None = None,
    most: int = AMPLITUDE_STEPS,
) -> Solved:
    """Solve for the free unknowns, the last being added to c, and the prior's amplitudes.

    Beginning with the amplitudes of an `earlier` solution, at `most` so many Newton steps.
    """
    mean = np.zeros(free.size)
    mean[-1] = -c
    walks = [GROUND_LOG_AMPLITUDE] * linear.ground.walks
    amplitudes = [*LOG_AMPLITUDES, TREND_LOG_AMPLITUDE, *walks]
    prior = Prior(
        linear.block[free].astype(float), linear.scale[free], mean[free],
        np.array(amplitudes), LOG_AMPLITUDE_STD, 1.0, NOISE_FLOOR,
    )  # fmt: skip
    some = Normal(
        normal.gram[np.ix_(free, free)], normal.projection[free], normal.data, normal.count
    )
    log_amplitude = likeliest_amplitudes(
        some, prior, prior.log_amplitude if earlier is None else earlier.log_amplitude, 1.0,
        tolerance=_SETTLED_AMPLITUDE, most=most,
    )  # fmt: skip
    white = whiten(some, prior, log_amplitude, 1.0)
    beta = np.zeros(free.size)
    beta[free] = white.sigma * white.mean
    last_std = float(white.sigma[-1] * math.sqrt(white.variances[-1]))
    return Solved(beta, last_std, log_amplitude, some, prior)
