"""The edge spread function (ESF) and the line spread function (LSF)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats, Rows, one_place, sample
from acutance.curves.one_line import OneLine

__all__ = ["Esf", "Lsf"]


@dataclass(frozen=True, eq=False)
class _SpreadCurve(OneLine):
    """A real curve over the distance along the edge's normal, with its covariance.

    Parameters
    ----------
    distance_px : (n,) array
        Regular grid of normal distances in pixels; 0 is where the ESF passes 50 %, positive
        towards the bright side.
    value : (n,) array
        The curve.
    factor : (n, k) array or Rows
        Factor of the covariance: the curve's error is ``factor @ z`` with z standard normal.
        All curves of one measurement share the same z. A truth has k = 0.
    latent : (k, m) array, optional
        A second factor that all curves of one measurement share: the error is then
        ``factor @ latent @ z``. Nothing of size (n, m) is formed until somebody asks.
    """

    distance_px: Floats
    value: Floats
    factor: Floats | Rows
    latent: Floats | None = None

    def __post_init__(self) -> None:
        n = self.distance_px.shape
        if self.value.shape != n or len(self.factor.shape) != 2 or self.factor.shape[:1] != n:
            raise ValueError(
                f"a curve needs (n,) distances, (n,) values and an (n, k) factor, found shapes "
                f"{n}, {self.value.shape} and {self.factor.shape}"
            )

    @cached_property
    def std(self) -> Floats:
        """Standard deviation at every distance, (n,)."""
        spread = self.covariance_factor
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", spread, spread)))

    @cached_property
    def covariance_factor(self) -> Floats:
        """All of the covariance's factor, (n, m): its square is the curve's covariance."""
        factor = np.asarray(self.factor)
        return factor if self.latent is None else factor @ self.latent

    def gradient(self, distance_px: float) -> Floats:
        """The row of `covariance_factor` at any distance, (m,)."""
        row: Floats = sample(self.distance_px, self.factor, distance_px)
        return row if self.latent is None else row @ self.latent

    def __call__(self, distance_px: float) -> Estimate:
        """The curve at one normal distance, by cubic interpolation.

        At many, take `value` and `std` on `distance_px`.

        Raises
        ------
        OptionError
            If it is not one number, or lies outside the curve.
        """
        distance_px = one_place(distance_px, "distance_px")
        gradient = self.gradient(distance_px)
        value = float(sample(self.distance_px, self.value, distance_px))
        return Estimate(value, math.sqrt(float(gradient @ gradient)))

    def in_words(self) -> str:
        """Where it runs."""
        first, last = self.distance_px[[0, -1]]
        return f"distance_px {first:g} to {last:g}, {self.distance_px.size} places"

    def to_dict(self) -> dict[str, list[float]]:
        """Distances, values and standard deviations as lists."""
        return {
            "distance_px": np.round(self.distance_px, 6).tolist(),
            "value": self.value.tolist(),
            "std": self.std.tolist(),
        }


class Esf(_SpreadCurve):
    """Edge spread function: 0 on the dark plateau, 1 on the bright one (no unit)."""


class Lsf(_SpreadCurve):
    """Line spread function, the derivative of the ESF along the normal (1/px), area 1."""
