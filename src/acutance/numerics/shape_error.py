"""What the functions of a model cannot follow of a transfer function's shape.

A transfer function (OTF) is fitted as a Gaussian through a pixel and a finite number of functions
about it. What these cannot follow is a share of how far the OTF departs from the Gaussian, with a
sign of its own at every frequency. No data show it: it is in no residual where the functions follow
the pixels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.transfer import phasor

__all__ = ["ShapeError"]

Complexes = NDArray[np.complex128]

_STEP_CPP = 0.05
_ANGLES = 12
_LENGTH_CPP = 0.2
"""Over which frequencies it is one error."""
_PLACES_CPP: Floats = np.asarray(np.arange(0.0, 1.75, 0.25))


@dataclass(frozen=True, eq=False)
class ShapeError:
    """Standard deviation of the error, the same in all directions.

    Attributes
    ----------
    freq_cpp : (n,) array
        From zero.
    std : (n,) array
        0 at zero frequency, where an OTF is one whatever its shape.
    """

    freq_cpp: Floats
    std: Floats

    @classmethod
    def of(
        cls, departure: Callable[[Floats, Floats], Complexes], highest_cpp: float, share: float
    ) -> ShapeError:
        """A share of a departure: of its root mean square over directions and near frequencies.

        Parameters
        ----------
        departure : function of (u, v)
            How far the OTF departs from the Gaussian, (n,).
        highest_cpp : float
        share : float
        """
        freq = np.arange(0.0, highest_cpp + _STEP_CPP, _STEP_CPP)
        angle = np.pi * np.arange(_ANGLES) / _ANGLES
        u, v = (np.outer(freq, wave(angle)).ravel() for wave in (np.cos, np.sin))
        power = np.mean(np.abs(departure(u, v).reshape(freq.size, -1)) ** 2, axis=1)
        near = np.exp(-0.5 * ((freq[:, None] - freq) / _LENGTH_CPP) ** 2)
        std = share * np.sqrt(near @ power / near.sum(axis=1))
        std[0] = 0.0
        return cls(freq, std)

    def with_another(self, other: ShapeError | None) -> ShapeError:
        """This one and an independent one."""
        if other is None:
            return self
        freq = np.union1d(self.freq_cpp, other.freq_cpp)
        stds = [np.interp(freq, one.freq_cpp, one.std) for one in (self, other)]
        return ShapeError(freq, np.hypot(*stds))

    def factor(self, freq_cpp: Floats, otf: Complexes) -> Complexes:
        """Factor (n, m) of its covariance along an OTF (n,) at frequencies (n,)."""
        near = np.exp(-0.5 * ((freq_cpp[:, None] - _PLACES_CPP) / _LENGTH_CPP) ** 2)
        near /= np.linalg.norm(near, axis=1, keepdims=True)
        std = np.interp(freq_cpp, self.freq_cpp, self.std)
        return np.asarray((phasor(otf) * std)[:, None] * near)
