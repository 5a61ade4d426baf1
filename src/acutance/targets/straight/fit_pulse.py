"""The reference estimator of a pulse.

Line spread function (LSF), line, width and height ratio are fitted together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.steps import Steps, finished
from acutance.targets.straight.first_fit import FirstFit, fit_first
from acutance.targets.straight.fit_edge import SplineEdge, spline_edge
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.solve import Solved, solve
from acutance.targets.straight.step_profile import pulse_profile

__all__ = ["PulsePixels", "SplinePulse", "fit_pulse", "fit_pulse_steps"]


@dataclass(frozen=True, eq=False)
class PulsePixels(EdgePixels):
    """A region trimmed to one pulse.

    Their line is the rising side of the pulse, its normal pointing into the pulse; `dark` is
    the plateau before it and `bright` the level a wide pulse would have. Of a dark pulse between
    bright plateaus `sign` is -1, and the image's values are negated.

    Parameters
    ----------
    width_px : float
        Standard deviation of the Gaussian that fits the blur (as in `EdgePixels`).
    pulse_width_px : float
        Width of the pulse along the normal, as stated or as first fitted.
    height_ratio : float
        Height of the falling side over that of the rising one.
    sign : float
    """

    pulse_width_px: float = 3.0
    height_ratio: float = 1.0
    sign: float = 1.0


@dataclass(frozen=True, eq=False)
class SplinePulse(SplineEdge):
    """The reference estimator's fit of a pulse.

    Attributes
    ----------
    pulse_width : Estimate
        Width along the normal in pixels; without standard deviation where it was stated and held.
    height_ratio : Estimate
        Height of the falling side over that of the rising one.
    width_factor : (m,) array
        Factor of the width's variance in the latent variables of the curves; zeros where it was
        held.
    """

    pulse_width: Estimate
    height_ratio: Estimate
    width_factor: Floats


def fit_pulse(trimmed: PulsePixels, *, fit_width: bool = True, robust: bool = True) -> SplinePulse:
    """Measure the pulse of trimmed pixels.

    Parameters
    ----------
    trimmed : PulsePixels
    fit_width : bool, optional
        Whether the width is fitted with the LSF (that of `trimmed` is the first guess) or held.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoEdgeError
        If no pulse survives the fit.
    """
    return finished(fit_pulse_steps(trimmed, fit_width=fit_width, robust=robust))


def fit_pulse_steps(trimmed: PulsePixels, *, fit_width: bool, robust: bool) -> Steps[SplinePulse]:
    """`fit_pulse` in steps."""
    first_fit = _first_fit(trimmed, fit_width)
    solved = yield from solve(trimmed.pixels, first_fit, robust=robust, fit_width=fit_width)
    yield
    edge = spline_edge(trimmed.pixels, solved)
    return SplinePulse(
        **vars(edge),
        pulse_width=_width(solved, fit_width),
        height_ratio=Estimate(
            -solved.first_fit.profile.shares[1] + float(solved.solution.updates[-1]),
            float(solved.solution.updates_std[-1]),
        ),
        width_factor=_width_factor(solved, fit_width),
    )


def _first_fit(trimmed: PulsePixels, fit_width: bool) -> FirstFit:
    """The Gaussian through a pixel about which the linear model is made."""
    profile = pulse_profile(trimmed.pulse_width_px, trimmed.height_ratio)
    if trimmed.blur is not None:
        height = trimmed.bright - trimmed.dark
        return FirstFit(trimmed.line, trimmed.blur, trimmed.dark, height, trimmed.noise, profile)
    pixels = trimmed.pixels
    return fit_first(
        pixels.row, pixels.col, pixels.value, trimmed.line,
        dark=trimmed.dark, bright=trimmed.bright, sigma_px=trimmed.width_px, noise=trimmed.noise,
        profile=profile, fit_width=fit_width,
    )  # fmt: skip


def _width(solved: Solved, fit_width: bool) -> Estimate:
    width_px = solved.first_fit.profile.positions_px[1]
    if not fit_width:
        return Estimate(width_px)
    solution = solved.solution
    return Estimate(width_px + float(solution.updates[0]), float(solution.updates_std[0]))


def _width_factor(solved: Solved, fit_width: bool) -> Floats:
    factor = solved.solution.linear.latent(solved.solution.posterior)
    # Last but one of the unknowns: the height ratio comes after it.
    return factor[-2] if fit_width else np.zeros(factor.shape[1])
