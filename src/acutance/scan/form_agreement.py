"""Whether the edges of a scene agree with the form of their sensor.

The sensor of a scene is a combination of forms (`acutance.targets.combine.sensor_forms`). Where it
is none of them, the edges of every direction pull it elsewhere: of their pull g and information I,
if it is known what the edges are, ``g^T I^-1 g`` is a chi-square with as many degrees of freedom as
combinations are told (C. R. Rao, Proc. Camb. Phil. Soc. 44, 1948, 50). Objects of unknown softness
pull less than that. What single edges' priors leave out of a line spread function is an error that
all of them have in common, and no disagreement.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.stacked import stacked
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.information import expected_information
from acutance.scan.population import Membership
from acutance.targets.combine.curves import ChiSquare

__all__ = ["agreement_of_form", "common_errors"]

_COMMON_STD, _COMMON_CPP = 1.5e-3, 0.15
"""Error of the transfer function that all edges of a sensor have in common, and over which
frequencies: what the prior of an edge's line spread function does not allow for does not average
out (benchmarks/scenes.py: errors of .000 to .002, by the shape of the sensor)."""
_TOLD: Final = 1e3
"""Information of combinations that a direction tells: errors of .03."""


def agreement_of_form(edges: EdgeLikelihoods, otf: Floats, member: Membership) -> ChiSquare:
    """Chi-square of the edges about their sensor, all directions together.

    Parameters
    ----------
    edges : EdgeLikelihoods
        Under the change over the field.
    otf : (b, 2 k) array
        The sensor along the bins, real parts first.
    member : Membership
        What every edge is under it.
    """
    shared = stacked(common_errors(1, edges.freq_cpp))
    value, freedom = 0.0, 0
    for own, pull, here in zip(*expected_information(edges, member), otf, strict=True):
        size, axes = np.linalg.eigh(own)
        root = axes[:, size > _TOLD] / np.sqrt(size[size > _TOLD])
        off, common = root.T @ (pull - own @ here), root.T @ own @ shared
        value += float(off @ np.linalg.solve(np.eye(off.size) + common @ common.T, off))
        freedom += off.size
    return ChiSquare(value, freedom, 2 * freedom)


def common_errors(bins: int, freq_cpp: Floats) -> NDArray[np.complex128]:
    """Factor (b * k, 2 k) of the errors that all edges have in common, the same in all directions.

    Parameters
    ----------
    bins : int
        Number b of directions.
    freq_cpp : (k,) array
    """
    away = (freq_cpp[:, None] - freq_cpp) / _COMMON_CPP
    size, axes = np.linalg.eigh(np.exp(-0.5 * away**2))
    root = np.tile(_COMMON_STD * axes * np.sqrt(np.maximum(size, 0.0)), (bins, 1))
    return np.hstack([root, 1j * root])
