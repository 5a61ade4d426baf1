"""Steps that the regressions of bars and stars share: weights, noise about the mean, the prior."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.numerics.noise import outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.numerics.otf_modes import MEAN_MODES, ProcessModes
from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.tuned import (
    FREE_LEVEL_LOG_AMPLITUDE,
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
)

__all__ = [
    "FREE_STD",
    "Regression",
    "mean_variance",
    "otf_prior",
    "reweighted",
    "weighted_normal",
]

FREE_STD = 3.0
"""Standard deviation of a mode of the mean that is free, relative to the target's height."""

_MIN_VARIANCE = 1e-12


class Regression(NamedTuple):
    """One regression of the pixels, with the target where it is taken to be."""

    posterior: Posterior
    otf: FittedOtf
    residual: Floats

    @property
    def noise(self) -> float:
        """Standard deviation of the noise, image units."""
        return math.sqrt(self.posterior.variance)


def weighted_normal(design: Floats, value: Floats, weight: Floats) -> Normal:
    """Normal equations of pixels (n,) in the columns of a design (n, m), with weights (n,)."""
    weighted = design * weight[:, None]
    data = float((weight * value) @ value)
    return Normal(weighted.T @ design, weighted.T @ value, data, float(np.sum(weight)))


def mean_variance(normal: Normal, few: int) -> float:
    """Noise variance about a fit of the first few coefficients, which is more than the noise."""
    fit = np.linalg.lstsq(normal.gram[:few, :few], normal.projection[:few], rcond=1e-10)[0]
    misfit = normal.data - float(fit @ normal.projection[:few])
    least = _MIN_VARIANCE * normal.data / max(normal.count, 1.0)
    return max(misfit / max(normal.count - few, 1.0), least)


def reweighted(standard: Floats) -> Floats:
    """Weights that bound outliers, (n,), of residuals in units of the noise, (n,)."""
    return outlier_weights(standard / min(robust_scale(standard), 1.0))


def otf_prior(
    own_scale: Floats,
    own_mean: Floats,
    mean_scale: Floats,
    states: ProcessModes | None,
    height: float,
    noise_floor: float,
    *,
    level_stated: bool,
) -> Prior:
    """Prior of a target's own coefficients, of the mean's modes, and of the processes.

    Parameters
    ----------
    own_scale : (p,) array
        Standard deviations of the target's own coefficients (levels, places), relative to
        `height`.
    own_mean : (p,) array
        Their prior means, in data units.
    mean_scale : (8,) array
        Standard deviations of the mean's modes, relative to `height`.
    states : ProcessModes or None
        The processes; None for the mean alone.
    height : float
        Height of the target, in data units.
    noise_floor : float
        The smallest noise, relative to `height`.
    level_stated : bool
        Whether levels of wide patches show how much light is scattered far.
    """
    blocks = np.empty(0, np.intp) if states is None else states.blocks()
    own = np.full(own_scale.size + MEAN_MODES, -1)
    scale = np.concatenate([own_scale, mean_scale, np.ones(blocks.size)])
    mean = np.zeros(scale.size)
    mean[: own_mean.size] = own_mean
    amplitude = LOG_AMPLITUDE if level_stated else LOG_AMPLITUDE + FREE_LEVEL_LOG_AMPLITUDE
    return Prior(
        np.concatenate([own, blocks]), scale, mean, amplitude, LOG_AMPLITUDE_STD, height,
        noise_floor * height,
    )  # fmt: skip
