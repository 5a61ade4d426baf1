"""How much of the blur that all edges share may be their objects': the ridges, integrated.

A sensor a little sharper under objects that are all a little softer explains the edges nearly as
well. With few sharp objects, or few at all, the likelihood falls slowly towards sharper sensors and
steeply towards softer ones, until no law of softness (`acutance.scan.softness`) has objects like
these. Its normal approximation about the top does not know that. Objects of one direction may be
softer than others (`acutance.scan.shares`), so there is such a ridge for every blur that edges see:
all around, across more than along, oblique. Along the principal axes of what the edges say of
these the posterior is integrated, each by itself: its mean is the sensor's, and by what its
variance exceeds that of the approximation the sensor is known less well.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import changed
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.information import expected_information
from acutance.scan.population import Membership, fit_shares

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
    """The posterior of the blurs that edges see, about the likeliest sensor.

    Attributes
    ----------
    mean_px2 : (q,) array
        By how much the sensor's exceed those of the likeliest, of every mode: mostly negative.
    errors_px2 : (r, q) array
        Independent errors beyond the normal approximation, a row each.
    """

    mean_px2: Floats
    errors_px2: Floats


def integrate_shared_blur(
    edges: EdgeLikelihoods, otf: Floats, member: Membership, modes: Floats, information: Floats
) -> SharedBlur:
    """The posterior of the blurs, the objects' laws being the likeliest of every place.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
        The likeliest sensor along the bins.
    member : Membership
        What every edge is under it.
    modes : (b, k, q) array
        Change of the logarithm of the OTF by a unit of every blur.
    information : (b * 2 k, b * 2 k) array
        Of the edges about the sensor, of the normal approximation.
    """
    axes, curvature = _axes(edges, otf, member, modes, information)
    found = [
        _along_axis(edges, otf, member, modes @ axis, size)
        for axis, size in zip(axes, curvature.tolist(), strict=True)
    ]
    means, excess = np.array(found).reshape(-1, 2).T
    return SharedBlur(means @ axes, excess[:, None] * axes)


def _axes(
    edges: EdgeLikelihoods, otf: Floats, member: Membership, modes: Floats, information: Floats
) -> tuple[Floats, Floats]:
    """Principal axes of the blurs that edges see, (r, q), and the information about each, (r,)."""
    slopes = otf[:, :, None] * np.concatenate([modes, modes], axis=1)
    complete = np.einsum("bkq,bkl,blp->qp", slopes, expected_information(edges, member)[0], slopes)
    size, axes = np.linalg.eigh(complete)
    # Of the others only what is known of sensors tells.
    seen = axes[:, size > _WIDEST_PX2**-2]
    flat = slopes.reshape(-1, slopes.shape[2]) @ seen
    size, turned = np.linalg.eigh(flat.T @ information @ flat)
    return (seen @ turned).T, size


def _along_axis(
    edges: EdgeLikelihoods, otf: Floats, member: Membership, mode: Floats, curvature: float
) -> tuple[float, float]:
    """Mean along one axis, and standard deviation beyond the normal approximation, px^2."""
    std = 1 / math.sqrt(curvature) if curvature > _WIDEST_PX2**-2 else _WIDEST_PX2

    def log_likelihood(blur_px2: float) -> float:
        return fit_shares(edges, changed(otf, mode * blur_px2), member.share).log_likelihood

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
    return mean, math.sqrt(max(variance - std**2, 0.0))
