"""Whether the parts of a scene agree about its sensor.

The objects of a scene are taken to be soft independently of one another. They are not where one
part is fields and another a town: the softness that all objects of a part have in common passes for
blur of the sensor there; so does that of one direction, where furrows or a slope give it one. So
every blur is asked of every part by itself, its objects having shares of their own. As far as the
parts scatter more than their deviations say, they have a softness of their own (the moments of
R. DerSimonian and N. Laird, Controlled Clinical Trials 7, 1986, 177), and what the whole scene has
in common is not known any better.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import ALL_AROUND, COMMON_MODES, OBLIQUE, edge_modes, fit_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.targets.combine.curves import ChiSquare

__all__ = ["PartsFit", "compare_parts", "equal_parts"]

_MIN_EDGES: Final = 15
_MAX_SIDE: Final = 3


class PartsFit(NamedTuple):
    """The blurs of the parts of a scene, each by itself.

    Attributes
    ----------
    part_count : int
        Number of parts.
    chi_square : ChiSquare
        Of the blurs about their means.
    upright : ChiSquare
        The same of those alone that change the MTF across and along: oblique blur does not.
    errors_px2 : (3,) array
        Standard deviations that the whole scene has by them, of the blurs all around, across more
        than along and oblique, variances in px^2: 0 where the parts agree.
    """

    part_count: int
    chi_square: ChiSquare
    upright: ChiSquare
    errors_px2: Floats


def compare_parts(
    edges: EdgeLikelihoods, otf: Floats, share: Floats, x: Floats, y: Floats
) -> PartsFit | None:
    """The blurs of every part about their means; None of too few edges.

    Softness is blur all around: what the parts have of it in common, as much as they differ by, is
    in none of their differences. Which direction is softer differs from part to part either way,
    and averages out.

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
    parts = equal_parts(x, y)
    modes = edge_modes(edges.normal_deg, edges.freq_cpp)[:, :, :COMMON_MODES]
    each = [_scatter(edges, otf, share, modes[:, :, [one]], parts) for one in range(COMMON_MODES)]
    if all(one is None for one in each):
        return None
    errors_px2 = np.zeros(COMMON_MODES)
    for mode, one in enumerate(each):
        if one is not None:
            errors_px2[mode] = one.scatter_px2 * (1.0 if mode == ALL_AROUND else one.averaged)
    return PartsFit(len(parts), _chi_square(each), _chi_square(each[:OBLIQUE]), errors_px2)


def _chi_square(each: Sequence[_Scatter | None]) -> ChiSquare:
    """Of several blurs together, of those that are seen."""
    found = [one for one in each if one is not None]
    freedom = sum(one.freedom for one in found)
    return ChiSquare(sum(one.chi_square for one in found), freedom, 2 * freedom)


class _Scatter(NamedTuple):
    """One blur of the parts: its chi-square about the mean, and the scatter beyond chance.

    `averaged` is the share of the scatter that is left in the mean.
    """

    chi_square: float
    freedom: int
    scatter_px2: float
    averaged: float


def _scatter(
    edges: EdgeLikelihoods,
    otf: Floats,
    share: Floats,
    mode: Floats,
    parts: Sequence[NDArray[np.intp]],
) -> _Scatter | None:
    """How much one blur differs from part to part; None where fewer than two show it."""
    fits = [fit_modes(edges.chosen(some), otf, share, mode[some]) for some in parts]
    weight = np.array([max(one.information[0, 0], 0.0) for one in fits])
    freedom = int(np.count_nonzero(weight)) - 1
    if freedom < 1:
        return None
    blur = np.array([one.amount[0] for one in fits])
    off = blur - np.average(blur, weights=weight)
    chi_square, whole, squares = float(weight @ off**2), weight.sum(), float(weight @ weight)
    scatter = math.sqrt(max(chi_square - freedom, 0.0) / (whole - squares / whole))
    return _Scatter(chi_square, freedom, scatter, math.sqrt(squares) / whole)


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
