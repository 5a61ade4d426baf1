"""Ground that is not uniform beside a straight target: strips, steps and slopes parallel to it.

What lies beside an edge does not cross its line: its image is that of steps parallel to the edge,
seen through the same blur. Each side has a random walk of its own, which begins where the blur of
the edge ends: steps at fixed distances, with variances proportional to their spacing, and an
amplitude that the data determine. A camera's halo differs: it has the same shape on both sides of
an edge and falls (`lsf_prior`).

Distances are in widths of the first fit, and the blur of the steps is a Gaussian of that width.
Steps within the support of the spline are coefficients of it; those beyond, and all steps beside a
pulse, are regressors of their own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, gaussian
from acutance.numerics.normal_distribution import normal_distribution
from acutance.targets.straight.spline import CELLS, CENTRES, esf_from_lsf, quasi_interpolant
from acutance.targets.straight.tuned import (
    FAR_GROUND_STEPS,
    NEAR_GROUND_STEPS,
    STRUCTURE_SIGMAS,
)

__all__ = ["Ground", "GroundSide", "near_ground"]

_MAX_SEAMS, _SEAM_WIDTHS = 3, 0.95
"""A pulse may be brighter or darker from some places on, evenly spaced by as much or more: closer
ones are the LSF's."""
_ROOM = 1.0
"""How far the pixels have to reach beyond a step, in widths."""
_PLACES: Final = np.concatenate([NEAR_GROUND_STEPS, FAR_GROUND_STEPS])
_SCALE: Final[Floats] = np.sqrt(np.diff(_PLACES, prepend=2 * _PLACES[0] - _PLACES[1]))


@dataclass(frozen=True, eq=False)
class Ground:
    """The steps of the ground on both sides of a target.

    Attributes
    ----------
    spline : (CELLS + 3, j) array
        Coefficients of the first j steps in the spline of an edge; of a pulse none.
    columns : (k, n) array
        Response of the pixels to the k steps that follow.
    side : (j + k,) int array
        On which side each step lies: 0 before the target, 1 behind it, 2 on a pulse itself.
    scale : (j + k,) array
        Standard deviation of every step for a walk of unit variance per width: the root of its
        spacing.
    walks : int
        Number of walks: 2, of a pulse 3, its own being of no step where it is narrow.
    """

    spline: Floats
    columns: Floats
    side: NDArray[np.intp]
    scale: Floats
    walks: int

    @classmethod
    def beside_edge(cls, outwards: Sequence[Floats]) -> Ground:
        """The ground beside an edge.

        Parameters
        ----------
        outwards : pair of (n,) arrays
            Distance of the pixels outwards from the edge, on the dark and on the bright side, in
            widths.
        """
        first, near = NEAR_GROUND_STEPS.size, near_ground()
        far, counts = _steps(outwards, first)
        side = np.concatenate([near.side, *_numbers(counts)])
        scale = [near.scale, *(_SCALE[first : first + count] for count in counts)]
        return cls(near.spline, far, side, np.concatenate(scale), near.walks)

    @classmethod
    def beside_pulse(cls, outwards: Sequence[Floats], width: float) -> Ground:
        """The ground beside a pulse, and the seams of the pulse itself.

        Parameters
        ----------
        outwards : pair of (n,) arrays
            Distance of the pixels outwards from the pulse's first and last step, in widths.
        width : float
            The pulse's own width, in widths of the blur; none where a fit went below zero.
        """
        beside, counts = _steps(outwards, 0)
        count = min(max(int(width / _SEAM_WIDTHS) - 1, 0), _MAX_SEAMS)
        places = width * np.arange(1, count + 1) / (count + 1)
        seams = _blurred(-outwards[0], places) - _blurred(outwards[1], np.zeros(1))
        scale = [_SCALE[:one] for one in counts]
        scale.append(np.full(count, math.sqrt(max(width, 0.0) / (count + 1))))
        none = np.zeros((CELLS + 3, 0))
        side = np.concatenate(_numbers([*counts, count]))
        return cls(none, np.vstack([beside, seams]), side, np.concatenate(scale), 3)


