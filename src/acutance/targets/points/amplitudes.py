"""Which prior amplitudes of the PSF the data favour, and what follows where they are open.

The marginal likelihood can have several modes: the same pixels may show the wings of an aperture,
or none and a more crooked core. While the sources still move, the likeliest mode is followed; at
the end the amplitude of halos is integrated over, so that what is not seen enters the uncertainty.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from scipy.linalg import solve_triangular

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import (
    Posterior,
    Prior,
    log_evidence,
    log_evidence_slopes,
    regress,
    whiten,
)
from acutance.numerics.normal_equations import Normal
from acutance.numerics.pivoted_root import covariance_root
from acutance.targets.points import tuned
from acutance.targets.points.per_source import Blocks

__all__ = [
    "averaged_posterior",
    "determined_directions",
    "likelier_posterior",
    "likeliest_growth",
    "posterior_log_evidence",
]

_HALO = list(tuned.FAMILY_LOG_AMPLITUDES).index("halo")
_MIN_WEIGHT: Final = 0.003


def likelier_posterior(
    normal: Normal, prior: Prior, variance: float, inflation: float, earlier: Posterior | None
) -> Posterior:
    """The likeliest one of some modes: that near an `earlier` one, and those of other starts.

    The parameters are those of `acutance.numerics.marginal_likelihood.regress`.
    """
    starts = [_from(prior, variance, one) for one in tuned.LOG_AMPLITUDE_STARTS]
    found = [regress(normal, prior, variance, inflation, start) for start in [*starts, earlier]]
    return max(found, key=lambda one: posterior_log_evidence(normal, prior, one, inflation))


def posterior_log_evidence(
    normal: Normal, prior: Prior, found: Posterior, inflation: float
) -> float:
    """Log evidence at a posterior's amplitudes and noise, which may differ between posteriors."""
    noise = found.variance * inflation
    level = 0.5 * normal.count / inflation * math.log(noise)
    return log_evidence(normal, prior, found.log_amplitude, noise) - level


def averaged_posterior(
    normal: Normal, prior: Prior, inflation: float, likeliest: Posterior
) -> Posterior:
    """The posterior with the amplitude of halos integrated over.

    At the likeliest amplitude alone, halos that the data neither show nor exclude would be taken
    for absent. It runs over a grid, each point weighted by its likelihood; what the other
    amplitudes leave open enters to first order, that one held: the grid has its share.

    Parameters
    ----------
    normal, prior, inflation
        As `acutance.numerics.marginal_likelihood.regress` takes them.
    likeliest : Posterior
        What it found.
    """
    noise = likeliest.variance * inflation
    mode = likeliest.log_amplitude
    points = [mode, *(_at(mode, a) for a in tuned.HALO_GRID)]
    likelihood = np.array([log_evidence(normal, prior, point, noise) for point in points])
    weights = np.exp(likelihood - likelihood.max())
    weights[weights < _MIN_WEIGHT * weights.sum()] = 0.0
    weights /= weights.sum()
    kept = [
        (weight, whiten(normal, prior, point, noise))
        for weight, point in zip(weights.tolist(), points, strict=True)
        if weight > 0
    ]
    mean = np.asarray(sum(w * one.sigma * one.mean for w, one in kept))
    covariance = np.zeros((mean.size, mean.size))
    for w, one in kept:
        covariance += w * one.covariance * np.outer(one.sigma, one.sigma)
        away = one.sigma * one.mean - mean
        covariance += w * np.outer(away, away)
    factor = covariance_root(covariance)
    share = _share_of_others(normal, prior, mode, noise)
    return Posterior(
        mean, np.hstack([factor, share]), likeliest.prior_std, mode, likeliest.variance,
        likeliest.freedom,
    )  # fmt: skip


def _share_of_others(normal: Normal, prior: Prior, mode: Floats, noise: float) -> Floats:
    """Factor of what the amplitudes but that of halos leave open, it held, (m, k - 1)."""
    others = np.delete(np.arange(mode.size), _HALO)
    white = whiten(normal, prior, mode, noise)
    found = log_evidence_slopes(white, prior, mode)
    curvature, axes = np.linalg.eigh(-found.hessian[np.ix_(others, others)])
    # No amplitude is less certain than before the data.
    factor = axes / np.sqrt(np.maximum(curvature, 1 / prior.log_amplitude_std**2))
    return np.asarray(white.sigma[:, None] * (found.by_amplitude[:, others] @ factor))


def determined_directions(
    normal: Normal, prior: Prior, log_amplitude: Floats, noise: float
) -> Floats:
    """Combinations of coefficients, of unit prior variance, that the data determine in part.

    Returns
    -------
    (m, r) array
        Orthonormal in units of the prior; r is what is worth keeping.
    """
    sigma = prior.std(log_amplitude)
    power, axes = np.linalg.eigh(sigma[:, None] * normal.gram * (sigma / noise))
    return np.asarray(sigma[:, None] * axes[:, power > tuned.DETERMINED_POWER])


def likeliest_growth(
    solved: Callable[[float], tuple[Blocks, float]], noise: float, brightest: float
) -> float:
    """How much the noise grows with the light, by the marginal likelihood.

    Parameters
    ----------
    solved : callable
        For a growth (variance per unit of light over that of the background), the eliminated
        system in coefficients of unit prior variance, and the sum of the logarithms of the
        weights.
    noise : float
        Variance of the background's noise, its correlation included.
    brightest : float
        Light in the brightest pixel.

    Returns
    -------
    float
        0 where growth is not clearly likelier than none.
    """

    def of_growth(growth: float) -> float:
        blocks, weights = solved(growth)
        normal = blocks.normal
        precision = normal.gram / noise
        precision[np.diag_indices_from(precision)] += 1.0
        lower = np.linalg.cholesky(precision)
        explained = float(np.sum(solve_triangular(lower, normal.projection, lower=True) ** 2))
        misfit = (normal.data - explained / noise) / noise
        volume = float(np.log(np.diagonal(lower)).sum())
        return 0.5 * (weights - misfit) - volume + blocks.log_volume

    ratios = np.array(tuned.BRIGHTEST_OVER_DARK)
    values = np.array([of_growth(ratio / brightest) for ratio in ratios.tolist()])
    best = int(np.argmax(values))
    if values[best] < of_growth(0.0) + tuned.GROWTH_LOG_EVIDENCE:
        return 0.0
    place = float(np.clip(best, 1, ratios.size - 2))
    below, middle, above = values[int(place) - 1 : int(place) + 2].tolist()
    bend = below - 2 * middle + above
    shift = float(np.clip(0.5 * (below - above) / bend, -1, 1)) if bend < 0 else best - place
    step = math.log(ratios[1] / ratios[0])
    return float(ratios[int(place)] * math.exp(step * shift)) / brightest


def _at(mode: Floats, log_amplitude: float) -> Floats:
    """The mode with another amplitude of the halos."""
    point = mode.copy()
    point[_HALO] = log_amplitude
    return point


def _from(prior: Prior, variance: float, log_amplitude: Floats) -> Posterior:
    """A posterior without coefficients, as the first guess of amplitudes and noise."""
    nothing = np.zeros(prior.block.size)
    return Posterior(nothing, nothing[:, None], nothing, log_amplitude, variance, 0.0)
