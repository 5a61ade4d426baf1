"""One factor of a parametric optical transfer function (OTF), and functions several share.

Many forms of sensors are fitted side by side (`acutance.targets.combine.form_products`): all
functions of a term take the parameters of several sensors at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.combine.plane import Plane

__all__ = ["Term", "Transfer", "aperture", "columns", "logistic", "logistic_slope", "one_by_one"]

Transfer = Callable[[Floats, Plane], NDArray[Any]]
"""Optical transfer function (OTF), (..., n), by parameters (..., p) and n places of the plane."""


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
        Derivatives of the OTF by the parameters, (..., p, n), in closed form.
    signed : tuple of int, optional
        Parameters, of a prior about 0, whose signs may all be changed: the OTF stays.
    """

    otf: Transfer
    mean: tuple[float, ...]
    std: tuple[float, ...]
    numbers: Callable[[Floats], dict[str, float]]
    slopes: Transfer | None = None
    signed: tuple[int, ...] = ()


def columns(p: Floats) -> tuple[Floats, ...]:
    """Every parameter of sensors (..., p) by itself, (..., 1): each beside all places."""
    return tuple(p[..., i : i + 1] for i in range(p.shape[-1]))


def one_by_one(function: Transfer) -> Transfer:
    """A function of the parameters of one sensor, (p,), for those of several."""

    def of_each(p: Floats, plane: Plane) -> NDArray[Any]:
        found = np.stack([function(own, plane) for own in p.reshape(-1, p.shape[-1])])
        return found.reshape(*p.shape[:-1], *found.shape[1:])

    return of_each


def logistic(x: Floats) -> Floats:
    """A share, 0 to 1, of an unbounded number."""
    share: Floats = 1 / (1 + np.exp(-x))
    return share


def logistic_slope(x: Floats) -> Floats:
    """Its derivative."""
    return logistic(x) * logistic(-x)


def aperture(log_cutoff: Floats, logit: Floats) -> tuple[Floats, Floats]:
    """Cut-off frequency in cycles per pixel, and obscuration, of the two first parameters."""
    return np.exp(log_cutoff), 0.7 * logistic(logit)
