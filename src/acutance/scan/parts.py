"""Whether the parts of a scene agree about its sensor.

The objects of a scene are taken to be soft independently of one another. They are not where one
part is fields and another a town: the softness that all objects of a part have in common passes for
blur of the sensor there. So the blur is asked of every part by itself, its objects having shares
of their own; as far as the parts scatter more than their deviations say, those of the sensor are
widened (R. T. Birge, Phys. Rev. 40, 207, 1932).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import edge_modes, fit_modes
from acutance.scan.population import EdgeLikelihoods
from acutance.targets.combine.curves import ChiSquare

__all__ = ["agreement_of_parts", "equal_parts"]

_MIN_EDGES: Final = 15
_MAX_SIDE: Final = 3
_ALL_AROUND: Final = 1
"""The first of the modes of blur alone: the one that a softness of all objects has."""


def agreement_of_parts(
    edges: EdgeLikelihoods, otf: Floats, share: Floats, x: Floats, y: Floats
) -> ChiSquare | None:
    """Chi-square of the blur of the parts about its mean; None of too few edges.

    Parameters
    ----------
    edges : EdgeLikelihoods
        Under the change over the field.
    otf : (b, 2 k) array
        The sensor along the bins.
    share : (p,) array
        Of the parts of the population, in the whole scene.
    x, y : (n,) arrays
        Places of the edges.
    """
    modes = edge_modes(edges.normal_deg, edges.freq_cpp)[:, :, :_ALL_AROUND]
    fits = [fit_modes(edges.chosen(some), otf, share, modes[some]) for some in equal_parts(x, y)]
    if not fits:
        return None
    blur = np.array([one.amount[0] for one in fits])
    weight = np.array([max(one.information[0, 0], 0.0) for one in fits])
    off = blur - np.average(blur, weights=weight)
    freedom = len(fits) - 1
    return ChiSquare(float(weight @ off**2), freedom, 2 * freedom)


def equal_parts(x: Floats, y: Floats) -> list[NDArray[np.intp]]:
    """Edges of two by two or three by three parts of a scene, as many in each; none of too few."""
    side = min(math.isqrt(x.size // _MIN_EDGES), _MAX_SIDE)
    if side < 2:
        return []
    columns = np.array_split(np.argsort(x, kind="stable"), side)
    return [
        np.sort(some)
        for column in columns
        for some in np.array_split(column[np.argsort(y[column], kind="stable")], side)
    ]
