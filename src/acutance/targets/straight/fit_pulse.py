"""The reference estimator of a pulse: LSF, line, width and fall fitted together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.straight.first_fit import BlurredEdge, fit_blurred_edge
from acutance.targets.straight.fit_edge import SplineEdge, spline_edge
from acutance.targets.straight.pixels import EdgeBand
from acutance.targets.straight.solve import Solved, solve
from acutance.targets.straight.step_profile import pulse_profile

__all__ = ["PulseBand", "SplinePulse", "fit_pulse"]


@dataclass(frozen=True, eq=False)
class PulseBand(EdgeBand):
    """A region trimmed to one pulse.

    The band's line is the rising side of the pulse, its normal pointing into the pulse; `dark` is
    the ground before it and `bright` the level a wide pulse would have. A dark pulse on bright
    ground is kept with its sign turned: `sign` is -1 then, and the image's values are negated.

    Parameters
    ----------
    width_px : float
        Standard deviation of the Gaussian that fits the blur (as in `EdgeBand`).
    pulse_width_px : float
        Width of the pulse along the normal, as stated or as first fitted.
    fall : float
        Height of the falling side over that of the rising one.
    sign : float
    """

    pulse_width_px: float = 3.0
    fall: float = 1.0
    sign: float = 1.0


@dataclass(frozen=True, eq=False)
class SplinePulse(SplineEdge):
    """The reference estimator's fit of a pulse.

    Attributes
    ----------
    pulse_width : Estimate
        Width along the normal in pixels; without deviation where it was given and held.
    fall : Estimate
        Height of the falling side over that of the rising one.
    width_factor : (m,) array
        Factor of the width's variance in the latent variables of the curves; zeros where it was
        held.
    """

    pulse_width: Estimate
    fall: Estimate
    width_factor: Floats


def fit_pulse(band: PulseBand, *, fit_width: bool = True, robust: bool = True) -> SplinePulse:
    """Measure the pulse of a band.

    Parameters
    ----------
    band : PulseBand
    fit_width : bool, optional
        Whether the width is fitted with the LSF (the band's is the start) or held.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoEdgeError
        If no pulse survives the fit.
    """
    start = _start(band, fit_width)
    solved = solve(band.pixels, start, robust=robust, fit_width=fit_width)
    edge = spline_edge(band.pixels, solved)
    return SplinePulse(
        **vars(edge),
        pulse_width=_width(solved, fit_width),
        fall=Estimate(
            -solved.start.profile.shares[1] + float(solved.solution.steps[-1]),
            float(solved.solution.steps_std[-1]),
        ),
        width_factor=_width_factor(solved, fit_width),
    )


def _start(band: PulseBand, fit_width: bool) -> BlurredEdge:
    """The plain blurred pulse the linear model departs from."""
    profile = pulse_profile(band.pulse_width_px, band.fall)
    if band.blur is not None:
        height = band.bright - band.dark
        return BlurredEdge(band.line, band.blur, band.dark, height, band.noise, profile)
    pixels = band.pixels
    return fit_blurred_edge(
        pixels.row, pixels.col, pixels.value, band.line,
        dark=band.dark, bright=band.bright, sigma_px=band.width_px, noise=band.noise,
        profile=profile, fit_width=fit_width,
    )  # fmt: skip


def _width(solved: Solved, fit_width: bool) -> Estimate:
    width_px = solved.start.profile.positions_px[1]
    if not fit_width:
        return Estimate(width_px)
    solution = solved.solution
    return Estimate(width_px + float(solution.steps[0]), float(solution.steps_std[0]))


def _width_factor(solved: Solved, fit_width: bool) -> Floats:
    factor = solved.solution.posterior.factor
    # Last but one of the unknowns: the fall comes after it.
    return factor[-2] if fit_width else np.zeros(factor.shape[1])
