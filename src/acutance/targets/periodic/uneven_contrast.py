"""Whether the contrast of bars and stars is equal everywhere, as one sensor makes it.

A transfer scales groups of bars by their frequencies alone, and the mean of a group, half of its
contrast, not at all. The two ends of a spoke through the centre of a star have one
direction and one frequency, so they have one modulation. Where a group, or a side of a star, has
more contrast than the others, its paint, the light or a cloud is different there, and a share of
that is taken for the sensor. The residuals show it, once what the fit takes up of it is left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.periodic.otf_regression import Regression
from acutance.targets.periodic.residual_share import left_of

__all__ = ["uneven_groups", "uneven_sides"]


def uneven_groups(
    fitted: Regression,
    pattern: Floats,
    ends: NDArray[np.intp],
    weight: Floats,
    inflation: float,
) -> tuple[Estimate, ...]:
    """How much more contrast every group of bars has than the others, as a share.

    Parameters
    ----------
    fitted : Regression
    pattern : (n,) array
        The fitted image of the bars above their background, image units.
    ends : (k - 1,) int array
        After which pixels another group begins.
    weight : (n,) array
    inflation : float
        Factor on the noise variance for correlated noise.
    """
    number = np.searchsorted(ends, np.arange(pattern.size), side="right")
    masks = number == np.arange(ends.size + 1)[:, None]
    return tuple(left_of(fitted, (mask * pattern)[None, :], weight, inflation)[0] for mask in masks)


def uneven_sides(
    fitted: Regression,
    spokes: Floats,
    angle: Floats,
    gradient: Floats,
    weight: Floats,
    inflation: float,
) -> Estimate:
    """By which share the contrast of a star rises to one side, other than more light would make it.

    Where the light is stronger, both the mean and the contrast are, and what rises from one side
    to the other in this way changes no MTF. Haze and thin cloud raise the mean and lower the
    contrast.

    Parameters
    ----------
    fitted : Regression
    spokes : (n,) array
        The fitted spokes about their mean, image units.
    angle : (n,) array
        Of a pixel about the centre, from the column axis, in radians.
    gradient : (2,) array
        Of the mean, along x and y.
    weight : (n,) array
    inflation : float
        Factor on the noise variance for correlated noise.
    """
    sides = spokes * np.stack([np.cos(angle), np.sin(angle)])
    found = left_of(fitted, sides, weight, inflation)
    rise = np.array([one.value for one in found])
    steep = float(np.linalg.norm(gradient))
    if steep > 0:
        rise = rise - max(float(rise @ gradient), 0.0) / steep**2 * gradient
    return Estimate(float(np.linalg.norm(rise)), max(one.std for one in found))
