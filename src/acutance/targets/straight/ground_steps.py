"""Ground that is not uniform beside a straight target: strips, steps and slopes parallel to it.

What lies beside an edge does not cross its line: its image is that of steps parallel to the edge,
seen through the same blur. Each side has a random walk of its own, which begins where the blur of
the edge ends: steps at fixed distances, with variances proportional to their spacing, and an
amplitude that the data determine. A camera's halo differs: it has the same shape on both sides of
an edge and falls (`lsf_prior`).
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import GaussianPixel

__all__ = ["ground_steps"]

_FIRST_WIDTHS, _STEP_WIDTHS = 1.5, 0.5
_EVEN_WIDTHS = 6.0
_GROWTH = 1.25


def ground_steps(outwards: Floats, blur: GaussianPixel) -> tuple[Floats, Floats]:
    """Blurred steps of the ground on one side of a target.

    Parameters
    ----------
    outwards : (n,) array
        Distance of the pixels outwards from the target's last step on this side, px.
    blur : GaussianPixel

    Returns
    -------
    steps : (k, n) array
        Response to a unit step at each distance.
    scale : (k,) array
        Standard deviation of every step: the root of its spacing in widths of the blur.
    """
    width = blur.width_px
    far = float(outwards.max()) / width - 1.0
    places = [_FIRST_WIDTHS]
    while (step := max(_STEP_WIDTHS, (_GROWTH - 1) * (places[-1] - _EVEN_WIDTHS + 2))) + places[-1] < far:
        places.append(places[-1] + step)
    at = np.array(places)
    spacing = np.diff(at, prepend=at[0] - _STEP_WIDTHS)
    steps = np.array([blur.esf(outwards - place * width) for place in at])
    return steps, np.sqrt(spacing)
