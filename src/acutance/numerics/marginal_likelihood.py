"""Bayesian linear regression whose prior amplitudes are decided by the data.

The model is ``y = A beta + noise`` with beta ~ N(mean, height^2 d), where d is 1 for free
directions and exp(2 a_k) within block k of the prior. The log amplitudes a_k have normal
hyperpriors; they are set to the mode of the marginal likelihood by Newton's method with the
exact Hessian, and their own uncertainty (Laplace) enters the covariance of beta. One Cholesky
factor a step is enough for all of it (MacKay 1992, doi:10.1162/neco.1992.4.3.415, derives the
marginal likelihood; its logarithm is called the log evidence here).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs, solve_triangular

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.compiled import compiled
from acutance.numerics.normal_equations import Normal
from acutance.numerics.small_matrices import lower_inverse, lower_square

__all__ = [
    "LogEvidence",
    "Posterior",
    "Prior",
    "Whitened",
    "likeliest_amplitudes",
    "log_evidence",
    "log_evidence_slopes",
    "regress",
    "whiten",
]

_MAX_STEPS = 12
_MIN_CURVATURE = 0.05
_MAX_STEP_DOWN, _MAX_STEP_UP = 4.0, 1.5
_SETTLED_NOISE = 0.02
_SETTLED_AMPLITUDE = 0.1
"""A last step this short is taken to first order."""
(_syev,) = get_lapack_funcs(("syev",), (np.empty((1, 1)),))


@dataclass(frozen=True, eq=False)
class Prior:
    """Prior of the coefficients.

    Attributes
    ----------
    block : (m,) int array
        Block of each coefficient, whose amplitude it has; -1 for one with a scale of its own.
    scale : (m,) array
        Standard deviation of a coefficient whose block is -1, relative to `height`.
    mean : (m,) array
        Prior mean, in data units.
    log_amplitude : (k,) array
        Hyperprior mean of the logarithm of every block's amplitude, relative to `height`.
    log_amplitude_std : float or (k,) array
        Its standard deviation, of all blocks or of each.
    height : float
        Height of the edge, in data units.
    noise_floor : float
        The smallest noise (standard deviation, data units) the arithmetic allows for.
    """

    block: Floats
    scale: Floats
    mean: Floats
    log_amplitude: Floats
    log_amplitude_std: float | Floats
    height: float
    noise_floor: float

    @cached_property
    def own_block(self) -> NDArray[np.intp]:
        """Block of each coefficient as integers, (m,)."""
        return np.asarray(self.block, np.intp)

    @cached_property
    def sizes(self) -> Floats:
        """Number of coefficients in every block, (k,)."""
        own = self.own_block[self.own_block >= 0]
        return np.bincount(own, minlength=self.log_amplitude.size).astype(float)

    @cached_property
    def precision(self) -> Floats:
        """Inverse variances of the log amplitudes, (k,)."""
        every = np.broadcast_to(np.asarray(self.log_amplitude_std, float), self.log_amplitude.shape)
        return np.asarray(1 / np.square(every))

    @cached_property
    def own_scale(self) -> Floats:
        """Standard deviations in data units, (m,), where every amplitude is one."""
        return self.height * self.scale

    def std(self, log_amplitude: Floats) -> Floats:
        """Standard deviations at some amplitudes, (m,), in data units."""
        return _prior_std(self.own_scale, self.own_block, log_amplitude)


@dataclass(frozen=True, eq=False)
class Posterior:
    """The coefficients, as determined by the data and the prior.

    Attributes
    ----------
    beta : (m,) array
        Posterior mean.
    factor : (m, m + k) array
        Factor of the covariance of beta: upper triangular, then k columns, the share of the
        amplitudes.
    prior_std : (m,) array
        Standard deviations of the prior at the amplitudes of the factor, in data units.
    log_amplitude : (k,) array
    variance : float
        Noise variance for unit weight.
    freedom : float
        Degrees of freedom the data spent on the coefficients.
    """

    beta: Floats
    factor: Floats
    prior_std: Floats
    log_amplitude: Floats
    variance: float
    freedom: float


def regress(
    normal: Normal,
    prior: Prior,
    variance: float,
    inflation: float = 1.0,
    earlier: Posterior | None = None,
    pixels: Normal | None = None,
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
    pixels : Normal, optional
        Equations whose misfit tells the noise variance, where a random process was integrated out
        of `normal`.
    """
    pixels = normal if pixels is None else pixels
    floor = prior.noise_floor**2
    variance = max(variance, floor)
    log_amplitude = prior.log_amplitude if earlier is None else earlier.log_amplitude
    for _ in range(_MAX_STEPS):
        white = whiten(normal, prior, log_amplitude, variance * inflation)
        slopes = log_evidence_slopes(white, prior, log_amplitude)
        step = slopes.step()
        beta = white.sigma * white.mean
        freedom = beta.size - white.undetermined
        updated = max(pixels.misfit(beta) / max(pixels.count - freedom, 1.0), floor)
        settled = abs(updated / variance - 1) < _SETTLED_NOISE
        variance, log_amplitude = updated, log_amplitude + step
        if settled and float(np.abs(step).max()) < _SETTLED_AMPLITUDE:
            break
    beta += white.sigma * (slopes.by_amplitude @ step)
    m = beta.size
    factor = np.empty((m, m + step.size))
    factor[:, :m] = white.root
    factor[:, m:] = slopes.by_amplitude @ slopes.covariance_factor()
    factor *= white.sigma[:, None]
    return Posterior(beta, factor, white.sigma, log_amplitude, variance, freedom)


