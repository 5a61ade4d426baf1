"""Prior of all unknowns of a straight target: level, LSF, ground, trends, and what is free.

In this order: the dark level, the directions of the line spread function (LSF) (`lsf_prior`), the
steps of the ground that are part of the spline (`ground_steps`), the trends of the plateaus
(`gradients`), the steps beyond, and unknowns with a scale of their own.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.marginal_likelihood import Prior
from acutance.targets.straight.ground_steps import Ground
from acutance.targets.straight.lsf_prior import FIRST_BLOCK, Directions
from acutance.targets.straight.tuned import (
    APERTURE_PX,
    GROUND_LOG_AMPLITUDE,
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
    NOISE_FLOOR,
    TREND_LOG_AMPLITUDE,
    TREND_LOG_AMPLITUDE_STD,
)

__all__ = ["GROUND_BLOCK", "model_prior"]

_TREND_BLOCK: Final = LOG_AMPLITUDE.size
GROUND_BLOCK: Final = _TREND_BLOCK + 1
"""Number of the block of the ground before a target; that behind it, and a pulse's own, follow."""


def model_prior(
    blur: GaussianPixel,
    height: float,
    directions: Directions,
    ground: Ground,
    trends: int,
    free_std: Floats,
    rounding_floor: float = 0.0,
) -> Prior:
    """The prior of all unknowns of a straight target.

    Parameters
    ----------
    blur : GaussianPixel
        The first fit, about which the LSF differs.
    height : float
        Height of the target's first step, in data units.
    directions : Directions
        Of the LSF.
    ground : Ground
        Beside the target.
    trends : int
        Number of the plateaus' trends.
    free_std : (k,) array
        Standard deviations of the unknowns at the end, in their own units.
    rounding_floor : float, optional
        Noise below which rounding hides it, in data units.
    """
    near, far = ground.side[: ground.spline.shape[1]], ground.side[ground.spline.shape[1] :]
    block = np.concatenate([
        [-1], np.maximum(directions.block - FIRST_BLOCK, -1), GROUND_BLOCK + near,
        np.full(trends, _TREND_BLOCK), GROUND_BLOCK + far, np.full(free_std.size, -1),
    ])  # fmt: skip
    scale, mean = np.ones(block.size), np.zeros(block.size)
    scale[block >= GROUND_BLOCK] = ground.scale
    scale[block.size - free_std.size :] = free_std / height
    aperture = 1 + int((directions.block == 1).argmax())
    scale[aperture] = APERTURE_PX[1]
    mean[aperture] = (APERTURE_PX[0] - blur.aperture_px) * height
    walks = [GROUND_LOG_AMPLITUDE] * ground.walks
    log_amplitude = np.array([*LOG_AMPLITUDE, TREND_LOG_AMPLITUDE, *walks])
    spread = np.full(log_amplitude.size, LOG_AMPLITUDE_STD)
    spread[_TREND_BLOCK] = TREND_LOG_AMPLITUDE_STD
    noise_floor = max(NOISE_FLOOR * height, rounding_floor)
    return Prior(block, scale, mean, log_amplitude, spread, height, noise_floor)
