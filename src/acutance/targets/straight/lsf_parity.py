"""The line spread function (LSF) of a sensor in parts that are even and odd about its middle.

Blur of most causes is even. What is odd (a charge trail, coma) is kept apart, with amplitudes of
its own, so that a model with and without it can be compared; `nonlinearity` does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.lorentz_tail import tail_lsf
from acutance.numerics.process_modes import covariance_modes
from acutance.targets.straight.lsf_prior import blur_directions
from acutance.targets.straight.spline import CENTRES, esf_from_lsf, quasi_interpolant
from acutance.targets.straight.tuned import DETAIL, TAIL_WIDTH

__all__ = ["LOG_AMPLITUDES", "LOG_AMPLITUDE_STD", "Parts", "parts"]

_PROCESSES: Final = ((1.2, 0.6), DETAIL, (3.0, 1.2))
"""Extent and smoothness of shape, detail and halo, in widths: broader than the estimator's prior,
which has few odd directions."""
_LOG_AMPLITUDES: Final = (-4.4, -2.5, -4.1)
_TAIL_LOG_AMPLITUDE: Final = -4.0
LOG_AMPLITUDES: Final[Floats] = np.array([*_LOG_AMPLITUDES, *_LOG_AMPLITUDES, _TAIL_LOG_AMPLITUDE])
"""Of the blocks: three even processes, three odd ones, the tail; relative to the height."""
LOG_AMPLITUDE_STD: Final = 1.2
_FREE: Final = 4


@dataclass(frozen=True, eq=False)
class Parts:
    """Directions of an LSF.

    Attributes
    ----------
    esf : (CELLS + 3, r) array
        Spline coefficients of the edge spread function (ESF) for every direction.
    block : (r,) int array
        0 to 2 even processes, 3 to 5 odd ones, 6 the tail; -1 the free parameters of the mean
        (level, width, place, aperture).
    odd : (r,) bool array
        Which belong to an odd process.
    """

    esf: Floats
    block: NDArray[np.intp]
    odd: NDArray[np.bool_]


def parts(blur: GaussianPixel) -> Parts:
    """The directions about a Gaussian through a pixel, which come first."""
    fixed = _processes()
    esf = fixed.esf.copy()
    esf[:, :_FREE] = blur_directions(blur)
    return Parts(esf, fixed.block, fixed.odd)


@cache
def _processes() -> Parts:
    """All directions, with room for the free ones in front."""
    columns, blocks = [np.zeros((CENTRES.size, _FREE))], [np.full(_FREE, -1)]
    for number, (extent, smoothness) in enumerate(_PROCESSES):
        variance, shape = covariance_modes(CENTRES, extent, smoothness, 1e-4)
        modes = np.asarray(shape * np.sqrt(variance))
        # The covariance is the same for -u, so its modes are even or odd.
        is_odd = np.einsum("ij,ij->j", modes, modes[::-1]) < 0
        columns += [modes[:, ~is_odd], modes[:, is_odd]]
        blocks += [np.full((~is_odd).sum(), number), np.full(is_odd.sum(), number + 3)]
    columns.append(quasi_interpolant(tail_lsf(CENTRES, TAIL_WIDTH))[:, None])
    block = np.concatenate([*blocks, [6]])
    return Parts(esf_from_lsf(np.hstack(columns)), block, (block >= 3) & (block <= 5))
