"""The prior of a line spread function (LSF).

The LSF is a mean, the Gaussian through a pixel (`gaussian_pixel`) with free level, width, aperture
and place, plus three Gaussian processes and a tail, each with an amplitude that the data determine
(`marginal_likelihood`):

- SHAPE: smooth corrections near the peak (sharpening, asymmetry, shoulders);
- DETAIL: fine structure of the peak (a hard aperture, little optical blur);
- HALO: broad corrections out to many widths (stray light, halo, charge trails);
- TAIL: a term falling like 1/u^2 without end, as diffraction does.

A Gaussian process has covariance ``exp(-(u^2 + u'^2) / 2 L^2) exp(-(u - u')^2 / 2 l^2)``: its
functions extend over L widths and vary over l widths. Nothing here depends on a sensor.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.lorentz_tail import tail_esf, tail_lsf
from acutance.numerics.process_modes import covariance_modes
from acutance.targets.straight.spline import (
    CENTRES,
    HALF_SUPPORT,
    SIZE,
    esf_from_lsf,
    quasi_interpolant,
)
from acutance.targets.straight.tuned import DETAIL, HALO, SHAPE, TAIL_WIDTH

__all__ = [
    "Directions",
    "directions",
]


class Directions(NamedTuple):
    """The directions in which the LSF may differ from the mean.

    Attributes
    ----------
    esf : (CELLS + 3, r) array
        Coefficients of the edge spread function (ESF) for every direction, for an LSF per width.
    block : (r,) int array
        0 level, width and place (free), 1 aperture, 2 shape, 3 detail, 4 halo, 5 tail.
    """

    esf: Floats
    block: NDArray[np.intp]


def _process(extent: float, smoothness: float) -> Floats:
    """Square root of a Gaussian process's covariance, (SIZE, r), to 1e-4 of its variance."""
    variance, shape = covariance_modes(CENTRES, extent, smoothness, 1e-4)
    return np.asarray(shape * np.sqrt(variance))


@cache
def _fixed() -> tuple[Floats, NDArray[np.intp]]:
    """All directions, with room for the four of the mean in front, and their blocks."""
    processes = [_process(*scales) for scales in (SHAPE, DETAIL, HALO)]
    tail = quasi_interpolant(tail_lsf(CENTRES, TAIL_WIDTH))
    lsf = np.hstack([np.zeros((SIZE, 4)), *processes, tail[:, None]])
    block = np.repeat([0, 1, 2, 3, 4, 5], [3, 1, *(p.shape[1] for p in processes), 1])
    esf = esf_from_lsf(lsf)
    esf[:, -1] += float(tail_esf(np.array(-HALF_SUPPORT), TAIL_WIDTH))
    return esf, block


def directions(blur: GaussianPixel) -> Directions:
    """The directions of the prior around the mean, `blur`.

    The level, width, place and aperture of the mean come first, then the processes and the tail.
    """
    esf, block = _fixed()
    width = blur.width_px
    lsf, by_place, by_sigma, by_aperture = blur.lsf_slopes(CENTRES * width)
    shapes = np.stack([lsf, by_sigma, -by_place, by_aperture], axis=1)
    everything = esf.copy()
    everything[:, :4] = esf_from_lsf(quasi_interpolant(width * shapes))
    return Directions(everything, block)
