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
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight import lsf_prior
from acutance.targets.straight.first_fit import FirstFit
from acutance.targets.straight.linear_model import Linear
from acutance.targets.straight.sensor_density import SensorsSeen, drawn_sensors
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
    information : (m, m) array
        What the pixels alone say of all unknowns: the inverse of their covariance.
    projection : (m,) array
        The same times their values.
    broad_prior : (m, m) array
        Covariance of a prior that leaves the LSF open.
    share : dict of str to float
        Probability of every family of sensors.
    """

    linear: Linear
    posterior: Posterior
    information: Floats
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
    equations = normal.combined(own.design)
    information, projection = equations.gram / noise, equations.projection / noise
    std = np.concatenate([
        posterior.prior_std[:_FIRST], np.full(q, np.inf), posterior.prior_std[1 + r :]
    ])  # fmt: skip
    prior_mean = own.prior.mean
    sensor = np.zeros(std.size, bool)
    sensor[_FIRST : _FIRST + q] = True
    beta, covariance, seen = _solved(
        information, projection + prior_mean / std**2, std, sensor, linear.first_fit,
        _normal_prior(linear, posterior),
    )  # fmt: skip
    if equations.misfit(beta) - before.misfit(posterior.beta) > MAX_SENSOR_MISFIT * noise:
        return _as_before(linear, before, posterior, noise)
    found = Posterior(
        beta, _upper_factor(covariance), std, posterior.log_amplitude, posterior.variance,
        freedom=float(np.sum(covariance * information)),
    )  # fmt: skip
    prior = np.diag(np.where(sensor, 0.0, std) ** 2)
    broad = (BROAD_PRIOR * linear.first_fit.height) ** 2
    prior[np.ix_(sensor, sensor)] = broad * drawn_sensors().second_moment
    return AmongSensors(own, found, information, projection, prior, seen.share)


def _as_before(linear: Linear, before: Normal, posterior: Posterior, noise: float) -> AmongSensors:
    """The solution of the passes before, of a sensor that the density cannot follow."""
    broad = posterior.prior_std.copy()
    broad[_FIRST : 1 + linear.directions.block.size] *= BROAD_PRIOR
    return AmongSensors(
        linear, posterior, before.gram / noise, before.projection / noise, np.diag(broad**2),
        {"other": 1.0},
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
    block = np.concatenate([linear.directions.block[: _FIRST - 1], np.full(tail.size, _DENSITY)])
    kept = slice(0, _FIRST - 1)
    directions = lsf_prior.Directions(
        np.hstack([linear.directions.esf[:, kept], esf]),
        np.concatenate([linear.directions.tail[kept], tail]),
        block,
    )
    columns = np.zeros((linear.design.shape[0], tail.size))
    columns[: CELLS + 3] = spline
    columns[CELLS + 3] = tail
    after = 1 + linear.directions.block.size
    design = np.hstack([linear.design[:, :_FIRST], columns, linear.design[:, after:]])
    prior = linear.prior

    def exchanged(values: Floats, new: float) -> Floats:
        return np.concatenate([values[:_FIRST], np.full(tail.size, new), values[after:]])

    prior = replace(
        prior,
        block=exchanged(prior.block, _DENSITY),
        scale=exchanged(prior.scale, 1.0),
        mean=exchanged(prior.mean, 0.0),
    )
    return replace(linear, directions=directions, design=design, prior=prior)


def _normal_prior(linear: Linear, posterior: Posterior) -> Floats:
    """Covariance of the coordinates of departures by the prior of the passes before, (q, q)."""
    esf, tail, block = linear.directions
    lsf = np.diff(esf, axis=0)[2 : 2 + SIZE] / CELL
    free = np.linalg.qr(lsf[:, : _FIRST - 2])[0]
    own = slice(_FIRST - 1, block.size)
    left = lsf[:, own] - free @ (free.T @ lsf[:, own])
    columns = drawn_sensors().basis.T @ np.vstack([left, tail[own]])
    columns *= posterior.prior_std[1:][own] / linear.first_fit.height
    return np.asarray(columns @ columns.T + KERNEL_FLOOR**2 * np.eye(columns.shape[0]))


def _solved(
    information: Floats,
    projection: Floats,
    std: Floats,
    sensor: NDArray[np.bool_],
    first_fit: FirstFit,
    normal: Floats,
) -> tuple[Floats, Floats, SensorsSeen]:
    """Mean and covariance of all unknowns, and what is seen of the sensor.

    The other unknowns are integrated out; then they follow the coordinates linearly.
    """
    other, height = ~sensor, first_fit.height
    precision = information[np.ix_(other, other)] + np.diag(std[other] ** -2.0)
    between = information[np.ix_(other, sensor)]
    factor = cho_factor(precision)
    follow, start = cho_solve(factor, between), cho_solve(factor, projection[other])
    own = information[np.ix_(sensor, sensor)] - between.T @ follow
    pull = projection[sensor] - between.T @ start
    width_px = first_fit.blur.width_px
    seen = drawn_sensors().seen(height**2 * own, height * pull, width_px, normal)
    mean, spread = height * seen.mean, height**2 * seen.covariance
    beta, covariance = np.empty(std.size), np.empty((std.size, std.size))
    beta[sensor], beta[other] = mean, start - follow @ mean
    covariance[np.ix_(sensor, sensor)] = spread
    covariance[np.ix_(other, sensor)] = -follow @ spread
    covariance[np.ix_(sensor, other)] = covariance[np.ix_(other, sensor)].T
    covariance[np.ix_(other, other)] = (
        cho_solve(factor, np.eye(follow.shape[0])) + follow @ spread @ follow.T
    )
    return beta, covariance, seen


def _upper_factor(covariance: Floats) -> Floats:
    """Upper triangular factor: its first n columns are what remains open of the first n unknowns
    where all others are known."""
    scale = np.sqrt(np.diagonal(covariance))
    turned = (covariance / np.outer(scale, scale))[::-1, ::-1]
    return np.asarray(scale[:, None] * np.linalg.cholesky(turned)[::-1, ::-1])