def likeliest_amplitudes(
    normal: Normal,
    prior: Prior,
    log_amplitude: Floats,
    noise: float,
    *,
    tolerance: float = _SETTLED_AMPLITUDE,
    most: int = _MAX_STEPS,
) -> Floats:
    """Log amplitudes at the mode of the log evidence, the noise variance being known, (k,).

    From a first guess, by at `most` so many Newton steps, until one is shorter than `tolerance`.
    """
    for _ in range(most):
        white = whiten(normal, prior, log_amplitude, noise)
        step = log_evidence_slopes(white, prior, log_amplitude).step()
        log_amplitude = log_amplitude + step
        if float(np.abs(step).max()) < tolerance:
            break
    return log_amplitude


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

    @property
    def variances(self) -> Floats:
        """Variances of the whitened coefficients, (m,): 1 for what the data do not determine."""
        return self.covariance.diagonal()

    @property
    def undetermined(self) -> float:
        """Sum of the variances: number of coefficients that the data leave undetermined."""
        return float(np.add.reduce(self.variances))


def whiten(normal: Normal, prior: Prior, log_amplitude: Floats, noise: float) -> Whitened:
    """Posterior mean and covariance at given amplitudes and noise variance, by one Cholesky."""
    sigma = prior.std(log_amplitude)
    try:
        mean, covariance, inverse = _whitened(
            normal.gram, normal.projection, sigma, prior.mean, noise
        )
    except np.linalg.LinAlgError:
        raise _unsolvable() from None
    return Whitened(sigma, mean, covariance, inverse.T)


@compiled
def _whitened(
    gram: Floats, projection: Floats, sigma: Floats, mean: Floats, noise: float
) -> tuple[Floats, Floats, Floats]:
    """Mean (m,) and covariance (m, m) of the whitened coefficients, and the inverse of a factor of
    the latter's inverse."""
    precision, pull = _whitened_equations(gram, projection, sigma, mean, noise)
    inverse = lower_inverse(np.asarray(np.linalg.cholesky(precision), np.float64))
    covariance, found = lower_square(inverse), np.zeros(sigma.size)
    for i in range(sigma.size):
        for j in range(sigma.size):
            found[i] += covariance[i, j] * pull[j]
    return found, covariance, inverse


@compiled
def _prior_std(scale: Floats, block: NDArray[np.intp], log_amplitude: Floats) -> Floats:
    """Prior standard deviations of the coefficients at given amplitudes, (m,)."""
    found, amplitude = scale.copy(), np.exp(log_amplitude)
    for i in range(block.size):
        if block[i] >= 0:
            found[i] *= amplitude[block[i]]
    return found


@compiled
def _whitened_equations(
    gram: Floats, projection: Floats, sigma: Floats, mean: Floats, noise: float
) -> tuple[Floats, Floats]:
    """Inverse covariance of the whitened coefficients, (m, m), and that times their mean, (m,)."""
    precision, pull = np.empty(gram.shape), np.empty(sigma.size)
    weighted = sigma / noise
    for i in range(sigma.size):
        for j in range(sigma.size):
            precision[i, j] = sigma[i] * gram[i, j] * weighted[j]
        precision[i, i] += 1.0
        pull[i] = weighted[i] * projection[i] + mean[i] / sigma[i]
    return precision, pull


def _unsolvable() -> TargetError:
    """Of equations that LAPACK refuses: mostly pixels or first fits are not finite."""
    return TargetError(
        "the pixels do not determine the model: its equations have no solution; choose a region "
        "with one target and without pixels that are not finite"
    )


