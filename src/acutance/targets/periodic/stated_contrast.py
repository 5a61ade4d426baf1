"""Levels of a periodic target's materials where they are wide: they determine its contrast."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.numerics.normal_equations import Normal

__all__ = ["Levels", "StatedContrast", "stated_levels", "with_level"]


@dataclass(frozen=True)
class Levels:
    """Levels of dark and bright before the sensor, image units.

    Parameters
    ----------
    dark, bright : float
    std : float
        Standard deviation of their difference.
    """

    dark: float
    bright: float
    std: float


@dataclass(frozen=True)
class StatedContrast:
    """Stated levels, and what the pixels have to say of them.

    Parameters
    ----------
    levels : Levels
    free : Estimate
        Contrast from dark to bright that the pattern has without them.
    """

    levels: Levels
    free: Estimate


def stated_levels(dark: float | None, bright: float | None, std: float) -> Levels | None:
    """Both levels of a target's materials, or None where neither was stated.

    Raises
    ------
    OptionError
        If only one is given, dark is not the lower one, or the standard deviation is negative or
        belongs to no levels.
    """
    if (dark is None) != (bright is None):
        raise OptionError(
            "one level was given: give dark and bright, or neither (--dark, --bright)"
        )
    if not 0 <= std < math.inf:
        raise OptionError(f"level_std (--level-std) is {std:g}, it has to be 0 or more")
    if dark is None or bright is None:
        if std > 0:
            raise OptionError(
                f"level_std (--level-std) is {std:g}, but no levels are stated: give dark and "
                "bright (--dark, --bright) with it"
            )
        return None
    if not -math.inf < dark < bright < math.inf:
        raise OptionError(f"dark is {dark:g} and bright {bright:g}: dark has to be the lower one")
    return Levels(dark, bright, std)


def with_level(normal: Normal, row: Floats, level: float, std: float, variance: float) -> Normal:
    """Add a measured level to the pixels: one more observation with its own standard deviation.

    Parameters
    ----------
    normal : Normal
    row : (m,) array
        Contribution of every coefficient to the level.
    level, std : float
        The observation, image units; a deviation below 1e-4 of the level counts as that.
    variance : float
        Variance of a pixel, in which the observation is counted.
    """
    strength = variance / max(std, 1e-4 * abs(level)) ** 2
    return Normal(
        normal.gram + strength * np.outer(row, row),
        normal.projection + strength * level * row,
        normal.data + strength * level**2,
        normal.count,
    )
