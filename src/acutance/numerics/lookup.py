"""Cubic interpolation of tables that are given at regular places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["CubicLookup"]

_Number = TypeVar("_Number", np.float64, np.complex128)


@dataclass(frozen=True, eq=False)
class CubicLookup:
    """Where some places lie between the rows of a table, and the weights of four rows for each.

    Attributes
    ----------
    first : (n,) int array
        The first of the four rows.
    weights : (4, n) array
        Lagrange's weights.
    """

    first: NDArray[np.intp]
    weights: Floats

    @classmethod
    def of(cls, at: Floats, places: Floats) -> CubicLookup:
        """Places `at` in a table whose rows stand at the regular `places`."""
        position = (at - places[0]) / (places[1] - places[0])
        first = np.clip(np.floor(position).astype(np.intp) - 1, 0, places.size - 4)
        t = position - first
        a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
        weights = np.stack([-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6])
        return cls(first, weights)

    def __call__(self, table: NDArray[_Number]) -> NDArray[_Number]:
        """A table (rows, k) at the places, (n, k)."""
        total: NDArray[_Number] = self.weights[0][:, None] * table[self.first]
        for k in range(1, 4):
            total += self.weights[k][:, None] * table[self.first + k]
        return total
