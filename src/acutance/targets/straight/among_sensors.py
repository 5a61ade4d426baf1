"""The last pass of the reference estimator: the line spread function (LSF) as that of a sensor.

The passes before know the families of sensors by their principal directions, as if departures were
normally distributed about none. Here the prior is the density of the sensors themselves
(`sensor_density`), and the normal one for a sensor like none of them. All other unknowns keep the
prior, and the amplitudes, of those passes. Where the coordinates of the density cannot follow the
pixels (two edges within one blur, images of hardly any noise), the pass before is the last.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.integrated_out import integrated_out
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.normal_equations import Normal
from acutance.numerics.small_matrices import orthonormal_rows
from acutance.targets.straight import lsf_prior
from acutance.targets.straight.linear_model import Linear
from acutance.targets.straight.sensor_density import drawn_sensors
from acutance.targets.straight.spline import CELL, CELLS, SIZE, esf_from_lsf
from acutance.targets.straight.tuned import BROAD_PRIOR, KERNEL_FLOOR, MAX_SENSOR_MISFIT

__all__ = ["AmongSensors", "among_sensors"]

_DENSITY = -2
"""Block of the unknowns whose prior is the density of sensors."""
_FIRST = 5
"""Unknowns before these: dark level, level, width, place and aperture of the blur."""


@dataclass(frozen=True, eq=False)
class AmongSensors:
    """The linear model in coordinates of the density of sensors, solved.

    Attributes
    ----------
    linear : Linear
    posterior : Posterior
        Normal, of the mean and the covariance of the mixture.
    information : (n, n) array
        What the pixels say of level and LSF, the n first unknowns, where all others are known: the
        inverse of their covariance.
    alone : (n, n) array
        The same where the others are as uncertain as pixels and prior leave them.
    projection : (n,) array
        That times the values of the n unknowns.
    broad_prior : (n, n) array
        Covariance of a prior that leaves the LSF open.
    share : dict of str to float
        Probability of every family of sensors.
    """

    linear: Linear
    posterior: Posterior
    information: Floats
    alone: Floats
    projection: Floats
    broad_prior: Floats
    share: dict[str, float]


def among_sensors(
    linear: Linear, normal: Normal, before: Normal, posterior: Posterior, inflation: float
) -> AmongSensors:
    """Solve again, with the density of sensors as the prior of the LSF.

    Parameters
    ----------
    linear : Linear
        The linear model of the passes before.
    normal : Normal
        Its equations, of spline and regressors.
    before : Normal
        The same in its unknowns.
    posterior : Posterior
        Its solution.
    inflation : float
        Factor on the noise variance for correlated noise.
    """
    noise = posterior.variance * inflation
    own = _with_sensors(linear)
    r, q = linear.directions.block.size, drawn_sensors().basis.shape[1]
    n, mean = _FIRST + q, own.prior.mean
    equations = before.exchanged(normal, own.design, slice(_FIRST, n), slice(_FIRST, 1 + r))
    information, projection = equations.gram / noise, equations.projection / noise
    first, last = posterior.prior_std[:_FIRST], posterior.prior_std[1 + r :]
    std = np.concatenate([first, np.full(q, np.inf), last])
    lsf = integrated_out(information, projection + mean / std**2, last, slice(n), slice(n, None))
    sensor = integrated_out(
        lsf.information, lsf.projection, first, slice(_FIRST, None), slice(_FIRST)
    )
    height = linear.first_fit.height
    seen = drawn_sensors().seen(
        height**2 * sensor.information, height * sensor.projection,
        linear.first_fit.blur.width_px, _normal_prior(linear, posterior),
    )  # fmt: skip
    beta, covariance = lsf.all_unknowns(
        *sensor.all_unknowns(height * seen.mean, height**2 * seen.covariance)
    )
    if equations.misfit(beta) - before.misfit(posterior.beta) > MAX_SENSOR_MISFIT * noise:
        return _as_before(linear, before, posterior, noise)
    found = Posterior(
        beta, _upper_factor(covariance), std, posterior.log_amplitude, posterior.variance,
        freedom=float(np.vdot(covariance, information)),
    )  # fmt: skip
    prior = np.zeros((n, n))
    prior[:_FIRST, :_FIRST] = np.diag(first**2)
    prior[_FIRST:, _FIRST:] = (BROAD_PRIOR * height) ** 2 * drawn_sensors().second_moment
    alone = lsf.projection - (mean / std**2)[:n]
    return AmongSensors(
        own, found, information[:n, :n], lsf.information, alone, prior, seen.share
    )  # fmt: skip


def _as_before(linear: Linear, before: Normal, posterior: Posterior, noise: float) -> AmongSensors:
    """The solution of the passes before, of a sensor that the density cannot follow."""
    n = 1 + linear.directions.block.size
    broad, last = posterior.prior_std[:n].copy(), posterior.prior_std[n:]
    broad[_FIRST:] *= BROAD_PRIOR
    information, projection = before.gram / noise, before.projection / noise
    projection[n:] += linear.prior.mean[n:] / last**2
    lsf = integrated_out(information, projection, last, slice(n), slice(n, None))
    return AmongSensors(
        linear, posterior, information[:n, :n], lsf.information, lsf.projection,
        np.diag(broad**2), {"other": 1.0},
    )  # fmt: skip


@cache
def _sensor_columns() -> tuple[Floats, Floats, Floats]:
    """Of unit coordinates: spline without the tail, the tail, and the spline with it."""
    basis = drawn_sensors().basis
    esf, tail = esf_from_lsf(basis[:SIZE]), basis[SIZE]
    return esf, tail, esf + np.outer(lsf_prior.tail_spline(), tail)


def _with_sensors(linear: Linear) -> Linear:
    """The linear model whose directions of the LSF are those of the density."""
    esf, tail, spline = _sensor_columns()
    kept, q = _FIRST - 1, tail.size
    old, prior = linear.directions, linear.prior
    directions = lsf_prior.Directions(
        np.hstack([old.esf[:, :kept], esf]),
        np.concatenate([old.tail[:kept], tail]),
        np.concatenate([old.block[:kept], np.full(q, _DENSITY)]),
    )
    after = 1 + old.block.size
    design = np.zeros((len(linear.design), linear.design.shape[1] + _FIRST + q - after))
    design[:, :_FIRST] = linear.design[:, :_FIRST]
    design[:, _FIRST + q :] = linear.design[:, after:]
    design[: CELLS + 3, _FIRST : _FIRST + q] = spline
    design[CELLS + 3, _FIRST : _FIRST + q] = tail

    def exchanged(values: Floats, new: float) -> Floats:
        return np.concatenate([values[:_FIRST], np.full(q, new), values[after:]])

    prior = replace(
        prior,
        block=exchanged(prior.block, _DENSITY),
        scale=exchanged(prior.scale, 1.0),
        mean=exchanged(prior.mean, 0.0),
    )
    return replace(linear, directions=directions, design=design, prior=prior)


@cache
def _prior_columns() -> tuple[Floats, Floats]:
    """Of the directions of the prior with an amplitude: their LSF, and coordinates, (q, k)."""
    esf, tail = lsf_prior.fixed_directions()
    lsf = _lsf_of(esf)
    return lsf, drawn_sensors().basis.T @ np.vstack([lsf, tail])


def _lsf_of(esf: Floats) -> Floats:
    """Coefficients of the LSF of those of the ESF, (SIZE, k)."""
    return np.asarray((esf[3 : 3 + SIZE] - esf[2 : 2 + SIZE]) / CELL)


def _normal_prior(linear: Linear, posterior: Posterior) -> Floats:
    """Covariance of the coordinates of departures by the prior of the passes before, (q, q).

    Level, width and place of the blur are free: what they can follow is no departure.
    """
    lsf, coordinates = _prior_columns()
    free = orthonormal_rows(_lsf_of(linear.directions.esf[:, : _FIRST - 2]).T.copy())
    columns = coordinates - (free @ drawn_sensors().basis[:SIZE]).T @ (free @ lsf)
    columns *= posterior.prior_std[_FIRST : 1 + linear.directions.block.size]
    columns /= linear.first_fit.height
    covariance = columns @ columns.T
    covariance.reshape(-1)[:: len(covariance) + 1] += KERNEL_FLOOR**2
    return np.asarray(covariance)


@compiled
def _upper_factor(covariance: Floats) -> Floats:
    """Upper triangular factor: its first n columns are what remains open of the first n unknowns
    where all others are known."""
    n, scale = len(covariance), np.sqrt(np.diag(covariance))
    turned, found = np.empty((n, n)), np.empty((n, n))
    for i in range(n):
        for j in range(n):
            turned[n - 1 - i, n - 1 - j] = covariance[i, j] / (scale[i] * scale[j])
    lower = np.linalg.cholesky(turned)
    for i in range(n):
        for j in range(n):
            found[i, j] = scale[i] * lower[n - 1 - i, n - 1 - j]
    return found
