"""The edge spread function (ESF) and the line spread function (LSF)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, overload

import numpy as np

from acutance.arguments import require_numbers
from acutance.curves.estimate import Estimate
from acutance.curves.estimates import Estimates, estimates_of
from acutance.curves.grid import (
    Cubic,
    Floats,
    Places,
    Rows,
    as_places,
    crossing,
    listed,
    require_curve,
    sample,
)
from acutance.curves.reading import UNDEFINED, Reading
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

    Raises
    ------
    OptionError
        If they are no arrays of such shapes, or distances are no regular grid.
    """

    distance_px: Floats
    value: Floats
    factor: Floats | Rows
    latent: Floats | None = None

    def __post_init__(self) -> None:
        require_curve(
            "distance_px", self.distance_px, self.value, self.factor, self.latent, kind="a curve"
        )

    @cached_property
    def std(self) -> Floats:
        """Standard deviation at every distance, (n,)."""
        return _lengths(self.covariance_factor)

    @cached_property
    def covariance_factor(self) -> Floats:
        """All of the covariance's factor, (n, m): its square is the curve's covariance."""
        return np.asarray(self.factor) if self.latent is None else self.factor @ self.latent

    def at(self, distance_px: float) -> Cubic:
        """Interpolation of the curve, and of the rows of its factor, at one distance."""
        require_numbers(distance_px=distance_px)
        return Cubic.at(self.distance_px, distance_px)

    def row(self, distance_px: float) -> Floats:
        """The row of `factor` at any distance, (k,)."""
        found: Floats = self.at(distance_px).sample(self.factor)
        return found

    def passing(self, level: float, start_px: float, direction: int = 1) -> Reading:
        """Where it first passes `level`, going from `start_px` in `direction` (+1 or -1)."""
        require_numbers(level=level, start_px=start_px)
        place = crossing(self.distance_px, self.value, level, start_px, direction)
        if math.isnan(place):
            return UNDEFINED
        there = self.at(place)
        return Reading(place, there.sample(self.factor) / -there.slope(self.value))

    def gradient(self, distance_px: float | Floats) -> Floats:
        """The row of `covariance_factor` at any distance, (m,); at an array of them (..., m)."""
        at = as_places(distance_px, "distance_px")
        rows: Floats = sample(self.distance_px, self.factor, at)
        return rows if self.latent is None else rows @ self.latent

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
        std = _lengths(self.gradient(at))
        return estimates_of(sample(self.distance_px, self.value, at), std)

    def summary(self) -> str:
        """Where it runs."""
        first, last = self.distance_px[[0, -1]]
        return f"distance_px {first:g} to {last:g}, {self.distance_px.size} places"

    @cached_property
    def thinned(self) -> Self:
        """The curve at every second place: as documents hold it, and checks look at it."""
        own = slice(None, None, 2)
        return replace(
            self,
            distance_px=self.distance_px[own],
            value=self.value[own],
            factor=self.factor[own],
        )

    def arrays(self) -> dict[str, Floats]:
        """Distances, values and standard deviations by name, (n,) each."""
        return {"distance_px": self.distance_px, "value": self.value, "std": self.std}

    def to_dict(self) -> dict[str, list[float]]:
        """Distances, values and standard deviations as lists."""
        return listed(self.arrays())


class Esf(_SpreadCurve):
    """Edge spread function: 0 on the dark plateau, 1 on the bright one (no unit)."""

    @cached_property
    def half_point(self) -> Reading:
        """Where it passes 50 % in its steep part."""
        steepest = int((self.value[1:] - self.value[:-1]).argmax())
        below = (self.value[: steepest + 2] < 0.5).nonzero()[0]
        # From a place on the dark side the next crossing is that of the steep part.
        return self.passing(0.5, self.distance_px.item(below[-1] if below.size else 0))


class Lsf(_SpreadCurve):
    """Line spread function, the derivative of the ESF along the normal (1/px), area 1."""


def _lengths(rows: Floats) -> Floats:
    """Lengths of the rows of a covariance's factor: standard deviations."""
    return np.asarray(np.sqrt(np.einsum("...j,...j->...", rows, rows)))
