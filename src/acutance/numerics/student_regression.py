"""Linear regression whose residuals are Student-t: modes, covariances, log evidences.

Residual i has scale ``sqrt(scatter^2 + variance_i)``: a scatter of its own and a stated variance.
Coefficients have normal priors about 0 (a precision of 0 is a flat one), the logarithm of the
scatter that of a half-Cauchy distribution. Coefficients are integrated by Laplace's method about
their mode, the scatter by Laplace's method (`step_evidences`) or on a grid (`scatter_nodes`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["ScatterNodes", "StudentModel", "scatter_nodes", "step_evidences"]

_MAX_PASSES = 60
_SETTLED = 1e-4
_STEP = 0.3
"""Distance in log scatter at which the curvature of the evidence is taken."""
_MAX_MOVE = 1.5
_MAX_SEARCHES = 6
_LEAST_CURVATURE = 0.15
"""Where stated variances leave nothing to the scatter, its evidence has no curvature but the
prior's."""


@dataclass(frozen=True, eq=False)
class StudentModel:
    """What a regression is made from, without the columns of its steps.

    Attributes
    ----------
    columns : (n, p) array
    value : (n,) array
    variance : (n,) array
        Stated.
    precision : (p,) array
        Of the normal priors; 0 is a flat one.
    degrees : float
        Of freedom of the residuals.
    scatter_prior : float
        Median of the half-Cauchy prior of the scatter.
    log_scatter : float
        Where the scatter is sought from.
    """

    columns: Floats
    value: Floats
    variance: Floats
    precision: Floats
    degrees: float
    scatter_prior: float
    log_scatter: float


@dataclass(frozen=True, eq=False)
class ScatterNodes:
    """The posterior of a regression as normal densities at q scatters.

    Attributes
    ----------
    log_evidence : float
    share : (q,) array
        Sums to 1.
    scatter : (q,) array
    mode : (q, p) array
    covariance : (q, p, p) array
    """

    log_evidence: float
    share: Floats
    scatter: Floats
    mode: Floats
    covariance: Floats


@compiled
def _factorize(matrix: Floats) -> bool:
    """Cholesky's factor in the lower triangle of `matrix`; False if it is not positive."""
    size = matrix.shape[0]
    for j in range(size):
        for i in range(j, size):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i == j:
                if not total > 0:
                    return False
                matrix[j, j] = math.sqrt(total)
            else:
                matrix[i, j] = total / matrix[j, j]
    return True


@compiled
def _solve(factor: Floats, vector: Floats) -> None:
    """Put the solution of the factorized system in place of `vector`."""
    size = factor.shape[0]
    for i in range(size):
        total = vector[i]
        for k in range(i):
            total -= factor[i, k] * vector[k]
        vector[i] = total / factor[i, i]
    for i in range(size - 1, -1, -1):
        total = vector[i]
        for k in range(i + 1, size):
            total -= factor[k, i] * vector[k]
        vector[i] = total / factor[i, i]


@compiled
def _information(columns: Floats, weight: Floats, precision: Floats, matrix: Floats) -> None:
    """``columns @ diag(weight) @ columns.T + diag(precision)``, its lower triangle."""
    size, rows = columns.shape
    weighted = np.empty(rows)
    for i in range(size):
        for row in range(rows):
            weighted[row] = weight[row] * columns[i, row]
        for k in range(i + 1):
            total = 0.0
            for row in range(rows):
                total += weighted[row] * columns[k, row]
            matrix[i, k] = total
        matrix[i, i] += precision[i]


@compiled
def _residuals(columns: Floats, value: Floats, beta: Floats, residual: Floats) -> None:
    residual[:] = value
    for i in range(beta.size):
        amount = beta[i]
        for row in range(value.size):
            residual[row] -= amount * columns[i, row]


@compiled
def _log_evidence(
    columns: Floats, value: Floats, variance: Floats, precision: Floats, degrees: float,
    scatter_prior: float, log_scatter: float, beta: Floats, matrix: Floats,
) -> float:  # fmt: skip
    """Log evidence at one scatter, a density of its logarithm.

    Columns are rows here, (p, n): loops over the images are vectorised. `beta` is the start of the
    mode and becomes it; `matrix` becomes the factor of the information.
    """
    size, rows = columns.shape
    scatter = math.exp(log_scatter)
    scale = scatter**2 + variance
    weight, residual, right = np.empty(rows), np.empty(rows), np.empty(size)
    pull = np.empty(rows)
    for _ in range(_MAX_PASSES):
        _residuals(columns, value, beta, residual)
        for row in range(rows):
            weight[row] = (degrees + 1) / (degrees * scale[row] + residual[row] ** 2)
            pull[row] = weight[row] * residual[row]
        for i in range(size):
            total = -precision[i] * beta[i]
            for row in range(rows):
                total += columns[i, row] * pull[row]
            right[i] = total
        _information(columns, weight, precision, matrix)
        if not _factorize(matrix):
            return -np.inf
        moved = 0.0
        gradient = right.copy()
        _solve(matrix, right)
        for i in range(size):
            beta[i] += right[i]
            moved += gradient[i] * right[i]
        if moved < _SETTLED:
            break
    _residuals(columns, value, beta, residual)
    log_density = 0.0
    for row in range(rows):
        spread = degrees * scale[row]
        square = residual[row] ** 2
        log_density -= 0.5 * math.log(scale[row])
        log_density -= 0.5 * (degrees + 1) * math.log1p(square / spread)
        weight[row] = (degrees + 1) * (spread - square) / (spread + square) ** 2
    _information(columns, weight, precision, matrix)
    if not _factorize(matrix):
        # An outlier bends the surface the other way: what is expected of it is positive.
        for row in range(rows):
            weight[row] = (degrees + 1) / ((degrees + 3) * scale[row])
        _information(columns, weight, precision, matrix)
        if not _factorize(matrix):
            return -np.inf
    log_density += rows * (
        math.lgamma(0.5 * (degrees + 1))
        - math.lgamma(0.5 * degrees)
        - 0.5 * math.log(degrees * math.pi)
    )
    for i in range(size):
        log_density += 0.5 * math.log(2 * math.pi) - math.log(matrix[i, i])
        if precision[i] > 0:
            log_density += 0.5 * (math.log(precision[i] / (2 * math.pi)))
            log_density -= 0.5 * precision[i] * beta[i] ** 2
    density = 2 / math.pi * scatter * scatter_prior / (scatter**2 + scatter_prior**2)
    return float(log_density + math.log(density))


