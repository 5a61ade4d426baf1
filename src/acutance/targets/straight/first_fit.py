"""The first fit of a straight target: a Gaussian through a pixel, a line and two levels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_lapack_funcs

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, GaussianPixel
from acutance.numerics.lorentz_tail import tail_esf, tail_lsf
from acutance.targets.straight.step_profile import EDGE, Profile, pulse_profile
from acutance.targets.straight.tuned import APERTURE_PX, TAIL_WIDTH

__all__ = ["FirstFit", "fit_first"]

_MAX_STEPS = 30
_SETTLED = 0.02
_DAMPING = 1e-3
_REACH_WIDTHS = 2.5
_MIN_SIGMA_PX = 0.35
_TAIL_STD = 0.1
_APERTURE_STEP_PX = 1.0
(_gesv,) = get_lapack_funcs(("gesv",), (np.empty((1, 1)),))
# Parameters: dark, height, offset, turn, sigma, aperture, tail; of a pulse also width and height
# ratio.
_EXPECTED: Floats = np.array([0.0, 0.0, 0.0, 0.0, 0.0, APERTURE_PX[0], 0.0, 0.0, 0.0])
_LOWEST: Floats = np.array([*[-np.inf] * 4, _MIN_SIGMA_PX, 0.2, 0.0, 0.0, 0.0])
_HIGHEST: Floats = np.array([*[np.inf] * 4, np.inf, 4.0, 0.5, np.inf, np.inf])


@dataclass(frozen=True)
class FirstFit:
    """A target blurred by a Gaussian and a detector, fitted to the pixels.

    `height` is that of the first step (bright minus dark for an edge); `noise` the standard
    deviation of the residuals.
    """

    line: Line
    blur: GaussianPixel
    dark: float
    height: float
    noise: float
    profile: Profile = EDGE


def fit_first(
    row: Floats,
    col: Floats,
    value: Floats,
    line: Line,
    *,
    dark: float,
    bright: float,
    sigma_px: float = 0.6,
    noise: float | None = None,
    profile: Profile = EDGE,
    fit_width: bool = False,
) -> FirstFit:
    """Fit line, blur, levels and, of a pulse, its steps by damped Gauss-Newton.

    Parameters
    ----------
    row, col, value : (n,) arrays
        Pixel coordinates (integers are centres) and values.
    line : Line
        First guess of the line, good to about a pixel.
    dark, bright : float
        First guess of the levels.
    sigma_px : float, optional
        First guess of the Gaussian's standard deviation.
    noise : float, optional
        First guess of the noise, the weight of the priors of aperture and tail.
    profile : Profile, optional
        An edge, or the first guess of a pulse's steps.
    fit_width : bool, optional
        Whether a pulse's width is unknown (its height ratio always is).

    Raises
    ------
    NoEdgeError
        If no step survives the fit.
    """
    t = line.tangent_distance(row, col)
    s = line.normal_distance(row, col)
    # A bad pixel counts with no more than a whole height.
    levels = (dark, bright, dark + (bright - dark) * sum(profile.shares))
    span = max(levels) - min(levels)
    value = np.clip(value, min(levels) - span, max(levels) + span)
    p = np.array([dark, bright - dark, 0.0, 0.0, sigma_px, APERTURE_PX[0], 0.0, *_steps(profile)])
    scale = noise if noise else 0.02 * abs(bright - dark)
    reach = max(6.0, 4 * _REACH_WIDTHS * sigma_px)
    lowest, highest = _LOWEST[: p.size].copy(), _HIGHEST[: p.size].copy()
    if p.size > 7:
        # A pulse does not determine the aperture apart from its own width.
        lowest[5] = highest[5] = p[5]
        lowest[7], highest[7] = (0.5 * p[7], 2.0 * p[7]) if fit_width else (p[7], p[7])
    for _ in range(4):
        near = profile.outside(s - p[2] + t * p[3]) < reach
        p, left = _gauss_newton(
            s[near], t[near], value[near], p, scale / APERTURE_PX[1], scale / _TAIL_STD,
            lowest, highest,
        )  # fmt: skip
        blur, height = GaussianPixel(float(p[4]), float(p[5])), float(p[1])
        scale = max(left, 1e-6 * abs(height))
        wanted = _REACH_WIDTHS * blur.width_px
        if wanted <= reach * 1.05:
            break
        reach = 1.2 * wanted
    if not (height > 0 and math.isfinite(height)) or height < scale:
        raise NoEdgeError(
            f"no straight target was found: the best fit is a step of {height:.3g} in noise of "
            f"{scale:.3g}; choose a region with one edge, or one pulse, between uniform plateaus"
        )
    found = profile if p.size == 7 else pulse_profile(float(p[7]), float(p[8]))
    moved = line.moved(float(p[2]), math.degrees(float(p[3])))
    return FirstFit(moved, blur, float(p[0]), height, scale, found)


def _steps(profile: Profile) -> tuple[float, ...]:
    """The free parameters of a profile: a pulse's width and height ratio."""
    return (profile.positions_px[1], -profile.shares[1]) if len(profile.shares) > 1 else ()


