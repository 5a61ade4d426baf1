"""Ways in which a sensor may change: along the parameters of its form, or plain blurs.

Turns of expectation and maximisation creep where a change of the sensor may be one of its objects:
of a scene of few edges by a hundredth of the way. Along the parameters of the likeliest form what
the objects are is integrated out (`acutance.scan.blur_modes.fit_modes`), with the prior that the
form has.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import COMMON_MODES, LONGEST_PX2, edge_modes
from acutance.targets.combine.fit import FormFit
from acutance.targets.combine.plane import Plane
from acutance.targets.slices import places_along

__all__ = ["Ways", "blur_ways", "form_ways"]

_LEAST_OTF: Final = 0.03
"""Of less the logarithm has no meaning: a change to first order is none of a share."""
_LONGEST_STD: Final = 2.0
"""Prior standard deviations over which an OTF is the exponential of its slopes."""


class Ways(NamedTuple):
    """Ways in which the OTF along directions may change, with a prior.

    Attributes
    ----------
    modes : (b, k, q) array
        Change of the logarithm of the OTF by a unit of every way.
    mean, std : (q,) array
        Of the prior of the amounts.
    longest : float
        Longest step of the amounts.
    """

    modes: Floats
    mean: Floats
    std: Floats
    longest: float


def blur_ways(normal_deg: Floats, freq_cpp: Floats) -> Ways:
    """Blurs that a sensor and all of its objects may have in common, px^2."""
    modes = edge_modes(normal_deg, freq_cpp)[:, :, :COMMON_MODES]
    return Ways(modes, np.zeros(COMMON_MODES), np.full(COMMON_MODES, np.inf), LONGEST_PX2)


def form_ways(fit: FormFit, normal_deg: Floats, freq_cpp: Floats) -> Ways:
    """Parameters and correction of a form, in prior standard deviations from where it is.

    Parameters
    ----------
    fit : FormFit
    normal_deg : (b,) array
    freq_cpp : (k,) array
    """
    plane = Plane(*places_along(normal_deg, freq_cpp))
    otf, slopes = fit.otf_on(plane)[:, None], fit.slopes_on(plane)
    relative = np.real(np.conj(otf) * slopes) / (np.abs(otf) ** 2 + _LEAST_OTF**2)
    std = fit.prior_std
    away = np.concatenate([fit.parameters - fit.form.mean, fit.weights]) / std
    modes = (relative * std).reshape(normal_deg.size, freq_cpp.size, std.size)
    return Ways(modes, -away, np.ones(std.size), _LONGEST_STD)