@compiled
def _peak(
    columns: Floats, value: Floats, variance: Floats, precision: Floats, degrees: float,
    scatter_prior: float, start: float, beta: Floats, matrix: Floats,
) -> tuple[float, float, float]:  # fmt: skip
    """Likeliest log scatter, its log evidence and the curvature there."""
    at = start
    curvature, middle = _LEAST_CURVATURE, -np.inf
    for _ in range(_MAX_SEARCHES):
        middle = _log_evidence(
            columns, value, variance, precision, degrees, scatter_prior, at, beta, matrix
        )
        below = _log_evidence(
            columns, value, variance, precision, degrees, scatter_prior, at - _STEP, beta, matrix
        )
        above = _log_evidence(
            columns, value, variance, precision, degrees, scatter_prior, at + _STEP, beta, matrix
        )
        slope = (above - below) / (2 * _STEP)
        curvature = max((2 * middle - above - below) / _STEP**2, _LEAST_CURVATURE)
        move = min(max(slope / curvature, -_MAX_MOVE), _MAX_MOVE)
        if abs(move) < 0.5 * _STEP:
            return at + move, middle + 0.5 * slope * move, curvature
        at += move
    return at, middle, curvature


@compiled
def _step_evidences(
    columns: Floats, value: Floats, variance: Floats, precision: Floats, step_precision: float,
    degrees: float, scatter_prior: float, start: float, steps: NDArray[np.int64],
) -> Floats:  # fmt: skip
    fixed, rows = columns.shape
    count = steps.shape[1]
    size = fixed + count
    full, prior = np.zeros((size, rows)), np.full(size, step_precision)
    full[:fixed], prior[:fixed] = columns, precision
    matrix, found = np.empty((size, size)), np.empty(steps.shape[0])
    first = np.zeros(size)
    for one in range(steps.shape[0]):
        for k in range(count):
            for row in range(rows):
                full[fixed + k, row] = 1.0 if row >= steps[one, k] else 0.0
        beta = first.copy()
        at, log_evidence, curvature = _peak(
            full, value, variance, prior, degrees, scatter_prior, start, beta, matrix
        )
        start = at
        if one == 0:
            first = beta
        found[one] = log_evidence + 0.5 * math.log(2 * math.pi / curvature)
    return found


def step_evidences(model: StudentModel, steps: NDArray[np.int64], step_precision: float) -> Floats:
    """Log evidences of m sets of k steps, (m,).

    Parameters
    ----------
    model : StudentModel
        Rows in the order of time.
    steps : (m, k) int array
        The first row after each step.
    step_precision : float
        Of the normal prior of their sizes.
    """
    return np.asarray(
        _step_evidences(
            np.ascontiguousarray(model.columns.T), model.value, model.variance, model.precision,
            step_precision, model.degrees, model.scatter_prior, model.log_scatter,
            np.ascontiguousarray(steps),
        )
    )  # fmt: skip


@compiled
def _scatter_nodes(
    columns: Floats, value: Floats, variance: Floats, precision: Floats, degrees: float,
    scatter_prior: float, start: float, places: Floats,
) -> tuple[float, Floats, Floats, Floats, Floats]:  # fmt: skip
    size = columns.shape[0]
    beta, matrix = np.zeros(size), np.empty((size, size))
    peak, _, curvature = _peak(
        columns, value, variance, precision, degrees, scatter_prior, start, beta, matrix
    )
    width = 1 / math.sqrt(curvature)
    log_share, scatter = np.empty(places.size), np.empty(places.size)
    mode, covariance = np.empty((places.size, size)), np.empty((places.size, size, size))
    unit = np.empty(size)
    for node in range(places.size):
        at = peak + places[node] * width
        log_share[node] = _log_evidence(
            columns, value, variance, precision, degrees, scatter_prior, at, beta, matrix
        )
        scatter[node] = math.exp(at)
        mode[node] = beta
        for i in range(size):
            unit[:] = 0.0
            unit[i] = 1.0
            _solve(matrix, unit)
            covariance[node, :, i] = unit
    return math.log(width), log_share, scatter, mode, covariance


def scatter_nodes(model: StudentModel, places: Floats) -> ScatterNodes:
    """The posterior of a regression at several scatters.

    Parameters
    ----------
    model : StudentModel
    places : (q,) array
        Evenly spaced, about the likeliest scatter, in standard deviations of its logarithm.
    """
    log_width, log_share, scatter, mode, covariance = _scatter_nodes(
        np.ascontiguousarray(model.columns.T), model.value, model.variance, model.precision,
        model.degrees, model.scatter_prior, model.log_scatter, places,
    )  # fmt: skip
    highest = log_share.max()
    share = np.exp(log_share - highest)
    step = math.log(places[1] - places[0]) + log_width
    log_evidence = highest + math.log(share.sum()) + step
    return ScatterNodes(float(log_evidence), share / share.sum(), scatter, mode, covariance)
