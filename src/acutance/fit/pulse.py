"""The reference estimator of a pulse: LSF, line, width and fall fitted together."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_lapack_funcs

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.fit.band import EdgeBand
from acutance.fit.blur import Blur
from acutance.fit.edge import SplineEdge, spline_edge
from acutance.fit.profile import pulse_profile
from acutance.fit.start import BlurredEdge
from acutance.fit.straight import Pixels, Solved, solve

__all__ = ["PulseBand", "SplinePulse", "fit_blurred_pulse", "fit_pulse"]

_MAX_STEPS = 60
_SETTLED = 1e-3
_DAMPING = 1e-3
(_gesv,) = get_lapack_funcs(("gesv",), (np.empty((1, 1)),))
_MIN_SIGMA_PX, _MAX_SIGMA_PX = 0.3, 6.0
_REACH_WIDTHS = 2.5


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
    """

    pulse_width: Estimate
    fall: Estimate


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
    pixels = Pixels.of(band.image)
    start = _start(band, pixels, fit_width)
    solved = solve(pixels, start, robust=robust, fit_width=fit_width)
    edge = spline_edge(pixels, solved)
    return SplinePulse(
        **vars(edge),
        pulse_width=_width(solved, fit_width),
        fall=Estimate(
            -solved.start.profile.shares[1] + float(solved.solution.steps[-1]),
            float(solved.solution.steps_std[-1]),
        ),
    )


def _start(band: PulseBand, pixels: Pixels, fit_width: bool) -> BlurredEdge:
    """The plain blurred pulse the linear model departs from."""
    if band.blur is None:
        return fit_blurred_pulse(
            pixels, band, width_px=band.pulse_width_px, fall=band.fall, fit_width=fit_width
        )
    profile = pulse_profile(band.pulse_width_px, band.fall)
    return BlurredEdge(
        band.line, band.blur, band.dark, band.bright - band.dark, band.noise, profile
    )


def _width(solved: Solved, fit_width: bool) -> Estimate:
    width_px = solved.start.profile.positions_px[1]
    if not fit_width:
        return Estimate(width_px)
    solution = solved.solution
    return Estimate(width_px + float(solution.steps[0]), float(solution.steps_std[0]))


def fit_blurred_pulse(
    pixels: Pixels, band: EdgeBand, *, width_px: float, fall: float = 1.0, fit_width: bool = True
) -> BlurredEdge:
    """Fit line, Gaussian blur, levels and steps of a pulse by damped Gauss-Newton.

    The aperture is held at one pixel: a pulse a few pixels wide does not tell it from the rest of
    the blur.

    Parameters
    ----------
    pixels : Pixels
    band : EdgeBand
        Where line, levels and blur start.
    width_px, fall : float
        Where the steps start.
    fit_width : bool, optional

    Raises
    ------
    NoEdgeError
        If no step survives.
    """
    line = band.line
    s, t = (
        distance(pixels.row, pixels.col)
        for distance in (line.normal_distance, line.tangent_distance)
    )
    # dark, height, offset, turn, sigma, width, fall
    p = np.array(
        [band.dark, band.bright - band.dark, 0.0, 0.0, max(band.width_px, 0.4), width_px, fall]
    )
    free = np.array([True] * 5 + [fit_width, True])
    reach = max(6.0, 3 * _REACH_WIDTHS * band.width_px)
    near = (s > -reach) & (s < width_px + reach)
    s, t, value = s[near], t[near], pixels.value[near]
    damping = _DAMPING
    cost, jacobian, residual = _linearise(s, t, value, p)
    for _ in range(_MAX_STEPS):
        used = jacobian[free]
        gram = used @ used.T
        # The ridge holds what the pixels do not: a step at its bound moves nothing.
        diagonal = np.diag_indices(len(gram))
        gram[diagonal] *= 1 + damping
        gram[diagonal] += 1e-12 * np.trace(gram)
        step = np.zeros(7)
        gradient = used @ residual
        step[free] = _gesv(gram, gradient)[2]
        # A step that nothing damps gains its product with the gradient: the last one is not tried.
        gain = float(gradient @ step[free])
        trial = p + step
        trial[4] = np.clip(trial[4], max(_MIN_SIGMA_PX, 0.5 * p[4]), min(_MAX_SIGMA_PX, 2 * p[4]))
        trial[5] = np.clip(trial[5], 0.5 * width_px, 2.0 * width_px)
        if damping < 2 * _DAMPING and 0 <= gain <= _SETTLED * cost + 1e-18 * p[1] ** 2 * s.size:
            p = trial
            break
        new_cost, new_jacobian, new_residual = _linearise(s, t, value, trial)
        if new_cost <= cost:
            p, cost, jacobian, residual = trial, new_cost, new_jacobian, new_residual
            damping *= 0.1
        else:
            damping = max(damping, 1e-4) * 10
            if damping > 1e6:
                break
    dark, height, offset, turn, sigma, width_px, fall = p.tolist()
    noise = math.sqrt(cost / max(s.size - 7, 1))
    if not (height > 0 and fall > 0 and math.isfinite(cost)) or height < noise:
        raise NoEdgeError(
            f"no pulse was found: the best fit rises by {height:.3g} and falls by "
            f"{fall * height:.3g} in noise of {noise:.3g}; choose a region with one bright strip "
            "between two darker sides, and state its width"
        )
    return BlurredEdge(
        line.moved(offset, math.degrees(turn)), Blur(sigma), dark, height, noise,
        pulse_profile(width_px, fall),
    )  # fmt: skip


def _linearise(s: Floats, t: Floats, value: Floats, p: Floats) -> tuple[float, Floats, Floats]:
    """Cost, Jacobian of the model (7, n) and residual at parameters p."""
    dark, height, offset, turn, sigma, width_px, fall = p.tolist()
    blur = Blur(sigma)
    distance = s - offset + t * turn
    rise, rise_slope, rise_sigma, _ = blur.esf_and_slopes(distance)
    down, down_slope, down_sigma, _ = blur.esf_and_slopes(distance - width_px)
    shape = rise - fall * down
    residual = value - dark - height * shape
    slope = rise_slope - fall * down_slope
    jacobian = np.empty((7, s.size))
    jacobian[0] = 1.0
    jacobian[1] = shape
    np.multiply(slope, -height, out=jacobian[2])
    np.multiply(jacobian[2], -t, out=jacobian[3])
    np.multiply(rise_sigma - fall * down_sigma, height, out=jacobian[4])
    np.multiply(down_slope, height * fall, out=jacobian[5])
    np.multiply(down, -height, out=jacobian[6])
    return float(residual @ residual), jacobian, residual
