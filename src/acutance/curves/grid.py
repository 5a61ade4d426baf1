"""The grids that curves are sampled on, and reading a curve, with its covariance, between them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from acutance.errors import OptionError

__all__ = [
    "DISTANCE_PX",
    "FREQ_CPP",
    "Floats",
    "Places",
    "PlainCurve",
    "Rows",
    "as_places",
    "crossing",
    "listed",
    "sample",
]

Floats = NDArray[np.float64]

Places = Sequence[float] | Floats
"""Many places of a curve; arrays of them may have any number of axes."""


def _regular(first: int, last: int, step: float) -> Floats:
    """Whole multiples of `step`, from ``first * step`` to ``last * step``; cannot be written to."""
    grid = np.asarray(np.arange(first, last + 1) * step)
    grid.setflags(write=False)
    return grid


FREQ_CPP = _regular(0, 100, 0.01)
"""Frequencies of transfer curves, (101,): 0 to 1 cycles per pixel."""

DISTANCE_PX = _regular(-200, 200, 0.05)
"""Distances of spread functions, (401,): 10 px on either side of the 50 % point."""


class Rows(Protocol):
    """A matrix (n, k) of few numbers, most of which is never written out."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the whole matrix."""

    def __getitem__(self, rows: slice, /) -> Rows: ...

    def __matmul__(self, matrix: Floats, /) -> Floats: ...

    def __rmatmul__(self, vector: Floats, /) -> Floats: ...

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats: ...

    def with_column(self, column: Floats, /) -> Rows:
        """The matrix with one more column, (n,), at its end."""


def as_places(at: Any, name: str) -> float | Floats:
    """The place, or the array of places, at which a curve was called.

    Parameters
    ----------
    at : float or array_like
    name : str
        What the places of the curve are called, for the message.

    Raises
    ------
    OptionError
        If it holds anything but real numbers.
    """
    if isinstance(at, float):
        return at
    try:
        places = np.asarray(at)
        if places.dtype.kind not in "biufO":
            raise TypeError
        # Objects one by one: numpy alone would take None for nan.
        numbers = [float(one) for one in places.flat] if places.dtype.kind == "O" else places
        places = np.asarray(numbers, np.float64).reshape(places.shape)
    except (TypeError, ValueError):
        raise OptionError(
            f"{name} is {at!r}, which is no number: call a curve at a number or an array of them"
        ) from None
    return float(places) if places.ndim == 0 else places


def _outside(grid: Floats, at: float) -> OptionError:
    return OptionError(
        f"{at:g} lies outside the curve, which runs from {grid[0]:g} to {grid[-1]:g}"
    )


def _cell(grid: Floats, at: float) -> tuple[int, float]:
    """The first of the four grid points around `at`, and its place among them (0 to 3)."""
    start, size = grid.item(0), grid.size
    position = (at - start) / (grid.item(1) - start)
    if not -1e-9 <= position <= size - 1 + 1e-9:
        raise _outside(grid, at)
    first = min(max(math.floor(position) - 1, 0), size - 4)
    return first, position - first


def _cells(grid: Floats, at: Floats) -> tuple[NDArray[np.intp], Floats]:
    """As `_cell`, at every place of an array: indices (..., 4) and places among them (...)."""
    size = grid.size
    position = (at - grid[0]) / (grid[1] - grid[0])
    inside = (position >= -1e-9) & (position <= size - 1 + 1e-9)
    if not inside.all():
        raise _outside(grid, at[~inside][0])
    first = np.clip(np.floor(position).astype(np.intp) - 1, 0, size - 4)
    return first[..., None] + np.arange(4), position - first


def _cubic_weights(t: Any) -> tuple[Any, Any, Any, Any]:
    """Weights of Lagrange's cubic through the points 0, 1, 2 and 3, at `t`."""
    a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
    return -b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0


