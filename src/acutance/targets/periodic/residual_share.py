"""How much of a pattern that no transfer makes is left in the residuals of bars and stars."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.periodic.otf_regression import Regression

__all__ = ["left_of"]

_MIN_LEFT: Final = 1e-3
"""Share of the pattern's power that the fit has to leave."""


def left_of(
    fitted: Regression, patterns: Floats, weight: Floats, inflation: float
) -> tuple[Estimate, ...]:
    """The shares of some patterns that the image has, beyond what the fit takes up of them.

    Parameters
    ----------
    fitted : Regression
    patterns : (k, n) array
        Image units; fitted together.
    weight : (n,) array
        Of the pixels.
    inflation : float
        Factor on the noise variance for correlated noise.

    Returns
    -------
    tuple of Estimate
        With infinite deviations where the fit follows one of the patterns.
    """
    pulled = weight * patterns
    posterior = fitted.posterior
    at_amplitudes = posterior.factor[:, : -posterior.log_amplitude.size]
    noise = posterior.variance * inflation
    power = patterns @ pulled.T
    taken = (pulled @ fitted.design) @ at_amplitudes
    left = power - taken @ taken.T / noise
    scale = np.sqrt(power.diagonal())
    if not np.linalg.eigvalsh(left / np.outer(scale, scale))[0] > _MIN_LEFT:
        return (Estimate(0.0, math.inf),) * len(patterns)
    inverse = np.linalg.inv(left)
    values = inverse @ (pulled @ fitted.residual)
    return tuple(map(Estimate, values.tolist(), np.sqrt(noise * inverse.diagonal()).tolist()))
