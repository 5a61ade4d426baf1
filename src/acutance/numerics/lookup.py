"""Cubic interpolation of tables that are given at regular places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

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
        found = np.empty((self.first.size, table.shape[1]), table.dtype)
        _interpolate(found, np.ascontiguousarray(table), self.first, self.weights)
        return found


@compiled
def _interpolate(
    found: NDArray[_Number], table: NDArray[_Number], first: NDArray[np.intp], weights: Floats
) -> None:
    """Fill `found` with weighted sums of four rows of a table."""
    for i in range(first.size):
        row = first[i]
        a, b, c, d = weights[0, i], weights[1, i], weights[2, i], weights[3, i]
        for k in range(table.shape[1]):
            found[i, k] = (
                a * table[row, k] + b * table[row + 1, k]
                + c * table[row + 2, k] + d * table[row + 3, k]
            )  # fmt: skip
