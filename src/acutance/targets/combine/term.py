"""One factor of a parametric optical transfer function (OTF), and functions several share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.combine.plane import Plane

__all__ = ["Term", "Transfer", "aperture", "logistic", "logistic_slope"]

Transfer = Callable[[Floats, Plane], NDArray[Any]]
"""Optical transfer function (OTF), (n,), by parameters and places of the plane."""


@dataclass(frozen=True)
class Term:
    """One factor of a parametric OTF.

    Parameters
    ----------
    otf : function of (parameters, plane)
        1 at zero frequency.
    mean, std : tuple of float
        Prior mean and standard deviation of the parameters.
    numbers : function of parameters
        The reported numbers, by name with the unit.
    slopes : function of (parameters, plane), optional
        Derivatives of the OTF by the parameters, (n, p), in closed form.
    """

    otf: Transfer
    mean: tuple[float, ...]
    std: tuple[float, ...]
    numbers: Callable[[Floats], dict[str, float]]
    slopes: Transfer | None = None


def logistic(x: float) -> float:
    """A share, 0 to 1, of an unbounded number."""
    return 1 / (1 + math.exp(-x))


def logistic_slope(x: float) -> float:
    """Its derivative."""
    return logistic(x) * logistic(-x)


def aperture(p: Floats) -> tuple[float, float]:
    """Cut-off frequency in cycles per pixel, and obscuration, of the first two parameters."""
    return math.exp(p[0]), 0.7 * logistic(p[1])
