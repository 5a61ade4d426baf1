"""The transfer function fitted to bars and stars: modes about a blur, with their covariance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.periodic.otf_modes import MEAN_MODES, Complexes, PlaneBlur, ProcessModes
from acutance.targets.periodic.star_waves import HIGHEST_CPP

__all__ = ["PlaneModel"]


@dataclass(frozen=True, eq=False)
class PlaneModel:
    """An OTF over the plane, with its covariance (`acutance.curves.OtfModel`).

    Attributes
    ----------
    blur : PlaneBlur
        Mean of the OTF.
    beta : (m,) array
        Coefficients of the modes, or of the mean's alone; their sum at zero frequency is the
        level.
    spread : (m, k) array
        Factor of the covariance of beta.
    """

    blur: PlaneBlur
    beta: Floats
    spread: Floats

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return HIGHEST_CPP

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,)."""
        return np.asarray(self._modes(u_cpp, v_cpp) @ self.beta / self.level)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        modes = self._modes(u_cpp, v_cpp)
        otf = modes @ self.beta / self.level
        return np.asarray((modes - np.outer(otf, self.at_zero)) @ self.spread / self.level)

    @cached_property
    def level(self) -> float:
        """Amplitude of the star before the sensor."""
        return float(self.at_zero @ self.beta)

    @property
    def level_std(self) -> float:
        """Its standard deviation."""
        return float(np.linalg.norm(self.at_zero @ self.spread))

    @cached_property
    def at_zero(self) -> Floats:
        """What every coefficient adds to the level, (m,)."""
        return np.asarray(self._modes(np.zeros(1), np.zeros(1))[0].real)

    def _modes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        mean = self.blur.modes(u_cpp, v_cpp)
        if self.beta.size == MEAN_MODES:
            return mean
        return np.hstack([mean, ProcessModes(self.blur.width_px).plane(u_cpp, v_cpp)])
