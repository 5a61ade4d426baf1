"""A straight target whose values curve: an LSF of even and odd parts, and a curvature.

With u the linear image between the plateaus (0 dark, 1 bright), the values are

    v = u + c u (1 - u)

and u is linear in the line spread function (LSF), the levels and the line. The model is linear
about one u and one c, and solved anew where they have moved. Values are in shares of the contrast.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.marginal_likelihood import Prior, log_evidence, log_evidence_slopes, whiten
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.first_fit import fit_first
from acutance.targets.straight.gradients import plateau_trends
from acutance.targets.straight.lsf_parity import LOG_AMPLITUDE_STD, LOG_AMPLITUDES, parts
from acutance.targets.straight.spline import combine, edge_and_line_weights
from acutance.targets.straight.spline_equations import Stencil, accumulate, step_stencils
from acutance.targets.straight.step_profile import Profile, pulse_profile
from acutance.targets.straight.tuned import NOISE_FLOOR, TREND_LOG_AMPLITUDE

__all__ = ["CURVATURE_STD", "CurvedModel", "Solved", "solve"]

CURVATURE_STD: Final = 0.3
"""Prior of c: a gamma of 2.2 between 20 and 220 of 255 is .56, 1.3 between 50 and 200 .15."""
_MAX_STEP_PX: Final = 0.3
_AMPLITUDE_STEPS: Final = 12
_SETTLED_AMPLITUDE: Final = 0.05
_APERTURE: Final = 3
_APERTURE_STD_PX: Final = 0.3


@dataclass(frozen=True, eq=False)
class CurvedModel:
    """A straight target to first order about a Gaussian through a pixel, in shares of the contrast.

    Attributes
    ----------
    value : (n,) array
        The pixels.
    blur : GaussianPixel
    profile : Profile
        Of the first fit.
    mean : (n,) array
        Response of the first fit.
    stencils : pairs of arrays
        For every step, each pixel's place in the ESF's spline.
    columns : (q, n) array
        Further regressors: level, trends of the plateaus, rotation, and a pulse's steps.
    design : (CELLS + 3, r) array
        Spline coefficients of the directions of the LSF.
    odd : (r + q,) bool array
        Which unknowns make the LSF odd.
    block, scale : (r + q + 1,) arrays
        Of the prior; the last unknown is the curvature.
    """

    value: Floats
    blur: GaussianPixel
    profile: Profile
    mean: Floats
    stencils: list[Stencil]
    columns: Floats
    design: Floats
    odd: NDArray[np.bool_]
    block: NDArray[np.intp]
    scale: Floats

    @classmethod
    def about(
        cls,
        data: CheckData,
        profile: Profile,
        c: float,
        earlier: CurvedModel | None = None,
        beta: Floats | None = None,
    ) -> CurvedModel:
        """The model of the pixels without a curvature c.

        The derivatives by a pulse's width and height ratio are those of an `earlier` solution
        `beta`, if there is one: they depend on the LSF.
        """
        fit, pixels = data.fit, data.trimmed.pixels
        straight = _straightened(data.value, c)
        steps = len(profile.shares) - 1
        first = fit_first(
            pixels.row, pixels.col, straight, fit.line, dark=0.0, bright=1.0,
            sigma_px=data.trimmed.width_px, noise=data.noise, profile=profile,
        )  # fmt: skip
        s = first.line.normal_distance(pixels.row, pixels.col)
        t = first.line.tangent_distance(pixels.row, pixels.col)
        seen = first.profile.seen(first.blur, s)
        response, slope = first.profile.response(seen)
        stencils = step_stencils(first.profile, s, first.blur.width_px)
        trends = plateau_trends(first.profile.sides(seen, s), t)
        columns = [np.ones((1, s.size)), trends, (t * slope)[None]]
        if steps:
            esf, lsf = seen[1]
            if earlier is not None and beta is not None:
                esf, lsf = earlier.step(first.profile.distances(s)[1], beta)
            columns.append(np.stack([-first.profile.shares[1] * lsf, -esf]))
        further = np.vstack(columns)
        lsf_parts = parts(first.blur)
        blocks = LOG_AMPLITUDES.size
        block = np.concatenate(
            [lsf_parts.block, [-1], np.full(len(trends), blocks), np.full(2 + 2 * steps, -1)]
        )
        scale = np.ones(block.size)
        scale[_APERTURE] = _APERTURE_STD_PX
        scale[-1] = CURVATURE_STD
        odd = np.append(lsf_parts.odd, np.full(len(further), False))
        return cls(
            data.value, first.blur, first.profile, first.dark + first.height * response, stencils,
            further, lsf_parts.esf, odd, block, scale,
        )  # fmt: skip

    def normal(self, weight: Floats, u: Floats, c: float) -> Normal:
        """The equations of the unknowns about the linear image u, (n,), and a curvature c."""
        bend = u * (1 - u)
        slope = 1 + c * (1 - 2 * u)
        stencils = [(cell, basis * slope) for cell, basis in self.stencils]
        columns = np.vstack([self.columns * slope, bend])
        left = self.value - u - c * bend + slope * (u - self.mean)
        return accumulate(stencils, left, weight, columns, u.size).combined(self.design)

    def step(self, s: Floats, beta: Floats) -> tuple[Floats, Floats]:
        """Response to a unit step and its derivative at distances s, (n,), of some unknowns."""
        coefficients = self.design @ beta[: self.design.shape[1]]
        cell, basis, slopes = edge_and_line_weights(s / self.blur.width_px)
        esf, lsf = self.blur.esf_and_lsf(s)
        esf = esf + combine(cell, basis, coefficients)
        lsf = lsf + combine(cell, slopes, coefficients) / self.blur.width_px
        return esf, lsf

    def profile_of(self, beta: Floats) -> Profile:
        """The profile with a pulse's width and height ratio moved by some unknowns."""
        if len(self.profile.shares) == 1:
            return self.profile
        wider, higher = np.clip(beta[-3:-1], -_MAX_STEP_PX, _MAX_STEP_PX).tolist()
        width_px, ratio = self.profile.positions_px[1], -self.profile.shares[1]
        return pulse_profile(width_px + wider, ratio + higher)

    def response(self, beta: Floats) -> Floats:
        """The linear image of the unknowns, (n,)."""
        r = self.design.shape[1]
        image = self.mean + beta[r:-1] @ self.columns
        coefficients = self.design @ beta[:r]
        for cell, basis in self.stencils:
            image += combine(cell, basis, coefficients)
        return np.asarray(image)


