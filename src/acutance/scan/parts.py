"""Whether the parts of a scene agree about its sensor.

The objects of a scene are taken to be soft independently of one another. They are not where one
part is fields and another a town: the softness that all objects of a part have in common passes for
blur of the sensor there. So the blur is asked of every part by itself, its objects having shares
of their own. As far as the parts scatter more than their deviations say, they have a softness of
their own (the moments of R. DerSimonian and N. Laird, Controlled Clinical Trials 7, 1986, 177), and
what the whole scene has in common is not known any better.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import ALL_AROUND, edge_modes, fit_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.targets.combine.curves import ChiSquare

__all__ = ["PartsFit", "compare_parts", "equal_parts"]

_MIN_EDGES: Final = 15
_MAX_SIDE: Final = 3


class PartsFit(NamedTuple):
    """The blur of the parts of a scene, each by itself.

    Attributes
    ----------
    chi_square : ChiSquare
        Of the blur about its mean.
    scatter_px2 : float
        Standard deviation of the parts' own blur, a variance in px^2: 0 where they agree.
    """

    chi_square: ChiSquare
    scatter_px2: float


def compare_parts(
    edges: EdgeLikelihoods, otf: Floats, share: Floats, x: Floats, y: Floats
) -> PartsFit | None:
    """The blur of every part about its mean; None of too few edges.

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
    modes = edge_modes(edges.normal_deg, edges.freq_cpp)[:, :, [ALL_AROUND]]
    fits = [fit_modes(edges.chosen(some), otf, share, modes[some]) for some in equal_parts(x, y)]
    weight = np.array([max(one.information[0, 0], 0.0) for one in fits])
    if not weight.any():
        return None
    blur = np.array([one.amount[0] for one in fits])
    off = blur - np.average(blur, weights=weight)
    freedom = len(fits) - 1
    chi_square = ChiSquare(float(weight @ off**2), freedom, 2 * freedom)
    own = float(weight.sum() - weight @ weight / weight.sum())
    return PartsFit(chi_square, math.sqrt(max(chi_square.value - freedom, 0.0) / own))


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
