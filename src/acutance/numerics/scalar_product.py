"""The scalar product of two vectors, for compiled loops."""

from __future__ import annotations

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["scalar_product"]


@compiled
def scalar_product(one: Floats, other: Floats) -> float:
    """Sum of the products of their elements, of two arrays (n,)."""
    total = 0.0
    for k in range(one.size):
        total += one[k] * other[k]
    return total
