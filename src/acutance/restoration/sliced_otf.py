"""The transfer of a sensor over the plane, exactly as its slices state it where they are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.direction_waves import between_directions
from acutance.targets.combine.curves import OtfSamples
from acutance.targets.slices import OtfSlices

__all__ = ["SlicedOtf"]

Complexes = NDArray[np.complex128]

_FADE_CPP = (0.2, 0.4)
"""What slices say beyond their last frequency: nothing from the second of these distances on."""


@dataclass(frozen=True, eq=False)
class SlicedOtf(ShortRepr):
    """Slices of an optical transfer function (OTF), and a model between them: an `OtfModel`.

    A fit to slices draws on a prior. Slices of a finished measurement hold its prior already, so
    they are no data to be weighed against another one: along them this OTF and its deviations are
    theirs. Elsewhere the model's are corrected by what both differ by along the slices, carried
    over the frequencies by cubic splines and over the directions by the smoothest waves.

    Parameters
    ----------
    model : OtfModel
        The fit to the slices.
    slices : OtfSlices
    """

    model: OtfModel
    slices: OtfSlices

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return self.model.band_cpp

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        u, v = self.slices.places
        lacking = self._samples.otf - self.model.otf(u, v)
        return np.asarray(
            self.model.otf(u_cpp, v_cpp) + self._carried(lacking[:, None], u_cpp, v_cpp)[:, 0]
        )

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k), exactly 0 at zero frequency.

        The errors are those of the slices, carried as their values are, and between the slices
        those of the model, less what was carried of them.
        """
        own = self._carried(self._samples.factor, u_cpp, v_cpp)
        between = self.model.factor(u_cpp, v_cpp)
        between = between - self._carried(self.model.factor(*self.slices.places), u_cpp, v_cpp)
        return np.concatenate([own, between], axis=1)

    @cached_property
    def _samples(self) -> OtfSamples:
        """The slices about their common centroid, as those of the model."""
        u, v = self.slices.places
        return OtfSamples("slices", u, v, self.slices.otf, self.slices.factor).centred()

    def _carried(self, along: Complexes, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Values (m * n, k) at the places of the slices, carried to others, (places, k)."""
        directions, freq = self.slices.normal_deg, self.slices.freq_cpp
        values = along.reshape(directions.size, freq.size, -1)
        nodes = np.concatenate([[0.0], freq, freq[-1] + np.array(_FADE_CPP)])
        # Nothing at zero frequency, half of the last value where it fades, and then nothing.
        ends = np.zeros_like(values[:, :1])
        known = np.concatenate([ends, values, 0.5 * values[:, -1:], ends], axis=1)
        spline = CubicSpline(nodes, known, axis=1, bc_type="clamped")
        radius = np.hypot(u_cpp, v_cpp)
        at = spline(np.minimum(radius, nodes[-1]))
        angle_deg = np.degrees(np.arctan2(v_cpp, u_cpp))
        even, odd = (between_directions(directions, angle_deg, odd=odd) for odd in (False, True))
        real = np.einsum("pm,mpk->pk", even, at.real)
        return np.asarray(real + 1j * np.einsum("pm,mpk->pk", odd, at.imag))