def _straightened(value: Floats, c: float) -> Floats:
    """The linear image of values of curvature c, (n,)."""
    # Values far beyond the plateaus have no place on the parabola: its vertex stands for them.
    root = np.sqrt(np.maximum((1 + c) ** 2 - 4 * c * value, 1e-4))
    return np.asarray(2 * value / (1 + c + root))


class Solved(NamedTuple):
    """Some unknowns of a model: all their means (0 for the others), and the log evidence."""

    beta: Floats
    last_std: float
    log_evidence: float


def solve(normal: Normal, linear: CurvedModel, free: NDArray[np.bool_], c: float) -> Solved:
    """Solve for the free unknowns, the last being added to c, and the prior's amplitudes."""
    mean = np.zeros(free.size)
    mean[-1] = -c
    prior = Prior(
        linear.block[free].astype(float), linear.scale[free], mean[free],
        np.append(LOG_AMPLITUDES, TREND_LOG_AMPLITUDE), LOG_AMPLITUDE_STD, 1.0, NOISE_FLOOR,
    )  # fmt: skip
    some = Normal(
        normal.gram[np.ix_(free, free)], normal.projection[free], normal.data, normal.count
    )
    log_amplitude = prior.log_amplitude
    for _ in range(_AMPLITUDE_STEPS):
        white = whiten(some, prior, log_amplitude, 1.0)
        step = log_evidence_slopes(white, prior, log_amplitude).step()
        log_amplitude = log_amplitude + step
        if float(np.abs(step).max()) < _SETTLED_AMPLITUDE:
            break
    white = whiten(some, prior, log_amplitude, 1.0)
    beta = np.zeros(free.size)
    beta[free] = white.sigma * white.mean
    last_std = float(white.sigma[-1] * math.sqrt(white.variances[-1]))
    return Solved(beta, last_std, log_evidence(some, prior, log_amplitude, 1.0))
