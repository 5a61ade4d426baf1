"""Bayesian linear regression whose prior amplitudes are decided by the data.

The model is ``y = A beta + noise`` with beta ~ N(mean, height^2 d), where d is 1 for free
directions and exp(2 a_k) within block k of the prior. The log amplitudes a_k have normal
hyperpriors; they are set to the mode of the marginal likelihood by Newton's method with the
exact Hessian, and their own uncertainty (Laplace) enters the covariance of beta. One Cholesky
factor a step serves all of it (MacKay 1992, doi:10.1162/neco.1992.4.3.415, gives the evidence).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_lapack_funcs

from acutance.curves.grid import Floats

__all__ = ["Posterior", "Prior", "regress"]

_MAX_STEPS = 12
_CURVATURE_FLOOR = 0.05
_potrf, _trtri = get_lapack_funcs(("potrf", "trtri"), (np.empty((1, 1)),))


@dataclass(frozen=True, eq=False)
class Prior:
    """Prior of the coefficients.

    Attributes
    ----------
    block : (m,) int array
        Which amplitude rules each coefficient; -1 for one with a scale of its own.
    scale : (m,) array
        Standard deviation of a coefficient whose block is -1, relative to `height`.
    mean : (m,) array
        Prior mean, in data units.
    log_amplitude : (k,) array
        Hyperprior mean of the logarithm of every block's amplitude, relative to `height`.
    log_amplitude_std : float
        Its standard deviation.
    height : float
        Height of the edge, in data units.
    noise_floor : float
        The smallest noise (standard deviation, data units) the arithmetic allows for.
    """

    block: Floats
    scale: Floats
    mean: Floats
    log_amplitude: Floats
    log_amplitude_std: float
    height: float
    noise_floor: float


@dataclass(frozen=True, eq=False)
class Posterior:
    """What the data and the prior say of the coefficients.

    Attributes
    ----------
    beta : (m,) array
        Posterior mean.
    factor : (m, m + k) array
        Factor of the covariance of beta; the last k columns are the amplitudes' share.
    log_amplitude : (k,) array
    variance : float
        Noise variance for unit weight.
    freedom : float
        Degrees of freedom the data spent on the coefficients.
    """

    beta: Floats
    factor: Floats
    log_amplitude: Floats
    variance: float
    freedom: float


def regress(
    gram: Floats, projection: Floats, data: float, count: int, prior: Prior, inflation: float = 1.0
) -> Posterior:
    """Fit coefficients, prior amplitudes and noise variance together.

    Parameters
    ----------
    gram : (m, m) array
        A^T W A.
    projection : (m,) array
        A^T W y.
    data : float
        y^T W y.
    count : int
        Number of data.
    prior : Prior
    inflation : float, optional
        Factor on the noise variance for correlated noise (>= 1 for low-pass noise).
    """
    groups = [np.flatnonzero(prior.block == k) for k in range(int(prior.block.max()) + 1)]
    spans = [slice(int(g[0]), int(g[-1]) + 1) for g in groups]
    wish, wish_precision = prior.log_amplitude, 1 / prior.log_amplitude_std**2
    tau = wish.copy()
    floor = prior.noise_floor**2
    sigma = prior.scale * prior.height
    variance = max((data - _explained(gram, projection)) / max(count - 12, 1), floor)
    diagonal = np.arange(gram.shape[0])
    for _ in range(_MAX_STEPS):
        for k, span in enumerate(spans):
            sigma[span] = np.exp(tau[k]) * prior.height
        noise = variance * inflation
        whitened = gram * (sigma[:, None] * (sigma / noise))
        whitened[diagonal, diagonal] += 1.0
        lower, _ = _potrf(whitened, lower=1, clean=1)
        inverse, _ = _trtri(lower, lower=1)
        covariance = inverse.T @ inverse
        coefficient = covariance @ (sigma * projection / noise + prior.mean / sigma)
        beta = sigma * coefficient
        step, moves, spread = _amplitude_step(
            covariance, coefficient, spans, tau - wish, wish_precision
        )
        freedom = float(len(diagonal) - np.trace(covariance))
        misfit = max(data - 2 * beta @ projection + beta @ gram @ beta, 0.0)
        updated = max(misfit / max(count - freedom, 1.0), floor)
        settled = abs(updated / variance - 1) < 0.01 and np.max(np.abs(step)) < 0.05
        if settled:
            break
        variance = updated
        tau = tau + step
    hyper = sigma[:, None] * (moves @ spread)
    factor = np.hstack([sigma[:, None] * inverse.T, hyper])
    return Posterior(beta, factor, tau, variance, freedom)


def _explained(gram: Floats, projection: Floats) -> float:
    """What a ridge regression explains of the data: enough for a first noise estimate."""
    ridge = 1e-6 * float(np.trace(gram)) / len(gram)
    solution = np.linalg.solve(gram + ridge * np.eye(len(gram)), projection)
    return float(2 * solution @ projection - solution @ gram @ solution)


def _amplitude_step(
    covariance: Floats, coefficient: Floats, spans: list[slice], beyond: Floats, precision: float
) -> tuple[Floats, Floats, Floats]:
    """One Newton step of the log amplitudes on the log marginal likelihood.

    In whitened coordinates (prior covariance 1) with posterior covariance N and mean m, for
    the log amplitudes a_j

        gradient_k    = |m_k|^2 + tr N_kk - r_k - (a_k - a0) / s^2
        hessian_kj    = 4 m_k (N E_j m)_k + 2 |N_kj|^2
                        - delta_kj (2 |m_k|^2 + 2 tr N_kk + 1 / s^2)
        d beta / d a_j = 2 sigma N E_j m

    Returns
    -------
    step : (k,) array
    moves : (m, k) array
        d beta / d a_j in whitened coordinates.
    spread : (k, k) array
        Factor of the covariance of the log amplitudes.
    """
    count = len(spans)
    moves = np.stack([covariance[:, span] @ coefficient[span] for span in spans], axis=1)
    gradient = np.empty(count)
    hessian = np.empty((count, count))
    for k, span in enumerate(spans):
        mean = coefficient[span]
        evidence = mean @ mean + np.trace(covariance[span, span])
        gradient[k] = evidence - (span.stop - span.start) - beyond[k] * precision
        hessian[k] = 4 * mean @ moves[span]
        for j, other in enumerate(spans):
            hessian[k, j] += 2 * np.sum(covariance[span, other] ** 2)
        hessian[k, k] -= 2 * evidence + precision
    power, axes = np.linalg.eigh(-hessian)
    step = axes @ ((axes.T @ gradient) / np.maximum(np.abs(power), _CURVATURE_FLOOR))
    spread = axes / np.sqrt(np.maximum(power, precision / 4))
    return np.clip(step, -1.0, 1.0), 2 * moves, spread
