"""Reading a curve that is sampled on a regular grid, and its covariance with it."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from acutance.errors import OptionError

__all__ = ["Floats", "Rows", "crossing", "one_place", "sample", "slope"]

Floats = NDArray[np.float64]


class Rows(Protocol):
    """A matrix (n, k) that makes its rows when somebody asks: most of a factor is never read."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the whole matrix."""

    def __getitem__(self, rows: slice, /) -> Floats: ...

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats: ...

    def with_column(self, column: Floats, /) -> Rows:
        """The matrix with one more column, (n,), at its end."""


def _cell(grid: Floats, at: float) -> tuple[slice, float, float]:
    """The four grid points around `at`, its place among them (0 to 3) and the grid's step."""
    start, size = grid.item(0), grid.size
    step = grid.item(1) - start
    position = (at - start) / step
    if not -1e-9 <= position <= size - 1 + 1e-9:
        stop = start + step * (size - 1)
        raise OptionError(f"{at:g} lies outside the curve, which runs from {start:g} to {stop:g}")
    first = min(max(math.floor(position) - 1, 0), size - 4)
    return slice(first, first + 4), position - first, step


def one_place(at: Any, grid: str) -> float:
    """The place at which somebody asks for a curve.

    Parameters
    ----------
    at : float
    grid : str
        What the curve's own places are called, for the message.

    Raises
    ------
    OptionError
        If it is not one number.
    """
    if not isinstance(at, Real) and np.ndim(at) > 0:
        raise OptionError(
            f"a curve was called at {np.size(at)} places: call it at one, or take its arrays, "
            f"`value` and `std` on `{grid}`"
        )
    try:
        return float(at)
    except (TypeError, ValueError):
        raise OptionError(f"a curve was called at {at!r}, which is no number") from None


def sample(grid: Floats, values: NDArray[Any] | Rows, at: float) -> Any:
    """Cubic interpolation of `values` (n,) or (n, k), given on a regular `grid` (n,).

    Interpolation is linear in the values, so it carries a covariance factor as well.

    Raises
    ------
    OptionError
        If `at` lies outside the grid.
    """
    window, t, _ = _cell(grid, at)
    a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
    weights = np.array([-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0])
    return weights @ values[window]


def slope(grid: Floats, values: Floats, at: float) -> float:
    """Derivative of the interpolated curve at one place."""
    window, t, step = _cell(grid, at)
    a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
    weights = np.array(
        [
            -(c * d + b * d + b * c) / 6.0,
            (c * d + a * d + a * c) / 2.0,
            -(b * d + a * d + a * b) / 2.0,
            (b * c + a * c + a * b) / 6.0,
        ]
    )
    return float(weights @ values[window]) / step


def crossing(grid: Floats, values: Floats, level: float, start: float, direction: int = 1) -> float:
    """Where the curve first passes `level`, going from `start` in `direction` (+1 or -1).

    Returns ``nan`` when it never does.
    """
    origin = int(grid.searchsorted(start))
    side = values[origin:] if direction > 0 else values[: origin + 1][::-1]
    places = grid[origin:] if direction > 0 else grid[: origin + 1][::-1]
    if side.size < 2:
        return math.nan
    above = side > level
    changes = (above[1:] != above[:-1]).nonzero()[0]
    if changes.size == 0:
        return math.nan
    i = int(changes[0])
    x0, x1 = float(places[i]), float(places[i + 1])
    y0, y1 = float(side[i]) - level, float(side[i + 1]) - level
    guess = x0 + (x1 - x0) * y0 / (y0 - y1)
    steepness = (y1 - y0) / (x1 - x0)
    # One step on the cubic removes what the chord leaves.
    residual = float(sample(grid, values, guess)) - level
    refined = guess - residual / steepness
    return refined if min(x0, x1) <= refined <= max(x0, x1) else guess
