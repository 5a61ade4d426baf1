"""The edge spread function (ESF) and the line spread function (LSF)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

import numpy as np

from acutance.curves.estimate import Estimate
from acutance.curves.estimates import Estimates, estimates_of
from acutance.curves.grid import Floats, Places, Rows, as_places, sample
from acutance.curves.short_repr import ShortRepr

__all__ = ["Esf", "Lsf"]


@dataclass(frozen=True, eq=False)
class _SpreadCurve(ShortRepr):
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
        ``factor @ latent @ z``. Nothing of size (n, m) is formed until it is needed.
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
        factor = self.covariance_factor
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", factor, factor)))

    @cached_property
    def covariance_factor(self) -> Floats:
        """All of the covariance's factor, (n, m): its square is the curve's covariance."""
        factor = np.asarray(self.factor)
        return factor if self.latent is None else factor @ self.latent

    def gradient(self, distance_px: float | Floats) -> Floats:
        """The row of `covariance_factor` at any distance, (m,); at an array of them (..., m)."""
        if isinstance(distance_px, np.ndarray):
            return np.asarray(sample(self.distance_px, self.covariance_factor, distance_px))
        row: Floats = sample(self.distance_px, self.factor, distance_px)
        return row if self.latent is None else row @ self.latent

    @overload
    def __call__(self, distance_px: float) -> Estimate: ...
    @overload
    def __call__(self, distance_px: Places) -> Estimates: ...
    def __call__(self, distance_px: Any) -> Estimate | Estimates:
        """The curve at normal distances, by cubic interpolation.

        Parameters
        ----------
        distance_px : float or array_like
            Normal distance from the 50 % point in pixels.

        Returns
        -------
        Estimate or Estimates
            Of a number an `Estimate`, of an array as many in its shape.

        Raises
        ------
        OptionError
            If it holds anything but numbers, or one lies outside the curve.
        """
        at = as_places(distance_px, "distance_px")
        gradient = self.gradient(at)
        std = np.sqrt(np.einsum("...j,...j->...", gradient, gradient))
        return estimates_of(sample(self.distance_px, self.value, at), std)

    def summary(self) -> str:
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