def _numbers(counts: Sequence[int]) -> list[NDArray[np.intp]]:
    return [np.full(count, number) for number, count in enumerate(counts)]


def _steps(outwards: Sequence[Floats], first: int) -> tuple[Floats, list[int]]:
    """The steps of either side that the pixels reach beyond, from the first one on, (k, n).

    Those of the first side come first; how many each has follows.
    """
    lasts = [int(_PLACES.searchsorted(float(side.max()) - _ROOM)) for side in outwards]
    places = [_PLACES[first : max(first, last)] for last in lasts]
    return _blurred_beside(*outwards, *places), [own.size for own in places]


@dataclass(frozen=True, eq=False)
class GroundSide:
    """The fitted ground on one side of a target.

    Attributes
    ----------
    distance_px : (k,) array
        Where the ground may have steps, outwards from the target's end.
    step : (k,) array
        The steps, as shares of the target's height.
    level, std : (k,) arrays
        Level of the ground beyond each of them, relative to that at the target, and its standard
        deviation.
    """

    distance_px: Floats
    step: Floats
    level: Floats
    std: Floats

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Beyond which steps the level is beyond chance, (k,)."""
        return np.asarray(np.abs(self.level) > STRUCTURE_SIGMAS * self.std)

    @classmethod
    def of(cls, step: Floats, factor: Floats, width_px: float) -> GroundSide:
        """From the steps, (k,), and a factor of their covariance, (k, m)."""
        std = _lengths_of_sums(factor)
        return cls(_PLACES[: step.size] * width_px, step, np.cumsum(step), std)


@compiled
def _lengths_of_sums(rows: Floats) -> Floats:
    """Lengths of the sums of the first rows, of one more each time, (k,)."""
    lengths, total = np.empty(len(rows)), np.zeros(rows.shape[1])
    for i in range(len(rows)):
        power = 0.0
        for j in range(rows.shape[1]):
            total[j] += rows[i, j]
            power += total[j] * total[j]
        lengths[i] = np.sqrt(power)
    return lengths


@cache
def near_ground() -> Ground:
    """The steps beside an edge within the spline's support; no pixels beyond it."""
    near = NEAR_GROUND_STEPS.size
    side, scale = np.repeat([0, 1], near), np.tile(_SCALE[:near], 2)
    return Ground(_edge_spline(), np.zeros((0, 0)), side, scale, 2)


@cache
def _edge_spline() -> Floats:
    """Spline coefficients of the near steps before and behind an edge, (CELLS + 3, 2 k)."""
    sigma = 1 / FWHM_OF_SIGMA
    lsf = gaussian((CENTRES[:, None] - NEAR_GROUND_STEPS) / sigma) / sigma
    behind = esf_from_lsf(quasi_interpolant(lsf))
    return np.hstack([behind[::-1], behind])


@compiled
def _blurred(outwards: Floats, places: Floats) -> Floats:
    """Response to a unit step at every place, (k, n)."""
    response = np.empty((places.size, outwards.size))
    _blur(response, outwards, places)
    return response


@compiled
def _blurred_beside(
    dark: Floats, bright: Floats, dark_places: Floats, bright_places: Floats
) -> Floats:
    """The same of the places on two sides, one after the other, in one array."""
    response = np.empty((dark_places.size + bright_places.size, dark.size))
    _blur(response[: dark_places.size], dark, dark_places)
    _blur(response[dark_places.size :], bright, bright_places)
    return response


@compiled
def _blur(response: Floats, outwards: Floats, places: Floats) -> None:
    """Put the response to a unit step at every place into an array, (k, n)."""
    for j in range(places.size):
        for i in range(outwards.size):
            response[j, i] = normal_distribution(FWHM_OF_SIGMA * (outwards[i] - places[j]))[0]
