"""The plain blurred edge fitted to the pixels: where the reference estimator starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.fit.blur import Blur
from acutance.fit.line import Line
from acutance.fit.prior import APERTURE_PX, tail_esf

__all__ = ["BlurredEdge", "fit_blurred_edge"]

_MAX_STEPS = 40
_REACH_WIDTHS = 2.5
_MIN_SIGMA_PX = 0.35
_TAIL_STD = 0.1
_MAX_APERTURE_PX = 4.0


@dataclass(frozen=True)
class BlurredEdge:
    """A Gaussian-and-detector edge fitted to the pixels.

    `height` is bright minus dark; `noise` the standard deviation of what the model leaves.
    """

    line: Line
    blur: Blur
    dark: float
    height: float
    noise: float


def fit_blurred_edge(
    row: Floats,
    col: Floats,
    value: Floats,
    line: Line,
    *,
    dark: float,
    bright: float,
    sigma_px: float = 0.6,
    noise: float | None = None,
) -> BlurredEdge:
    """Fit line, blur and levels by damped Gauss-Newton.

    Parameters
    ----------
    row, col, value : (n,) arrays
        Pixel coordinates (integers are centres) and values.
    line : Line
        Start of the line, good to about a pixel.
    dark, bright : float
        Start of the levels.
    sigma_px : float, optional
        Start of the Gaussian's width.

    Raises
    ------
    NoEdgeError
        If no step survives the fit.
    """
    aperture, aperture_std = APERTURE_PX
    t = line.tangent_distance(row, col)
    s = line.normal_distance(row, col)
    offset = turn = 0.0
    height, sigma = bright - dark, sigma_px
    weight_scale = noise if noise else 0.02 * abs(height)
    reach = max(6.0, 4 * _REACH_WIDTHS * sigma)
    for _ in range(4):
        near = np.abs(s - offset + t * turn) < reach
        fitted = _gauss_newton(
            s[near],
            t[near],
            value[near],
            (dark, height, offset, turn, sigma, aperture, 0.0),
            weight_scale / aperture_std,
            weight_scale / _TAIL_STD,
        )
        (dark, height, offset, turn, sigma, aperture, tail), noise_near = fitted
        weight_scale = max(noise_near, 1e-6 * abs(height))
        wanted = _REACH_WIDTHS * Blur(sigma, aperture).width_px
        if wanted <= reach * 1.05:
            break
        reach = 1.2 * wanted
    if not (height > 0 and math.isfinite(height)) or height < weight_scale * 1.0:
        raise NoEdgeError(
            f"no straight edge was found: the best fit is a step of {height:.3g} in noise of "
            f"{weight_scale:.3g}; choose a region with one bright and one dark side"
        )
    located = line.moved(offset, math.degrees(turn))
    return BlurredEdge(located, Blur(sigma, aperture), dark, height, float(weight_scale))


_Parameters = tuple[float, float, float, float, float, float, float]


def _gauss_newton(
    s: Floats,
    t: Floats,
    value: Floats,
    start: _Parameters,
    aperture_weight: float,
    tail_weight: float,
) -> tuple[_Parameters, float]:
    """Minimise the squared residuals and the aperture's penalty over the seven parameters."""
    p = np.array(start)
    damping = 1e-3
    cost, jacobian, residual = _linearise(s, t, value, p, aperture_weight, tail_weight)
    for _ in range(_MAX_STEPS):
        gram = jacobian @ jacobian.T
        gradient = jacobian @ residual
        # The aperture's prior: one more datum.
        gram[5, 5] += aperture_weight**2
        gradient[5] += aperture_weight**2 * (APERTURE_PX[0] - p[5])
        gram[6, 6] += tail_weight**2
        gradient[6] -= tail_weight**2 * p[6]
        gram[np.arange(7), np.arange(7)] *= 1 + damping
        step = np.linalg.solve(gram + 1e-12 * np.trace(gram) * np.eye(7) / 7, gradient)
        step[4] = np.clip(step[4], -0.5 * p[4], p[4])
        trial = p + step
        trial[4] = max(trial[4], _MIN_SIGMA_PX)
        trial[6] = min(max(trial[6], 0.0), 0.5)
        trial[5] = min(max(trial[5], 0.2), _MAX_APERTURE_PX)
        new_cost, new_jacobian, new_residual = _linearise(
            s, t, value, trial, aperture_weight, tail_weight
        )
        if new_cost <= cost:
            gain = cost - new_cost
            p, cost, jacobian, residual = trial, new_cost, new_jacobian, new_residual
            damping *= 0.1
            if gain <= 1e-4 * cost + 1e-18 * p[1] ** 2 * s.size:
                break
        else:
            damping = max(damping, 1e-4) * 10
            if damping > 1e6:
                break
    misfit = float(residual @ residual)
    a, b, c, d, e, f, g = p.tolist()
    return (a, b, c, d, e, f, g), math.sqrt(misfit / max(s.size - 7, 1))


def _linearise(
    s: Floats, t: Floats, value: Floats, p: Floats, aperture_weight: float, tail_weight: float
) -> tuple[float, Floats, Floats]:
    """Cost, Jacobian (6, n) and residual at parameters p."""
    dark, height, offset, turn, sigma, aperture, tail = p
    # Turning the normal by a small angle moves a pixel at t by -t * angle along it: the line
    # turns about its own point.
    blur = Blur(sigma, aperture)
    distance = s - offset + t * turn
    esf, lsf, by_sigma, by_aperture = blur.esf_and_slopes(distance)
    beyond = tail_esf(distance / blur.width_px) - esf
    step = esf + tail * beyond
    residual = value - dark - height * step
    jacobian = np.empty((7, s.size))
    jacobian[0] = 1.0
    jacobian[1] = step
    jacobian[6] = height * beyond
    jacobian[2] = -height * lsf
    jacobian[3] = -jacobian[2] * t
    jacobian[4] = height * by_sigma
    jacobian[5] = height * by_aperture
    cost = float(residual @ residual)
    cost += (aperture_weight * (APERTURE_PX[0] - aperture)) ** 2 + (tail_weight * tail) ** 2
    return cost, jacobian, residual
