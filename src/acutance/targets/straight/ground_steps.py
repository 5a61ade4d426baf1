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

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA, gaussian
from acutance.targets.straight.spline import CELLS, CENTRES, esf_from_lsf, quasi_interpolant
from acutance.targets.straight.tuned import FAR_GROUND_STEPS, NEAR_GROUND_STEPS

__all__ = ["Ground"]

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
        On which side each step lies: 0 before the target, 1 behind it.
    scale : (j + k,) array
        Standard deviation of every step for a walk of unit variance per width: the root of its
        spacing.
    """

    spline: Floats
    columns: Floats
    side: NDArray[np.intp]
    scale: Floats

    @classmethod
    def beside(cls, outwards: Sequence[Floats], *, is_edge: bool) -> Ground:
        """The ground beside an edge or a pulse.

        Parameters
        ----------
        outwards : pair of (n,) arrays
            Distance of the pixels outwards from the target's end, before and behind, in widths.
        is_edge : bool
            Whether the spline of the target has one step only.
        """
        spline = _edge_spline() if is_edge else np.zeros((CELLS + 3, 0))
        first = NEAR_GROUND_STEPS.size if is_edge else 0
        columns, side, scale = [], [np.repeat([0, 1], first)], [*[_SCALE[:first]] * 2]
        for number, distance in enumerate(outwards):
            last = int(np.searchsorted(_PLACES, float(distance.max()) - _ROOM))
            columns.append(_blurred(distance, _PLACES[first:last]))
            side.append(np.full(columns[-1].shape[0], number))
            scale.append(_SCALE[first : max(first, last)])
        return cls(spline, np.vstack(columns), np.concatenate(side), np.concatenate(scale))


@cache
def _edge_spline() -> Floats:
    """Spline coefficients of the near steps before and behind an edge, (CELLS + 3, 2 k)."""
    sigma = 1 / FWHM_OF_SIGMA
    lsf = gaussian((CENTRES[:, None] - NEAR_GROUND_STEPS) / sigma) / sigma
    behind = esf_from_lsf(quasi_interpolant(lsf))
    return np.hstack([behind[::-1], behind])


def _blurred(outwards: Floats, places: Floats) -> Floats:
    """Response to a unit step at every place, (k, n)."""
    return np.asarray(ndtr(FWHM_OF_SIGMA * (outwards - places[:, None])))
