"""The model of the first fit with its derivatives at every pixel, and Gauss-Newton steps over it.

Of the light of a Gaussian through a pixel a share lies in a tail instead. Parameters, in the order
of all arrays: dark level, height, offset and turn of the line, sigma, aperture, share of the tail;
of a pulse also its width, and the height of its second step over that of the first.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, blurred_step, gaussian_pixel_width
from acutance.numerics.lorentz_tail import tail_step
from acutance.numerics.scalar_product import scalar_product
from acutance.targets.straight.tuned import TAIL_WIDTH

__all__ = ["MIN_SIGMA_PX", "bounded_solution", "compared", "gauss_newton"]

MIN_SIGMA_PX = 0.35
_MAX_STEPS = 30
_SETTLED = 0.02
_DAMPING = 1e-3
_MAX_DAMPING = 1e6
_APERTURE_STEP_PX = 1.0
_blur_width = inlined(gaussian_pixel_width)


@compiled
def gauss_newton(
    s: Floats,
    t: Floats,
    value: Floats,
    start: Floats,
    expected: Floats,
    weight: Floats,
    lowest: Floats,
    highest: Floats,
    last_step_px: float,
    reach_px: float,
) -> tuple[Floats, float]:
    """Minimise the squared residuals and the penalties by damped Gauss-Newton.

    Parameters
    ----------
    s, t, value : (n,) arrays
        Distances of the pixels from the first guess of the line, along its normal and along it,
        and their values.
    start : (7,) or (9,) array
        First guess of the parameters.
    expected, weight : arrays like `start`
        A penalty is a weight times the squared difference from what is expected.
    lowest, highest : arrays like `start`
        Bounds of the parameters.
    last_step_px, reach_px : float
        Pixels beyond this reach from the first step, or from the last one, are left out.

    Returns
    -------
    p : array like `start`
    left : float
        Standard deviation of the residuals; not finite if a pixel is not.
    """
    p, damping = start.copy(), _DAMPING
    distance = s - p[2] + t * p[3]
    near = (distance > -reach_px) & (distance < last_step_px + reach_px)
    s, t, value = s[near], t[near], value[near]
    residual, jacobian = compared(s, t, value, p)
    cost = scalar_product(residual, residual) + scalar_product(weight, (p - expected) ** 2)
    for _ in range(_MAX_STEPS):
        gram, gradient = _normal_equations(jacobian, residual, weight, expected - p, damping)
        step = bounded_solution(gram, gradient, *_step_bounds(p, lowest, highest))
        moved = _moved(p, step)
        # The cost falls by the product of gradient and step where neither damping nor a bound
        # changes the step: the last one is not tried.
        gain, enough = scalar_product(gradient, step), _SETTLED * cost + 1e-18 * p[1] ** 2 * s.size
        if damping < 2 * _DAMPING and 0 <= gain <= enough:
            p = moved
            break
        new_residual, new_jacobian = compared(s, t, value, moved)
        new_cost = scalar_product(new_residual, new_residual)
        new_cost += scalar_product(weight, (moved - expected) ** 2)
        if new_cost <= cost:
            p, cost, residual, jacobian = moved, new_cost, new_residual, new_jacobian
            damping *= 0.1
        else:
            damping = max(damping, 1e-4) * 10
            if damping > _MAX_DAMPING:
                break
    return p, math.sqrt(scalar_product(residual, residual) / max(s.size - p.size, 1))


@compiled
def compared(s: Floats, t: Floats, value: Floats, p: Floats) -> tuple[Floats, Floats]:
    """What the model leaves of the pixels, (n,), and its derivatives, (7 or 9, n)."""
    dark, height, offset, turn = p[0], p[1], p[2], p[3]
    residual, jacobian = np.empty(s.size), np.empty((p.size, s.size))
    # Turning the normal by a small angle moves a pixel at t by -t * angle along it: the line turns
    # about its own point.
    distance = s - offset + t * turn
    response = _responses(distance, p)
    if p.size > 7:
        width, ratio = p[7], p[8]
        second = _responses(distance - width, p)
        response -= ratio * second
        for k in range(s.size):
            jacobian[7, k] = height * ratio * second[1, k]
            jacobian[8, k] = -height * second[0, k]
    for k in range(s.size):
        residual[k] = value[k] - (dark + height * response[0, k])
        jacobian[0, k] = 1.0
        jacobian[1, k] = response[0, k]
        jacobian[2, k] = -height * response[1, k]
        jacobian[3, k] = height * response[1, k] * t[k]
        for i in range(3):
            jacobian[4 + i, k] = height * response[2 + i, k]
    return residual, jacobian


@compiled
def _responses(distance: Floats, p: Floats) -> Floats:
    """Responses to a unit step; derivatives by distance, sigma, aperture and tail, (5, n)."""
    sigma, aperture, tail = p[4], p[5], p[6]
    width = _blur_width(sigma, aperture)
    found = np.empty((5, distance.size))
    for k in range(distance.size):
        esf, lsf, by_sigma, by_aperture = blurred_step(distance[k], sigma, aperture)
        esf_of_tail, lsf_of_tail = tail_step(distance[k], TAIL_WIDTH * width)
        # The tail scales with the width, whose square is that of sigma and aperture / sqrt(12)
        # added.
        stretch = -tail * lsf_of_tail * distance[k] * (FWHM_OF_SIGMA / width) ** 2
        found[0, k] = (1 - tail) * esf + tail * esf_of_tail
        found[1, k] = (1 - tail) * lsf + tail * lsf_of_tail
        found[2, k] = (1 - tail) * by_sigma + sigma * stretch
        found[3, k] = (1 - tail) * by_aperture + aperture / 12 * stretch
        found[4, k] = esf_of_tail - esf
    return found


@compiled
def _normal_equations(
    jacobian: Floats, residual: Floats, weight: Floats, missing: Floats, damping: float
) -> tuple[Floats, Floats]:
    """Matrix and right side of the normal equations of pixels and penalties, damped."""
    size = weight.size
    gram, gradient = np.empty((size, size)), np.empty(size)
    for i in range(size):
        gradient[i] = scalar_product(jacobian[i], residual) + weight[i] * missing[i]
        for j in range(i):
            gram[i, j] = gram[j, i] = scalar_product(jacobian[i], jacobian[j])
        diagonal = scalar_product(jacobian[i], jacobian[i]) + weight[i]
        # A parameter without effect stays.
        gram[i, i] = diagonal * (1 + damping) if diagonal > 0 else 1.0
    return gram, gradient


@compiled
def _step_bounds(p: Floats, lowest: Floats, highest: Floats) -> tuple[Floats, Floats]:
    """How far the parameters may go down and up: those of the blur not far in one step."""
    low, high = lowest - p, highest - p
    longest = (p[4], _APERTURE_STEP_PX, 1.0)
    for i in range(3):
        low[4 + i] = max(low[4 + i], -0.5 * longest[i])
        high[4 + i] = min(high[4 + i], longest[i])
    return low, high


@compiled
def _moved(p: Floats, step: Floats) -> Floats:
    """The parameters a step further."""
    moved = p + step
    # A wider aperture at the same variance makes the Gaussian narrower.
    variance = p[4] ** 2 + 2 * p[4] * step[4] - step[5] ** 2 / 12
    moved[4] = math.sqrt(max(variance, MIN_SIGMA_PX**2))
    return moved


@compiled
def bounded_solution(gram: Floats, gradient: Floats, low: Floats, high: Floats) -> Floats:
    """The minimum of a quadratic form within bounds: parameters are held at their bounds."""
    held = np.zeros(gradient.size, np.bool_)
    step = _solution(gram.copy(), gradient.copy())
    while True:
        found = False
        for i in range(step.size):
            if not held[i] and (step[i] < low[i] or step[i] > high[i]):
                step[i] = min(max(step[i], low[i]), high[i])
                held[i] = found = True
        if not found:
            return step
        step = _solution(*_with_held(step, held, gram, gradient))


@compiled
def _with_held(
    step: Floats, held: NDArray[np.bool_], gram: Floats, gradient: Floats
) -> tuple[Floats, Floats]:
    """Normal equations of which some parameters keep the step they have."""
    matrix, right = gram.copy(), gradient.copy()
    for i in range(step.size):
        for j in range(step.size):
            if held[j]:
                right[i] -= gram[i, j] * step[j]
            if held[i] or held[j]:
                matrix[i, j] = 1.0 if i == j else 0.0
    for i in range(step.size):
        if held[i]:
            right[i] = step[i]
    return matrix, right


@compiled
def _solution(matrix: Floats, right: Floats) -> Floats:
    """Solve a positive definite system by elimination; both arrays are overwritten.

    Not finite if the matrix is singular.
    """
    size = right.size
    for i in range(size):
        for j in range(i + 1, size):
            share = matrix[j, i] / matrix[i, i]
            right[j] -= share * right[i]
            for k in range(i + 1, size):
                matrix[j, k] -= share * matrix[i, k]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    return right