@dataclass(frozen=True, eq=False)
class LogEvidence:
    """Derivatives of the log evidence by the log amplitudes.

    Attributes
    ----------
    gradient : (k,) array
    hessian : (k, k) array
    by_amplitude : (m, k) array
        Derivative of the whitened coefficients by the log amplitudes.
    min_curvature : float
        Lower bound of the curvature from which the uncertainty of the amplitudes is computed.
    """

    gradient: Floats
    hessian: Floats
    by_amplitude: Floats
    min_curvature: float

    @cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        """Principal curvatures, positive at a maximum of the log evidence, and their axes."""
        power, axes, failed = _syev(-self.hessian)
        if failed:
            raise _unsolvable()
        return power, axes

    def step(self) -> Floats:
        """One bounded Newton step of the log amplitudes, uphill also where it is not concave."""
        power, axes = self._axes
        power = np.maximum(np.abs(power), _MIN_CURVATURE)
        step = axes @ ((self.gradient @ axes) / power)
        return np.asarray(np.minimum(np.maximum(step, -_MAX_STEP_DOWN), _MAX_STEP_UP))

    def covariance_factor(self) -> Floats:
        """Factor of the covariance of the log amplitudes (Laplace), (k, k)."""
        power, axes = self._axes
        return np.asarray(axes / np.sqrt(np.maximum(power, self.min_curvature)))


def log_evidence(normal: Normal, prior: Prior, log_amplitude: Floats, noise: float) -> float:
    """Log evidence at given amplitudes and noise variance, hyperprior included.

    Up to a constant and the level of the noise, which those have in common that are compared at
    one noise.
    """
    sigma = prior.std(log_amplitude)
    left = normal.projection - normal.gram @ prior.mean
    precision, pull = _whitened_equations(normal.gram, left, sigma, np.zeros(sigma.size), noise)
    lower = np.linalg.cholesky(precision)
    seen = solve_triangular(lower, pull, lower=True)
    beyond = normal.data - float(prior.mean @ (normal.projection + left))
    away = (log_amplitude - prior.log_amplitude) / prior.log_amplitude_std
    misfit = beyond / noise - float(seen @ seen) + float(away @ away)
    return -0.5 * misfit - float(np.log(np.diagonal(lower)).sum())


def log_evidence_slopes(white: Whitened, prior: Prior, log_amplitude: Floats) -> LogEvidence:
    """Gradient and Hessian of the log evidence, hyperprior included, at a whitened posterior.

    With posterior covariance N and mean m in whitened coordinates, and E_j the projector on
    block j of r_j coefficients, for the log amplitudes a_j

        gradient_k     = |m_k|^2 + tr N_kk - r_k - (a_k - a0) / s^2
        hessian_kj     = 4 m_k (N E_j m)_k + 2 |N_kj|^2
                         - delta_kj (2 |m_k|^2 + 2 tr N_kk + 1 / s^2)
        d beta / d a_j = 2 sigma N E_j m
    """
    precision = prior.precision
    shifts, explained, crossed = _block_sums(
        white.covariance, white.mean, prior.own_block, prior.sizes.size
    )
    gradient = explained - prior.sizes - (log_amplitude - prior.log_amplitude) * precision
    crossed.reshape(-1)[:: gradient.size + 1] -= 2 * explained + precision
    return LogEvidence(gradient, crossed, shifts, float(precision.min()) / 4)


@compiled
def _block_sums(
    covariance: Floats, mean: Floats, block: NDArray[np.intp], blocks: int
) -> tuple[Floats, Floats, Floats]:
    """What the slopes of the log evidence consist of, block by block.

    With the covariance N (m, m) and the mean m (m,), and -1 the block of what belongs to none:
    ``2 N E_j m`` (m, k), ``|m_k|^2 + tr N_kk`` (k,), ``4 m_k (N E_j m)_k + 2 |N_kj|^2`` (k, k).
    """
    size = mean.size
    shifts, squares = np.zeros((blocks, size)), np.zeros((blocks, size))
    explained, crossed = np.zeros(blocks), np.zeros((blocks, blocks))
    for i in range(size):
        own, twice = block[i], 2 * mean[i]
        if own >= 0:
            explained[own] += mean[i] ** 2 + covariance[i, i]
            for j in range(size):
                shifts[own, j] += twice * covariance[i, j]
                squares[own, j] += covariance[i, j] ** 2
    for k in range(blocks):
        for i in range(size):
            if block[i] >= 0:
                crossed[k, block[i]] += 2 * (mean[i] * shifts[k, i] + squares[k, i])
    return shifts.T, explained, crossed
