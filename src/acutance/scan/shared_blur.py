"""How much of the blur that all edges share may be their objects': the ridge, integrated.

A sensor a little sharper under objects that are all a little softer explains the edges nearly as
well. With few sharp objects, or few at all, the likelihood falls slowly towards sharper sensors and
steeply towards softer ones, until no law of softness (`acutance.scan.softness`) has objects like
these. Its normal approximation about the top does not know that. So along this one direction, a
blur the same all around, the posterior is integrated: its mean is the sensor's, and by what its
variance exceeds that of the approximation the sensor is known less well.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import changed
from acutance.scan.population import EdgeLikelihoods, Membership, fit_shares

__all__ = ["SharedBlur", "integrate_shared_blur"]

_STEPS: Final[Floats] = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 14.0])
"""Places on either side of the top, in standard deviations of the normal approximation."""
_NEGLIGIBLE: Final = 7.0
"""Fall of the log likelihood beyond which nothing is left."""
_WIDEST_PX2: Final = 0.05
"""Standard deviation of places of a likelihood without curvature."""
_MOST_PX2: Final = 0.4
"""How far places are tried: more hides the sensor."""


class SharedBlur(NamedTuple):
    """The posterior of a blur that is the same in all directions, about the likeliest sensor.

    Attributes
    ----------
    mean_px2 : float
        Variance by which the sensor's blur exceeds that of the likeliest: mostly negative.
    excess_px2 : float
        Standard deviation beyond that of the normal approximation.
    """

    mean_px2: float
    excess_px2: float


def integrate_shared_blur(
    edges: EdgeLikelihoods, otf: Floats, member: Membership, mode: Floats, information: Floats
) -> SharedBlur:
    """The posterior of a blur all around, the objects' laws being the likeliest of every place.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
        The likeliest sensor along the bins.
    member : Membership
        What every edge is under it.
    mode : (b, k) array
        Change of the logarithm of the OTF by a variance of 1 px^2.
    information : (b * 2 k, b * 2 k) array
        Of the edges about the sensor, of the normal approximation.
    """
    slope = (otf * np.hstack([mode, mode])).ravel()
    curvature = float(slope @ information @ slope)
    std = 1 / math.sqrt(curvature) if curvature > _WIDEST_PX2**-2 else _WIDEST_PX2

    def log_likelihood(blur_px2: float) -> float:
        return fit_shares(edges, changed(otf, mode * blur_px2), member.share)[1].log_likelihood

    found = {0.0: member.log_likelihood}
    for side in (-std, std):
        for place in (side * _STEPS[_STEPS * std < _MOST_PX2]).tolist():
            found[place] = log_likelihood(place)
            if found[place] < member.log_likelihood - _NEGLIGIBLE:
                break
    places, height = (np.array(column) for column in zip(*sorted(found.items()), strict=True))
    weight = np.exp(height - height.max()) * np.gradient(places)
    mean = float(np.average(places, weights=weight))
    variance = float(np.average((places - mean) ** 2, weights=weight))
    return SharedBlur(mean, math.sqrt(max(variance - std**2, 0.0)))