def sample(grid: Floats, values: NDArray[Any] | Rows, at: float | Floats) -> Any:
    """Cubic interpolation of `values` (n,) or (n, k), given on a regular `grid` (n,).

    Interpolation is linear in the values, so it carries a covariance factor as well.

    Parameters
    ----------
    grid : (n,) array
    values : (n,) or (n, k) array, or Rows
    at : float or array

    Returns
    -------
    array
        In the shape of `at`, followed by k where there are k columns.

    Raises
    ------
    OptionError
        If any of `at` lies outside the grid.
    """
    if isinstance(at, np.ndarray):
        cells, places = _cells(grid, at)
        columns = np.asarray(values)
        columns = columns if columns.ndim == 2 else columns[:, None]
        found = np.einsum("i...,...ij->...j", np.array(_cubic_weights(places)), columns[cells])
        return found if len(values.shape) == 2 else found[..., 0]
    cell, t = _cell(grid, at)
    weights, near = _cubic_weights(t), values[cell : cell + 4]
    if isinstance(near, np.ndarray) and near.ndim == 1:
        return _sum(weights, near.tolist())
    return np.array(weights) @ near


def _sum(weights: tuple[float, float, float, float], values: Sequence[Any]) -> Any:
    """Weighted sum of four numbers: plain ones are faster than arrays of them."""
    (a, b, c, d), (p, q, r, s) = weights, values
    return a * p + b * q + c * r + d * s


class PlainCurve(NamedTuple):
    """A curve on a regular grid as plain numbers: to read it at one place after the other.

    Attributes
    ----------
    grid : (n,) array
    values : list of float
    """

    grid: Floats
    values: list[float]

    def at(self, place: float) -> float:
        """The interpolated curve at one place."""
        first, t = _cell(self.grid, place)
        return float(_sum(_cubic_weights(t), self.values[first : first + 4]))

    def slope(self, place: float) -> float:
        """Its derivative."""
        first, t = _cell(self.grid, place)
        a, b, c, d = t, t - 1.0, t - 2.0, t - 3.0
        weights = (
            -(c * d + b * d + b * c) / 6.0,
            (c * d + a * d + a * c) / 2.0,
            -(b * d + a * d + a * b) / 2.0,
            (b * c + a * c + a * b) / 6.0,
        )
        step = self.grid.item(1) - self.grid.item(0)
        return float(_sum(weights, self.values[first : first + 4])) / step

    def crossing(self, level: float, start: float, direction: int = 1) -> float:
        """Where it first passes `level`, going from `start` in `direction` (+1 or -1).

        Returns ``nan`` when it never does.
        """
        grid, values = self.grid, self.values
        origin = int(grid.searchsorted(start))
        if direction < 0:
            origin = min(origin, grid.size - 1)
        last = self._changes_side(level, origin, direction)
        if last is None:
            return math.nan
        x0, x1 = grid.item(last - direction), grid.item(last)
        y0, y1 = values[last - direction] - level, values[last] - level
        guess = x0 + (x1 - x0) * y0 / (y0 - y1)
        steepness = (y1 - y0) / (x1 - x0)
        # One step on the cubic removes what the chord leaves.
        refined = guess - (self.at(guess) - level) / steepness
        return refined if min(x0, x1) <= refined <= max(x0, x1) else guess

    def _changes_side(self, level: float, origin: int, direction: int) -> int | None:
        """The first grid point from one on that lies on the other side of a level, if any."""
        values = self.values
        for place in range(origin, len(values) if direction > 0 else -1, direction):
            if (values[place] > level) != (values[origin] > level):
                return place
        return None


def crossing(grid: Floats, values: Floats, level: float, start: float, direction: int = 1) -> float:
    """Where a curve first passes `level`; see `PlainCurve.crossing`."""
    return PlainCurve(grid, values.tolist()).crossing(level, start, direction)


def listed(columns: Mapping[str, Floats]) -> dict[str, list[float]]:
    """Columns of a curve, the places first, as lists: places without the errors of their sums."""
    first = next(iter(columns))
    exact = {name: column.tolist() for name, column in columns.items() if name != first}
    return {first: np.round(columns[first], 6).tolist(), **exact}
