"""Bayesian linear regression whose prior amplitudes are decided by the data.

The model is ``y = A beta + noise`` with beta ~ N(mean, height^2 d), where d is 1 for free
directions and exp(2 a_k) within block k of the prior. The log amplitudes a_k have normal
hyperpriors; they are set to the mode of the marginal likelihood by Newton's method with the
exact Hessian, and their own uncertainty (Laplace) enters the covariance of beta. One Cholesky
factor a step serves all of it (MacKay 1992, doi:10.1162/neco.1992.4.3.415, gives the evidence).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import get_lapack_funcs

from acutance.curves.grid import Floats
from acutance.fit.normal import Normal

__all__ = ["Evidence", "Posterior", "Prior", "Whitened", "evidence_of", "regress", "whiten"]

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

    @cached_property
    def members(self) -> Floats:
        """(m, k): 1 where a coefficient belongs to a block, else 0."""
        return np.asarray(self.block[:, None] == np.arange(self.log_amplitude.size), float)


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
    normal: Normal,
    prior: Prior,
    variance: float,
    inflation: float = 1.0,
    earlier: Posterior | None = None,
) -> Posterior:
    """Fit coefficients, prior amplitudes and noise variance together.

    Parameters
    ----------
    normal : Normal
        The data's normal equations in the m coefficients.
    prior : Prior
    variance : float
        First guess of the noise variance for unit weight.
    inflation : float, optional
        Factor on the noise variance for correlated noise (>= 1 for low-pass noise).
    earlier : Posterior, optional
        Solution of nearly the same problem: its amplitudes are the first guess.
    """
    floor = prior.noise_floor**2
    variance = max(variance, floor)
    log_amplitude = prior.log_amplitude if earlier is None else earlier.log_amplitude
    for _ in range(_MAX_STEPS):
        white = whiten(normal, prior, log_amplitude, variance * inflation)
        evidence = evidence_of(white, prior, log_amplitude)
        step = evidence.step()
        beta = white.sigma * white.mean
        freedom = float(beta.size - np.trace(white.covariance))
        misfit = normal.data - 2 * beta @ normal.projection + beta @ normal.gram @ beta
        updated = max(float(misfit) / max(normal.count - freedom, 1.0), floor)
        if abs(updated / variance - 1) < 0.01 and bool(np.all(np.abs(step) < 0.05)):
            break
        variance = updated
        log_amplitude = log_amplitude + step
    moves = evidence.moves @ evidence.spread()
    factor = white.sigma[:, None] * np.hstack([white.root, moves])
    return Posterior(beta, factor, log_amplitude, variance, freedom)


@dataclass(frozen=True, eq=False)
class Whitened:
    """The posterior at given amplitudes and noise, in units of the prior.

    Attributes
    ----------
    sigma : (m,) array
        Prior standard deviations: beta is ``sigma * mean``.
    mean : (m,) array
    covariance : (m, m) array
        ``root @ root.T``.
    root : (m, m) array
    """

    sigma: Floats
    mean: Floats
    covariance: Floats
    root: Floats


def whiten(normal: Normal, prior: Prior, log_amplitude: Floats, noise: float) -> Whitened:
    """Posterior mean and covariance at given amplitudes and noise variance, by one Cholesky."""
    sigma = prior.height * prior.scale * np.exp(prior.members @ log_amplitude)
    precision = normal.gram * (sigma[:, None] * (sigma / noise))
    precision.reshape(-1)[:: sigma.size + 1] += 1.0
    # The transpose is laid out as Fortran wants it: nothing is copied.
    lower, _ = _potrf(precision.T, lower=1, clean=1, overwrite_a=1)
    inverse, _ = _trtri(lower, lower=1, overwrite_c=1)
    root = inverse.T
    covariance = root @ inverse
    mean = covariance @ (sigma * normal.projection / noise + prior.mean / sigma)
    return Whitened(sigma, mean, covariance, root)


@dataclass(frozen=True, eq=False)
class Evidence:
    """How the logarithm of the evidence depends on the log amplitudes.

    Attributes
    ----------
    gradient : (k,) array
    hessian : (k, k) array
    moves : (m, k) array
        Derivative of the whitened coefficients by the log amplitudes.
    floor : float
        The least curvature the uncertainty of the amplitudes is computed with.
    """

    gradient: Floats
    hessian: Floats
    moves: Floats
    floor: float

    def step(self) -> Floats:
        """One bounded Newton step of the log amplitudes, uphill also where it is not concave."""
        power, axes = np.linalg.eigh(-self.hessian)
        power = np.maximum(np.abs(power), _CURVATURE_FLOOR)
        return np.asarray(np.clip(axes @ ((axes.T @ self.gradient) / power), -1.0, 1.0))

    def spread(self) -> Floats:
        """Factor of the covariance of the log amplitudes (Laplace), (k, k)."""
        power, axes = np.linalg.eigh(-self.hessian)
        return np.asarray(axes / np.sqrt(np.maximum(power, self.floor)))


def evidence_of(white: Whitened, prior: Prior, log_amplitude: Floats) -> Evidence:
    """Slope and curvature of the log evidence, hyperprior included, at a whitened posterior.

    With posterior covariance N and mean m in whitened coordinates, and E_j the projector on
    block j of r_j coefficients, for the log amplitudes a_j

        gradient_k     = |m_k|^2 + tr N_kk - r_k - (a_k - a0) / s^2
        hessian_kj     = 4 m_k (N E_j m)_k + 2 |N_kj|^2
                         - delta_kj (2 |m_k|^2 + 2 tr N_kk + 1 / s^2)
        d beta / d a_j = 2 sigma N E_j m
    """
    members, precision = prior.members, 1 / prior.log_amplitude_std**2
    own = members * white.mean[:, None]
    moves = 2 * white.covariance @ own
    explained = (white.mean**2 + white.covariance.diagonal()) @ members
    gradient = explained - members.sum(axis=0)
    gradient -= (log_amplitude - prior.log_amplitude) * precision
    hessian = 2 * own.T @ moves + 2 * members.T @ white.covariance**2 @ members
    hessian.reshape(-1)[:: gradient.size + 1] -= 2 * explained + precision
    return Evidence(gradient, hessian, moves, precision / 4)