def _gauss_newton(
    s: Floats,
    t: Floats,
    value: Floats,
    start: Floats,
    aperture_weight: float,
    tail_weight: float,
    lowest: Floats,
    highest: Floats,
) -> tuple[Floats, float]:
    """Minimise the squared residuals and the penalties over the parameters.

    Returns the parameters and the standard deviation of the residuals.
    """
    damping, size = _DAMPING, start.size
    # The priors of aperture and tail: two more data.
    penalty = np.zeros(size)
    penalty[5], penalty[6] = aperture_weight**2, tail_weight**2
    longest = np.full(size, np.inf)
    longest[5], longest[6] = _APERTURE_STEP_PX, 1.0
    best = _Trial.of(s, t, value, start, penalty)
    jacobian = best.jacobian(t)
    p = start
    for _ in range(_MAX_STEPS):
        gram = jacobian @ jacobian.T
        gradient = jacobian @ best.residual + penalty * (_EXPECTED[:size] - p)
        diagonal = gram.diagonal() + penalty
        gram.reshape(-1)[:: size + 1] = np.where(diagonal > 0, diagonal * (1 + damping), 1.0)
        longest[4] = p[4]
        step = _bounded_solution(
            gram,
            gradient,
            np.maximum(lowest - p, -0.5 * longest),
            np.minimum(highest - p, longest),
        )
        # The cost falls by the product of gradient and step where neither damping nor a bound
        # changes the step: the last one is not tried.
        gain = float(gradient @ step)
        enough = _SETTLED * best.cost + 1e-18 * p[1] ** 2 * s.size
        settled = damping < 2 * _DAMPING and 0 <= gain <= enough
        # A wider aperture at the same variance makes the Gaussian narrower.
        variance = p[4] ** 2 + 2 * p[4] * step[4] - step[5] ** 2 / 12
        moved = p + step
        moved[4] = math.sqrt(max(variance, _MIN_SIGMA_PX**2))
        if settled:
            p = moved
            break
        trial = _Trial.of(s, t, value, moved, penalty)
        if trial.cost <= best.cost:
            best, p = trial, moved
            damping *= 0.1
            jacobian = best.jacobian(t)
        else:
            damping = max(damping, 1e-4) * 10
            if damping > 1e6:
                break
    left = float(best.residual @ best.residual) / max(s.size - size, 1)
    return p, math.sqrt(left)


def _bounded_solution(gram: Floats, gradient: Floats, low: Floats, high: Floats) -> Floats:
    """The minimum of a quadratic form within bounds: parameters are held at their bounds."""
    step = _solution(gram, gradient)
    held = np.zeros(step.size, bool)
    while (outside := ((step < low) | (step > high)) & ~held).any():
        held |= outside
        free = ~held
        step[held] = np.minimum(np.maximum(step, low), high)[held]
        if not free.any():
            break
        rest = gradient[free] - gram[np.ix_(free, held)] @ step[held]
        step[free] = _solution(gram[np.ix_(free, free)], rest)
    return step


