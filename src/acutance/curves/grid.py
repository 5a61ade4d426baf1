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
    "Cubic",
    "Floats",
    "Places",
    "Rows",
    "as_places",
    "crossing",
    "listed",
    "require_curve",
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

    def blend(self, first: int, weights: tuple[float, float, float, float], /) -> Floats:
        """Weighted sum of four rows, from the first one on, (k,)."""

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


_MIN_PLACES = 4
"""Of a curve that is read between its places: a cubic goes through four."""
_UNEVEN = 1e-3
"""Documents round places; steps that differ by a greater share are no regular grid."""


def require_curve(
    name: str, places: Any, values: Any, factor: Any, latent: Any, *, kind: str
) -> None:
    """Refuse what is no curve: arrays of other shapes, or places that are no regular grid.

    Parameters
    ----------
    name : str
        What the places are called.
    places, values : (n,) array
    factor : (n, k) array or Rows
    latent : (k, m) array or None
    kind : str
        What the curve is called: "a curve", "an MTF".

    Raises
    ------
    OptionError
        Says what was given, and what a curve needs.
    """
    parts = (places, values, factor) if latent is None else (places, values, factor, latent)
    shapes = [getattr(part, "shape", None) for part in parts]
    n, own, rows = shapes[:3]
    if n is None or len(n) != 1 or own != n or rows is None or len(rows) != 2 or rows[:1] != n:
        found = [type(p).__name__ if s is None else s for p, s in zip(parts, shapes, strict=True)]
        raise OptionError(
            f"{kind} needs arrays: (n,) {name}, (n,) values and an (n, k) factor, found shapes "
            f"{found[0]}, {found[1]} and {found[2]}"
        )
    if latent is not None and (shapes[3] is None or len(shapes[3]) != 2 or shapes[3][0] != rows[1]):
        raise OptionError(
            f"{kind} with a factor of shape {rows} needs ({rows[1]}, m) latent variables, found "
            f"{type(latent).__name__ if shapes[3] is None else shapes[3]}"
        )
    steps = places[1:] - places[:-1]
    if steps.size and not 0 < steps.max() <= (1 + _UNEVEN) * steps.min() < np.inf:
        raise OptionError(
            f"{name} {places[0]:g}, {places[1]:g} ... {places[-1]:g}: {kind} needs a regular grid "
            "of increasing, finite numbers; interpolate it onto one"
        )


def _require_readable(grid: Floats) -> None:
    if grid.size < _MIN_PLACES:
        raise OptionError(
            f"a curve of {grid.size} places cannot be read between them: give {_MIN_PLACES} or more"
        )


def _outside(grid: Floats, at: float) -> OptionError:
    return OptionError(
        f"{at:g} lies outside the curve, which runs from {grid[0]:g} to {grid[-1]:g}"
    )


class Cubic(NamedTuple):
    """Lagrange's cubic through the four points of a regular grid around a place.

    Attributes
    ----------
    first : int
        The first of the four points.
    t : float
        The place among them, 0 to 3.
    step : float
        Of the grid.
    """

    first: int
    t: float
    step: float

    @classmethod
    def at(cls, grid: Floats, place: float) -> Cubic:
        """The cubic at one place of a regular grid (n,).

        Raises
        ------
        OptionError
            If the place lies outside the grid, or that has fewer than four places.
        """
        _require_readable(grid)
        start, size = grid.item(0), grid.size
        step = grid.item(1) - start
        position = (place - start) / step
        if not -1e-9 <= position <= size - 1 + 1e-9:
            raise _outside(grid, place)
        first = min(max(math.floor(position) - 1, 0), size - 4)
        return cls(first, position - first, step)

    def sample(self, values: NDArray[Any] | Rows) -> Any:
        """Value there of a curve (n,), or of every column of (n, k)."""
        weights = _cubic_weights(self.t)
        if not isinstance(values, np.ndarray):
            return values.blend(self.first, weights)
        near = values[self.first : self.first + 4]
        return np.array(weights) @ near if near.ndim == 2 else _sum(weights, near)

    def slope(self, values: Floats) -> float:
        """Derivative there of a curve (n,)."""
        a, b, c, d = self.t, self.t - 1.0, self.t - 2.0, self.t - 3.0
        weights = (
            -(c * d + b * d + b * c) / 6.0,
            (c * d + a * d + a * c) / 2.0,
            -(b * d + a * d + a * b) / 2.0,
            (b * c + a * c + a * b) / 6.0,
        )
        return float(_sum(weights, values[self.first : self.first + 4])) / self.step


def _cells(grid: Floats, at: Floats) -> tuple[NDArray[np.intp], Floats]:
    """As `Cubic.at`, at every place of an array: indices (..., 4) and places among them (...)."""
    _require_readable(grid)
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
    return Cubic.at(grid, at).sample(values)


def _sum(weights: tuple[float, float, float, float], values: Any) -> Any:
    """Weighted sum of four numbers: plain ones are faster than arrays of them."""
    (a, b, c, d), (p, q, r, s) = weights, values.tolist()
    return a * p + b * q + c * r + d * s


def crossing(grid: Floats, values: Floats, level: float, start: float, direction: int = 1) -> float:
    """Where the curve first passes `level`, going from `start` in `direction` (+1 or -1).

    Returns ``nan`` when it never does.
    """
    origin = int(grid.searchsorted(start))
    if direction < 0:
        origin = min(origin, grid.size - 1)
    # Crossings are near: plain numbers one by one are faster than arrays of all of them.
    numbers: list[float] = values[origin::direction].tolist()
    change = next((k for k, one in enumerate(numbers) if (one > level) != (numbers[0] > level)), 0)
    if change == 0:
        return math.nan
    last = origin + direction * change
    x0, x1 = grid.item(last - direction), grid.item(last)
    y0, y1 = numbers[change - 1] - level, numbers[change] - level
    guess = x0 + (x1 - x0) * y0 / (y0 - y1)
    steepness = (y1 - y0) / (x1 - x0)
    # One step on the cubic removes what the chord leaves.
    residual = float(Cubic.at(grid, guess).sample(values)) - level
    refined = guess - residual / steepness
    return refined if min(x0, x1) <= refined <= max(x0, x1) else guess


def listed(columns: Mapping[str, Floats]) -> dict[str, list[float]]:
    """Columns of a curve, the places first, as lists: places without the errors of their sums."""
    first = next(iter(columns))
    exact = {name: column.tolist() for name, column in columns.items() if name != first}
    return {first: np.round(columns[first], 6).tolist(), **exact}
