"""The OTF fitted to bars and stars: modes about a Gaussian through a pixel, with covariance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.numerics.otf_kernels import kernel_modes, kernel_taps
from acutance.numerics.otf_modes import (
    HIGHEST_CPP,
    MEAN_MODES,
    Complexes,
    MeanOtf,
    ProcessModes,
)
from acutance.numerics.shape_error import ShapeError

__all__ = ["FittedOtf", "all_modes", "level_row", "mode_count", "mode_parts"]


@dataclass(frozen=True, eq=False)
class FittedOtf:
    """A two-dimensional OTF with its covariance (`acutance.curves.OtfModel`).

    Attributes
    ----------
    mean : MeanOtf
        Mean of the optical transfer function (OTF).
    beta : (m,) array
        Coefficients of its modes, of the processes' and of the kernels' (or of its own alone);
        their sum at zero frequency is the level.
    beta_factor : (m, k) array
        Factor of the covariance of beta.
    shape_error : ShapeError, optional
        Of a shape that the modes do not follow, as the pixels show it.
    """

    mean: MeanOtf
    beta: Floats
    beta_factor: Floats
    shape_error: ShapeError | None = None

    @property
    def band_cpp(self) -> float:
        """Highest frequency that is transferred."""
        return HIGHEST_CPP

    def packed(self) -> OtfModel:
        """The same OTF with its covariance rounded, in a twentieth of its size."""
        from acutance.targets.periodic.otf_packed import PackedOtf

        return PackedOtf.of(self)

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,)."""
        return self.of_modes(self._modes(u_cpp, v_cpp))

    def of_modes(self, modes: Complexes) -> Complexes:
        """OTF where all modes are known, (n, m), (n,)."""
        return np.asarray(modes @ self.beta / self.level)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        modes = self._modes(u_cpp, v_cpp)
        otf = self.of_modes(modes)
        # The level is the OTF at zero frequency, where it is 1 without error.
        fitted = (modes - np.outer(otf, self._at_zero)) @ self.beta_factor / self.level
        if self.shape_error is None:
            return np.asarray(fitted)
        return np.hstack([fitted, self.shape_error.factor(np.hypot(u_cpp, v_cpp), otf)])

    @cached_property
    def level(self) -> float:
        """Contrast of bars, or amplitude of a star, before the sensor, image units."""
        return float(self._at_zero @ self.beta)

    @property
    def level_std(self) -> float:
        """Its standard deviation."""
        return float(np.linalg.norm(self._at_zero @ self.beta_factor))

    @cached_property
    def _at_zero(self) -> Floats:
        return level_row(self.beta.size)

    def _modes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        return all_modes(self.mean, self.beta.size, u_cpp, v_cpp)


@cache
def level_row(size: int) -> Floats:
    """Contribution of each of `size` coefficients to the level: its mode at zero frequency.

    There the modes of all means are the same.
    """
    modes = all_modes(MeanOtf(1.0, 0.0, 1.0), size, np.zeros(1), np.zeros(1))
    return np.asarray(modes[0].real)


def mode_count(states: ProcessModes | None) -> int:
    """Number of all modes with `states`, or of the mean's own alone without."""
    if states is None:
        return MEAN_MODES
    return MEAN_MODES + int(states.blocks().size) + int(kernel_taps().shape[-1])


def all_modes(mean: MeanOtf, size: int, u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """The mean's modes and, of more coefficients, the processes' and the kernels', (n, size)."""
    return np.hstack(mode_parts(mean, size, u_cpp, v_cpp))


def mode_parts(mean: MeanOtf, size: int, u_cpp: Floats, v_cpp: Floats) -> list[Complexes]:
    """Those of the mean, of the processes and of the kernels apart, (n, k) each."""
    own = mean.modes(u_cpp, v_cpp)
    if size == MEAN_MODES:
        return [own]
    states = ProcessModes(mean.width_px).otf_modes(u_cpp, v_cpp)
    return [own, states, kernel_modes(mean, u_cpp, v_cpp)]
