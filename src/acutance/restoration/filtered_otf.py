"""The transfer of a kernel, and of a sensor behind it, with the sensor's covariance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.optics import Sensor

__all__ = ["FilteredOtf", "RememberedOtf", "SensorOtf", "kernel_otf"]

Complexes = NDArray[np.complex128]

_SENSOR_BAND_CPP = 4.0


def kernel_otf(kernel: Floats, u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """Transfer function of a kernel at frequencies (n,): 1 at zero where the kernel sums to 1.

    Parameters
    ----------
    kernel : (m, m) array
        Odd size; rows run along v, its middle is the origin.
    u_cpp, v_cpp : (n,) array
        Across and along, cycles per pixel.
    """
    reach = np.arange(kernel.shape[0]) - kernel.shape[0] // 2
    down = np.exp(-2j * math.pi * np.outer(v_cpp, reach))
    across = np.exp(-2j * math.pi * np.outer(u_cpp, reach))
    return np.asarray(np.einsum("fi,fi->f", down @ kernel, across))


@dataclass(frozen=True, eq=False)
class FilteredOtf(ShortRepr):
    """The transfer of a sensor and a kernel after it: an `OtfModel`.

    The kernel is known exactly, so the errors of the sensor's OTF are multiplied by its transfer.

    Parameters
    ----------
    model : OtfModel
        The sensor.
    kernel : (m, m) array
    """

    model: OtfModel
    kernel: Floats

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return self.model.band_cpp

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Transfer of both, (n,)."""
        return kernel_otf(self.kernel, u_cpp, v_cpp) * self.model.otf(u_cpp, v_cpp)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): in the same latent variables as the sensor's."""
        gain = kernel_otf(self.kernel, u_cpp, v_cpp)
        return np.asarray(gain[:, None] * self.model.factor(u_cpp, v_cpp))


@dataclass(frozen=True, eq=False)
class RememberedOtf(ShortRepr):
    """A model that is computed once at the same frequencies: many kernels are tried on it.

    Parameters
    ----------
    model : OtfModel
    """

    model: OtfModel
    _otf: dict[bytes, Complexes] = field(default_factory=dict, repr=False, compare=False)
    _factor: dict[bytes, Complexes] = field(default_factory=dict, repr=False, compare=False)

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return self.model.band_cpp

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,)."""
        key = u_cpp.tobytes() + v_cpp.tobytes()
        if key not in self._otf:
            self._otf[key] = self.model.otf(u_cpp, v_cpp)
        return self._otf[key]

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        key = u_cpp.tobytes() + v_cpp.tobytes()
        if key not in self._factor:
            self._factor[key] = self.model.factor(u_cpp, v_cpp)
        return self._factor[key]


@dataclass(frozen=True, eq=False)
class SensorOtf(ShortRepr):
    """A sensor that is known exactly, as an `OtfModel`: about its centroid.

    Parameters
    ----------
    sensor : Sensor
    """

    sensor: Sensor

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which the rest of the transfer is left out."""
        return _SENSOR_BAND_CPP

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), its phase relative to the centroid of the point spread function."""
        x, y = (self.sensor.profile(angle).centroid_px for angle in (0.0, 90.0))
        turn = np.exp(2j * math.pi * (u_cpp * x + v_cpp * y))
        return np.asarray(self.sensor.otf(u_cpp, v_cpp) * turn)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """A factor without columns, (n, 0)."""
        return np.zeros((u_cpp.size, 0), complex)
