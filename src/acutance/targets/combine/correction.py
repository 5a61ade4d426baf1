"""A smooth correction of the logarithm of a parametric optical transfer function (OTF).

The OTF is taken as ``H(u, v) - |H| ln min(|H|, |D|) e (a(u, v) + i b(u, v))``, to first order ``H``
with its logarithm changed by the share ``a``. D is the detector's OTF, which H exceeds only
after sharpening; e makes the largest slope 1. The functions a (even) and b (odd) are Gaussian
processes of one length, written in values at a few frequencies of the plane, so that they are
linear parameters with a normal prior.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.combine.plane import PROCESS_PLACES, Plane
from acutance.targets.combine.sensor_forms import SensorForm

__all__ = ["Correction"]

Complexes = NDArray[np.complex128]

_JITTER = 1e-6


@dataclass(frozen=True)
class Correction(ShortRepr):
    """Directions in which the OTF of a sensor may differ from a parametric one.

    Parameters
    ----------
    form : SensorForm
        The parametric OTF.
    parameters : tuple of float
        Its parameters.
    """

    form: SensorForm
    parameters: tuple[float, ...]

    def directions_on(self, plane: Plane) -> Complexes:
        """Change of the OTF for a unit of every direction, (n, m): exactly 0 at zero frequency."""
        factors = self.form.factors_on(np.array(self.parameters), plane)
        size = np.abs(factors.prod(axis=0))
        # Sharpening multiplies the blur by a gain: the blur is the detector's at most.
        blurred = np.minimum(size, np.abs(factors[-1]))
        reach = -math.e * size * np.log(np.maximum(blurred, 1e-30))
        even, odd = (near @ root for near, root in zip(plane.processes, _roots(), strict=True))
        return np.asarray(reach[:, None] * np.concatenate([even, 1j * odd], axis=1))


@cache
def _roots() -> tuple[Floats, Floats]:
    """Factors that give unit weights the processes' covariance at their places, even and odd."""
    found = []
    for covariance in Plane(*PROCESS_PLACES.T).processes:
        value, vector = np.linalg.eigh(covariance)
        kept = value > _JITTER
        found.append(vector[:, kept] / np.sqrt(value[kept]))
    return found[0], found[1]
