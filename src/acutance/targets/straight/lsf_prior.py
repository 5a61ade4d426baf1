"""The prior of the line spread function (LSF): how it may differ from a Gaussian through a pixel.

The mean is the Gaussian through a pixel that fits the target best; its level, width, place and
aperture are directions of their own. The other directions come in blocks, each with an amplitude
that the data determine:

- the families of sensors (`learn_lsf`): the principal directions in which telescopes, halos,
  trails, smear, sharpened and resampled products depart from the mean;
- "detail": a smooth process near the peak, for what no family has;
- a tail like 1/u^2, as behind a diffracting aperture.

Directions are coefficients of the spline (`spline`) and a share of the tail, which reaches beyond
the spline and has a closed form.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
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
from acutance.targets.straight.tuned import DETAIL, FAMILY_LOG_AMPLITUDES, TAIL_WIDTH

__all__ = [
    "FIRST_BLOCK",
    "Directions",
    "blur_directions",
    "directions",
    "fixed_directions",
    "tail_spline",
]

FIRST_BLOCK = 2
"""Number of the first block whose amplitude the data determine."""


class Directions(NamedTuple):
    """The directions in which the LSF may differ from the mean.

    Attributes
    ----------
    esf : (CELLS + 3, r) array
        Coefficients of the edge spread function (ESF) for every direction, for an LSF per width,
        without its tail.
    tail : (r,) array
        Share of every direction in the tail.
    block : (r,) int array
        0 level, width and place (free), 1 aperture, then the families, detail and the tail alone.
    """

    esf: Floats
    tail: Floats
    block: NDArray[np.intp]


def _families() -> list[Floats]:
    """The directions of every family, (SIZE + 1, r) each: spline and tail."""
    path = files("acutance.targets.straight").joinpath("lsf_families.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as learned:
        return [learned[name].astype(float) for name in FAMILY_LOG_AMPLITUDES]


def _detail() -> Floats:
    """Square root of the covariance of the process of fine structure, (SIZE + 1, r)."""
    variance, shape = covariance_modes(CENTRES, *DETAIL, 1e-4)
    return np.vstack([shape * np.sqrt(variance), np.zeros(variance.size)])


@cache
def _fixed() -> Directions:
    """All directions, with room for the four of the mean in front."""
    alone = np.zeros((SIZE + 1, 1))
    alone[-1] = 1.0
    blocks = [*_families(), _detail(), alone]
    every = np.hstack([np.zeros((SIZE + 1, 4)), *blocks])
    sizes = [3, 1, *(block.shape[1] for block in blocks)]
    return Directions(esf_from_lsf(every[:-1]), every[-1], np.repeat(np.arange(len(sizes)), sizes))


def fixed_directions() -> tuple[Floats, Floats]:
    """The directions behind the four of the mean: ESF, (CELLS + 3, k), and share of the tail."""
    fixed = _fixed()
    return fixed.esf[:, 4:], fixed.tail[4:]


@cache
def tail_spline() -> Floats:
    """ESF coefficients of the tail within the spline's support, (CELLS + 3,)."""
    esf = esf_from_lsf(quasi_interpolant(tail_lsf(CENTRES, TAIL_WIDTH)))
    return np.asarray(esf + float(tail_esf(np.array(-HALF_SUPPORT), TAIL_WIDTH)))


def directions(blur: GaussianPixel) -> Directions:
    """The directions of the prior around the mean, `blur`.

    The level, width, place and aperture of the mean come first, then the families, detail and the
    tail alone.
    """
    fixed = _fixed()
    everything = fixed.esf.copy()
    everything[:, :4] = blur_directions(blur)
    return Directions(everything, fixed.tail, fixed.block)


def blur_directions(blur: GaussianPixel) -> Floats:
    """ESF coefficients of level, width, place and aperture of a blur, (CELLS + 3, 4)."""
    width = blur.width_px
    lsf, by_place, by_sigma, by_aperture = blur.lsf_slopes(CENTRES * width)
    shapes = np.stack([lsf, by_sigma, -by_place, by_aperture], axis=1)
    return esf_from_lsf(quasi_interpolant(width * shapes))
