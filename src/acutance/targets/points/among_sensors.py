"""The last pass of the joint fit: the point spread function (PSF) as that of a sensor.

The passes before know the families of sensors by their principal directions, as if departures were
normally distributed about none. Here the prior is the density of the sensors themselves
(`sensor_density`), beside the normal one for a sensor like none of them. Each has its probability,
from the marginal likelihood of the pixels and how often such a sensor is expected; the posterior is
normal again, of the mean and the covariance of all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from acutance.curves.grid import Floats
from acutance.numerics.kernel_mixture import (
    Combinations,
    Kernels,
    Mixture,
    combinations_of,
    mixture,
)
from acutance.numerics.marginal_likelihood import (
    Posterior,
    Prior,
    log_evidence_slopes,
    whiten,
)
from acutance.numerics.normal_equations import Normal
from acutance.numerics.pivoted_root import covariance_root
from acutance.targets.points import tuned
from acutance.targets.points.amplitudes import averaged_posterior, posterior_log_evidence
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.sensor_density import drawn_sensors

__all__ = ["AmongSensors", "Equations", "SensorModel", "among_sensors"]

_UNTOLD: Final = 1.0
"""Information of combinations that pixels do not tell: coordinates are below one."""
_MARGIN: Final = 40.0
"""Logarithm of the weight below the largest from which on a sensor is out of the question."""
_CERTAIN: Final = 1e-4
"""Probability below which a model has no part."""


@dataclass(frozen=True, eq=False)
class AmongSensors:
    """The shared unknowns, with the density of sensors as their prior.

    Attributes
    ----------
    equations : Equations
    model : SensorModel
    mixture : Mixture, optional
        Of its coordinates after the pixels; None where no sensor has about such a blur.
    log_evidence : float
        Logarithm of the density of the pixels, for models of the same pixels to be compared.
    other : float
        Probability that it is a sensor like none that was drawn.
    """

    equations: Equations
    model: SensorModel
    mixture: Mixture | None
    log_evidence: float
    other: float

    @property
    def share(self) -> dict[str, float]:
        """Probability of every family of sensors, and that it is another sensor."""
        known = {} if self.mixture is None else self.mixture.share
        return {"other": self.other} | {name: (1 - self.other) * p for name, p in known.items()}

    @property
    def kernels(self) -> Kernels | None:
        """Kernels of the sensors that also another model of the same pixels has to reckon with."""
        return None if self.mixture is None else self.mixture.seen.kernels.some(self.likely)

    @cached_property
    def likely(self) -> NDArray[np.bool_]:
        """Which of the sensors that were thought of these are, (n,)."""
        return np.zeros(0, bool) if self.mixture is None else self.mixture.is_likely(_MARGIN)

    @cached_property
    def posterior(self) -> Posterior:
        """Normal, of the mean and the covariance of all sensors."""
        if self.mixture is None:
            return averaged_posterior(*self.equations)
        among = self.model.posterior(self.mixture, self.equations.likeliest)
        if self.other < _CERTAIN:
            return among
        return _averaged(among, averaged_posterior(*self.equations), self.other)


class Equations(NamedTuple):
    """The equations of the shared unknowns, solved by the normal prior of the passes before.

    Attributes
    ----------
    normal : Normal
    prior : Prior
    inflation : float
        Factor on the noise variance for correlated noise.
    likeliest : Posterior
    """

    normal: Normal
    prior: Prior
    inflation: float
    likeliest: Posterior

    @property
    def noise(self) -> float:
        """Variance of the noise for unit weight, its correlation included."""
        return self.likeliest.variance * self.inflation


def among_sensors(
    equations: Equations, directions: PsfDirections, kernels: Kernels | None = None
) -> AmongSensors:
    """Weigh the density of sensors, and the normal prior for sensors like none of them.

    Parameters
    ----------
    equations : Equations
    directions : PsfDirections
        What the first unknowns are.
    kernels : Kernels, optional
        Of the sensors to be thought of; those of about such a blur unless given.
    """
    if kernels is None:
        kernels = drawn_sensors().about(directions.blur.widths_px)
    model = SensorModel.of(equations, directions)
    of_others = _log_evidence_of_others(equations)
    if not kernels.part.size:
        return AmongSensors(equations, model, None, of_others, 1.0)
    found = mixture(kernels, model.told)
    of_sensors = found.log_evidence + model.log_evidence
    whole = float(np.logaddexp(of_sensors, of_others))
    return AmongSensors(equations, model, found, whole, math.exp(of_others - whole))


@dataclass(frozen=True, eq=False)
class SensorModel:
    """The linear model whose PSF has the coordinates of the density of sensors.

    Its other unknowns are the ellipse of the blur, the background, and fine structure of the size
    expected, which coordinates lack. They are integrated out, then follow the coordinates linearly.

    Attributes
    ----------
    columns : (m, q) array
        What unit coordinates do to all unknowns.
    start : (m,) array
        The unknowns when all coordinates are zero.
    others : (m, p) array
        Factor of the covariance of what does not follow the coordinates.
    told : Combinations
        What the pixels say of the coordinates.
    log_evidence : float
        Logarithm of the density of the pixels where the coordinates are as they say.
    """

    columns: Floats
    start: Floats
    others: Floats
    told: Combinations
    log_evidence: float

    @classmethod
    def of(cls, equations: Equations, directions: PsfDirections) -> SensorModel:
        """The model that pixels determine by their equations."""
        normal, prior, noise = equations.normal, equations.prior, equations.noise
        basis = drawn_sensors().directions
        other = _others(directions, prior.block.size)
        columns = np.zeros((prior.block.size, basis.shape[1]))
        columns[directions.learned] = basis
        gram, projection = normal.gram / noise, normal.projection / noise
        std = prior.std(prior.log_amplitude)[other]
        factor = cho_factor(gram[np.ix_(other, other)] + np.diag(std**-2.0), lower=True)
        between = gram[other] @ columns
        follow, own_start = cho_solve(factor, between), cho_solve(factor, projection[other])
        information = columns.T @ gram @ columns - between.T @ follow
        told = combinations_of(information, columns.T @ projection - between.T @ own_start, _UNTOLD)
        columns[other] = -follow
        start, others = np.zeros(prior.block.size), np.zeros((prior.block.size, other.size))
        start[other] = own_start
        others[other] = solve_triangular(factor[0], np.eye(other.size), lower=True).T
        explained = float(projection[other] @ own_start + told.values @ told.values)
        volume = float(np.log(np.diagonal(factor[0]) * std).sum())
        volume += 0.5 * normal.count / equations.inflation * math.log(noise)
        evidence = -0.5 * (normal.data / noise - explained) - volume
        return cls(columns, start, others, told, evidence)

    def posterior(self, coordinates: Mixture, likeliest: Posterior) -> Posterior:
        """All unknowns, by the coordinates."""
        followed = self.columns @ covariance_root(coordinates.covariance)
        return replace(
            likeliest,
            beta=self.start + self.columns @ coordinates.mean,
            factor=np.hstack([followed, self.others]),
        )


def _others(directions: PsfDirections, size: int) -> NDArray[np.intp]:
    """Unknowns beside the coordinates: the ellipse, fine structure, and all after the PSF."""
    after = np.arange(directions.size, size)
    return np.concatenate([np.arange(3), np.flatnonzero(directions.is_detail), after])


def _log_evidence_of_others(equations: Equations) -> float:
    """Log evidence of the normal prior, its amplitudes integrated over (Laplace)."""
    normal, prior, inflation, likeliest = equations
    mode = likeliest.log_amplitude
    slopes = log_evidence_slopes(whiten(normal, prior, mode, equations.noise), prior, mode)
    volume = float(np.linalg.slogdet(slopes.covariance_factor())[1])
    volume -= mode.size * math.log(tuned.LOG_AMPLITUDE_STD)
    own = posterior_log_evidence(normal, prior, likeliest, inflation)
    return own + volume + math.log(tuned.OTHER_WEIGHT)


def _averaged(among: Posterior, others: Posterior, other: float) -> Posterior:
    """The posterior of both models, `other` being the probability of the second."""
    away = others.beta - among.beta
    factor = np.hstack([
        math.sqrt(1 - other) * among.factor,
        math.sqrt(other) * others.factor,
        math.sqrt(other * (1 - other)) * away[:, None],
    ])  # fmt: skip
    return replace(among, beta=among.beta + other * away, factor=covariance_root(factor @ factor.T))
