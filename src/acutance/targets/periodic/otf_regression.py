"""Steps that the regressions of bars and stars share: weights, noise about the mean, the prior."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.numerics.noise import outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.numerics.otf_families import family_directions
from acutance.numerics.otf_kernels import KERNEL_LOG_AMPLITUDE, kernel_taps
from acutance.numerics.otf_modes import MEAN_MODES, ProcessModes
from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.tuned import (
    FAMILY_LOG_AMPLITUDE_STD,
    FREE_LEVEL_LOG_AMPLITUDE,
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
)

__all__ = [
    "FREE_STD",
    "PosedPixels",
    "Regression",
    "mean_variance",
    "otf_prior",
    "reweighted",
]

FREE_STD = 3.0
"""Standard deviation of a mode of the mean that is free, relative to the target's height."""

_MIN_VARIANCE = 1e-12


class Regression(NamedTuple):
    """One regression of the pixels, with the target where it is taken to be."""

    posterior: Posterior
    otf: FittedOtf
    residual: Floats
    design: Floats

    @property
    def noise(self) -> float:
        """Standard deviation of the noise, image units."""
        return math.sqrt(self.posterior.variance)


class PosedPixels(NamedTuple):
    """Pixels as a linear model, whose sums serve all regressions of them.

    Attributes
    ----------
    design : (n, m) array
    value : (n,) array
    normal : Normal
    """

    design: Floats
    value: Floats
    normal: Normal

    @classmethod
    def of(cls, design: Floats, value: Floats, weight: Floats) -> PosedPixels:
        """Pixels (n,) in the columns of a design (n, m), with weights (n,)."""
        # Of a matrix by itself, transposed, half of the products are the others.
        root = np.sqrt(weight)
        weighted, values = design * root[:, None], value * root
        gram, projection = weighted.T @ weighted, weighted.T @ values
        return cls(
            design, value, Normal(gram, projection, float(values @ values), float(np.sum(weight)))
        )

    def residual(self, posterior: Posterior) -> Floats:
        """What the fitted coefficients leave of the values, (n,)."""
        return self.value - self.design @ posterior.beta


def mean_variance(normal: Normal, few: int) -> float:
    """Noise variance about a fit of the first few coefficients, which is more than the noise."""
    fit = np.linalg.lstsq(normal.gram[:few, :few], normal.projection[:few], rcond=1e-10)[0]
    misfit = normal.data - float(fit @ normal.projection[:few])
    least = _MIN_VARIANCE * normal.data / max(normal.count, 1.0)
    return max(misfit / max(normal.count - few, 1.0), least)


def reweighted(standard: Floats, rounding: float) -> Floats:
    """Weights that bound outliers, (n,), of residuals in units of the noise, (n,).

    `rounding` is what the steps of the image's numbers add to noise, in the same units: of noise
    that is less than a step most residuals are nothing, and their bulk has no scale.
    """
    return outlier_weights(standard / max(min(robust_scale(standard), 1.0), rounding))


def otf_prior(
    own_scale: Floats,
    own_mean: Floats,
    mean_scale: Floats,
    states: ProcessModes | None,
    height: float,
    noise_floor: float,
    *,
    level_stated: bool,
) -> CombinedPrior:
    """Prior of a target's own coefficients, of the mean's modes, processes, kernels and families.

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
        The states of processes and families; None for the mean alone, without kernels.
    height : float
        Height of the target, in data units.
    noise_floor : float
        The smallest noise, relative to `height`.
    level_stated : bool
        Whether levels of wide patches show how much light is scattered far.
    """
    own = np.full(own_scale.size + MEAN_MODES, -1)
    families = family_directions()
    blocks, combination = own, np.eye(own.size)
    processes = LOG_AMPLITUDE if level_stated else LOG_AMPLITUDE + FREE_LEVEL_LOG_AMPLITUDE
    amplitude = np.concatenate([processes, [KERNEL_LOG_AMPLITUDE], families.log_amplitude])
    stds = np.repeat(
        [LOG_AMPLITUDE_STD, FAMILY_LOG_AMPLITUDE_STD],
        [processes.size, amplitude.size - processes.size],
    )
    if states is not None:
        kernels = np.full(kernel_taps().shape[-1], processes.size)
        blocks = np.concatenate(
            [own, states.blocks(), kernels, processes.size + 1 + families.family]
        )
        combination = _with_families(own.size, families.states, kernels.size)
    scale = np.ones(blocks.size)
    scale[: own.size] = np.append(own_scale, mean_scale)
    mean = np.zeros(blocks.size)
    mean[: own_mean.size] = own_mean
    prior = Prior(blocks, scale, mean, amplitude, stds, height, noise_floor * height)
    return CombinedPrior(prior, combination)


def _with_families(own: int, directions: Floats, kernels: int) -> Floats:
    """Coefficients of a target's own, of states, kernels and families, in the first three alone."""
    states, families = directions.shape
    model = own + states + kernels
    combination = np.eye(model, model + families)
    combination[own : own + states, model:] = directions
    return combination
