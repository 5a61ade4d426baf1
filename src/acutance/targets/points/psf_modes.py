"""Modes of a Gaussian process in the plane: products of Hermite functions across and along.

By Mehler's formula they are the eigenfunctions of a process whose functions extend over L about the
origin and vary over l (`acutance.numerics.process_modes`), with variances that fall by a constant
factor from order to order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.process_modes import mehler

__all__ = ["Process", "add_modes", "hermite", "hermite_slopes"]

_FARTHEST: Final = 35.0
"""Distance from which on Hermite functions are nothing: 1e-266."""


@dataclass(frozen=True)
class Process:
    """A Gaussian process of extent L and smoothness l, in widths, up to an order of its modes.

    Its amplitude is normalised so that, integrated over one direction, it has the variance of
    the process of an LSF with the same L and l at the line's middle.
    """

    extent: float
    smoothness: float
    order: int

    @property
    def ratio(self) -> float:
        """Factor of the variance from one order to the next."""
        return mehler(self.extent, self.smoothness)[0]

    @property
    def scale(self) -> float:
        """Scale of the Hermite functions, in widths."""
        return mehler(self.extent, self.smoothness)[1]

    @cached_property
    def orders(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Orders across and along of every mode."""
        i, j = np.indices((self.order + 1, self.order + 1)).reshape(2, -1)
        kept = i + j <= self.order
        return i[kept], j[kept]

    @cached_property
    def sizes(self) -> Floats:
        """Standard deviation of every mode's coefficient, relative to the process."""
        i, j = self.orders
        inverse = 1 / self.extent**2
        lsf_variance = 2 * np.pi / math.sqrt(inverse * (inverse + 2 / self.smoothness**2))
        middle = math.pi * (1 - self.ratio**2) * self.ratio ** (i + j)
        return np.asarray(np.sqrt(middle / lsf_variance))


@compiled
def hermite(t: Floats, order: int) -> Floats:
    """Orthonormal Hermite functions 0 .. order at `t` (n,), as (order + 1, n)."""
    values = np.zeros((order + 1, t.size))
    rise, fall = np.empty(order + 1), np.empty(order + 1)
    for n in range(1, order + 1):
        rise[n], fall[n] = math.sqrt(2 / n), math.sqrt((n - 1) / n)
    for i in range(t.size):
        # Numbers too small to be normal are slow.
        if abs(t[i]) < _FARTHEST:
            before, own = 0.0, math.pi**-0.25 * math.exp(-0.5 * t[i] * t[i])
            values[0, i] = own
            for n in range(1, order + 1):
                before, own = own, rise[n] * t[i] * own - fall[n] * before
                values[n, i] = own
    return values


def hermite_slopes(values: Floats) -> Floats:
    """Derivatives by t of the Hermite functions but the last, from the functions."""
    orders = np.arange(values.shape[0] - 1)[:, None]
    slopes = -np.sqrt((orders + 1) / 2) * values[1:]
    slopes[1:] += np.sqrt(orders[1:] / 2) * values[: slopes.shape[0] - 1]
    return slopes


@compiled
def add_modes(
    found: Floats,
    first: int,
    pixel: NDArray[np.intp],
    light: Floats,
    across: Floats,
    along: Floats,
    order_x: NDArray[np.intp],
    order_y: NDArray[np.intp],
    sizes: Floats,
) -> None:
    """Add the light of modes at places (n,) to the rows of their pixels, from a column on.

    The modes (r,) are products of Hermite functions, (order + 1, n) each, of the given orders.
    """
    for i in range(pixel.size):
        row = found[pixel[i]]
        for k in range(sizes.size):
            mode = across[order_x[k], i] * along[order_y[k], i]
            row[first + k] += light[i] * sizes[k] * mode
