"""The base of every OTF block: a transfer over two frequencies, and parameters within range."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ModelError

__all__ = [
    "Axis",
    "Block",
    "Transfer",
    "along_axis",
    "has_otf",
    "require",
    "require_axis",
    "require_count",
    "require_range",
]

Transfer = NDArray[Any]
"""Values of an OTF: real where the blur is symmetric, complex where it is not."""

Axis = Literal["across", "along"]
"""The direction a blur acts in: "across" is the column axis x, "along" the row axis y."""


class Block(Protocol):
    """One cause of blur. Blocks are frozen dataclasses, so they compare, hash and print."""

    def otf(self, u: Floats, v: Floats) -> Transfer:
        """OTF at `u` (across, column axis x) and `v` (along, row axis y), cycles per pixel.

        `u` and `v` broadcast against each other; the result has their common shape and is 1
        at zero frequency. Sign of the phase: the Fourier transform of the point spread
        function with the kernel ``exp(-2 pi i (u x + v y))``.
        """
        ...


def along_axis(u: Floats, v: Floats, axis: Axis) -> Floats:
    """The frequency component a one-dimensional blur acts on, in the common shape."""
    chosen = u if axis == "across" else v
    return np.broadcast_to(np.asarray(chosen, float), np.broadcast_shapes(np.shape(u), np.shape(v)))


def has_otf(block: object) -> bool:
    """Whether an object is a block, or a sensor; the class of one has no OTF of its own."""
    return not isinstance(block, type) and callable(getattr(block, "otf", None))


def require_axis(block: object, axis: str) -> None:
    """Refuse an axis that is neither "across" nor "along".

    Raises
    ------
    ModelError
        Names the block and what was given.
    """
    if not isinstance(axis, str) or axis not in ("across", "along"):
        raise ModelError(
            f'{type(block).__name__}: axis is {axis!r}, it has to be "across" or "along"'
        )


def require(
    block: object, low: float = 0.0, high: float = math.inf, *, above: bool = False, **values: float
) -> None:
    """Refuse what is no number, or outside ``low..high`` (`above`: `low` itself is refused too).

    Raises
    ------
    ModelError
        Names the block, the parameter, the value and the range.
    """
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Real):
            raise ModelError(f"{type(block).__name__}: {name} is {value!r}, it has to be a number")
        inside = (value > low if above else value >= low) and value <= high
        if not (inside and math.isfinite(value)):
            lower = "" if math.isinf(low) else f", {'above' if above else 'at least'} {low:g}"
            upper = "" if math.isinf(high) else f" and at most {high:g}"
            raise ModelError(
                f"{type(block).__name__}: {name} is {value:g}, it has to be finite{lower}{upper}"
            )


def require_range(block: object, *, above: bool = False, **ranges: Any) -> None:
    """Refuse what is no range of numbers from 0 on (`above`: 0 itself is refused too).

    Raises
    ------
    ModelError
        Names the block, the parameter, and what it has to be.
    """
    for name, values in ranges.items():
        try:
            low, high = values
        except (TypeError, ValueError):
            raise ModelError(
                f"{type(block).__name__}: {name} is {values!r:.80}, it has to be two numbers, the "
                "lowest and the highest"
            ) from None
        require(block, above=above, **{f"lowest {name}": low, f"highest {name}": high})
        if low > high:
            raise ModelError(
                f"{type(block).__name__}: {name} is {low:g} to {high:g}, the lowest cannot be "
                "above the highest"
            )


def require_count(block: object, most: int, **values: int) -> None:
    """Refuse a count that is not a whole number from 1 to `most`.

    Raises
    ------
    ModelError
        Names the block, the parameter, the value and the range.
    """
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Integral) or not 1 <= value <= most:
            raise ModelError(
                f"{type(block).__name__}: {name} is {value!r}, it has to be a whole number from "
                f"1 to {most}"
            )