def _solution(gram: Floats, gradient: Floats) -> Floats:
    """The solution of a small system.

    Raises
    ------
    NoEdgeError
        If LAPACK finds none: pixels that do not depend on the parameters.
    """
    _, _, step, failed = _gesv(gram, gradient)
    if failed:
        raise NoEdgeError(
            f"no straight target was fitted: the pixels do not determine it (LAPACK code {failed});"
            " choose a region with one edge, or one pulse, between uniform plateaus"
        )
    return np.asarray(step, float)


@dataclass(frozen=True, eq=False)
class _Trial:
    """The model of the target at one set of parameters, compared with the pixels.

    Attributes
    ----------
    p : (7,) or (9,) array
    cost : float
        Squared residuals and penalties.
    residual : (n,) array
    u : (m,) array
        Distances from the steps in widths: n from the first, n from the second if there is one.
    step, beyond : (m,) arrays
        Response to a unit step at those distances, and the difference of the tail's response from
        it.
    slopes : three (m,) arrays
        Derivatives of the blur's response by distance, sigma and aperture.
    """

    p: Floats
    cost: float
    residual: Floats
    u: Floats
    step: Floats
    beyond: Floats
    slopes: tuple[Floats, Floats, Floats]

    @classmethod
    def of(cls, s: Floats, t: Floats, value: Floats, p: Floats, penalty: Floats) -> _Trial:
        dark, height, offset, turn, sigma, aperture, tail, *steps = p.tolist()
        blur = GaussianPixel(sigma, aperture)
        # Turning the normal by a small angle moves a pixel at t by -t * angle along it: the line
        # turns about its own point.
        distance = s - offset + t * turn
        if steps:
            distance = np.concatenate([distance, distance - steps[0]])
        esf, *slopes = blur.esf_and_slopes(distance)
        u = distance / blur.width_px
        beyond = tail_esf(u, TAIL_WIDTH) - esf
        step = esf + tail * beyond
        residual = value - (dark + height * _profiled(step, p))
        cost = float(residual @ residual) + float(penalty @ (p - _EXPECTED[: p.size]) ** 2)
        return cls(p, cost, residual, u, step, beyond, (slopes[0], slopes[1], slopes[2]))

    def jacobian(self, t: Floats) -> Floats:
        """Derivatives of the model by the parameters, (7 or 9, n)."""
        _, height, _, _, sigma, aperture, tail, *steps = self.p.tolist()
        width = GaussianPixel(sigma, aperture).width_px
        lsf, by_sigma, by_aperture = self.slopes
        within, far = height * (1 - tail), height * tail / width * tail_lsf(self.u, TAIL_WIDTH)
        # The tail scales with the width, whose square is that of sigma and aperture / sqrt(12)
        # added.
        stretch = far * self.u * (-(FWHM_OF_SIGMA**2) / width)
        by_distance = within * lsf + far
        jacobian = np.empty((self.p.size, t.size))
        jacobian[0] = 1.0
        jacobian[1] = _profiled(self.step, self.p)
        jacobian[2] = -_profiled(by_distance, self.p)
        np.multiply(jacobian[2], -t, out=jacobian[3])
        jacobian[4] = _profiled(within * by_sigma + sigma * stretch, self.p)
        jacobian[5] = _profiled(within * by_aperture + aperture / 12 * stretch, self.p)
        np.multiply(_profiled(self.beyond, self.p), height, out=jacobian[6])
        if steps:
            np.multiply(by_distance[t.size :], steps[1], out=jacobian[7])
            np.multiply(self.step[t.size :], -height, out=jacobian[8])
        return jacobian


def _profiled(response: Floats, p: Floats) -> Floats:
    """Responses at the distances from every step, put together to the profile's, (n,)."""
    if p.size == 7:
        return response
    n = response.size // 2
    return np.asarray(response[:n] - p[8] * response[n:])
