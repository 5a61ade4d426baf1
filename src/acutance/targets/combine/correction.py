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
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_forms import SensorForm

__all__ = ["Correction"]

Complexes = NDArray[np.complex128]

_LENGTH_CPP = 0.25
_RINGS = ((0.10, 3), (0.25, 4), (0.40, 6), (0.55, 8), (0.75, 8))
_JITTER = 1e-6


def _places() -> Floats:
    """Places on half of the plane, (m, 2)."""
    found = [
        (radius * math.cos(math.pi * k / count), radius * math.sin(math.pi * k / count))
        for radius, count in _RINGS
        for k in range(count)
    ]
    return np.array(found)


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
        p = np.array(self.parameters)
        size = np.abs(self.form.otf_on(p, plane))
        # Sharpening multiplies the blur by a gain: the blur is the detector's at most.
        blurred = np.minimum(size, np.abs(self.form.factors_on(p, plane)[-1]))
        reach = -math.e * size * np.log(np.maximum(blurred, 1e-30))
        even = self._kernel(plane.u_cpp, plane.v_cpp, 1.0) @ self._roots[0]
        odd = self._kernel(plane.u_cpp, plane.v_cpp, -1.0) @ self._roots[1]
        return np.asarray(reach[:, None] * np.concatenate([even, 1j * odd], axis=1))

    def _kernel(self, u: Floats, v: Floats, parity: float) -> Floats:
        x, y = _places().T
        near = np.exp(-0.5 * ((u[:, None] - x) ** 2 + (v[:, None] - y) ** 2) / _LENGTH_CPP**2)
        far = np.exp(-0.5 * ((u[:, None] + x) ** 2 + (v[:, None] + y) ** 2) / _LENGTH_CPP**2)
        return np.asarray(0.5 * (near + parity * far))

    @cached_property
    def _roots(self) -> tuple[Floats, Floats]:
        """Factors that give unit weights the processes' covariance at the places, even and odd."""
        x, y = _places().T
        found = []
        for parity in (1.0, -1.0):
            value, vector = np.linalg.eigh(self._kernel(x, y, parity))
            kept = value > _JITTER
            found.append(vector[:, kept] / np.sqrt(value[kept]))
        return found[0], found[1]
