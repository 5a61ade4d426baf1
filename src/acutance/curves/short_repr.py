"""How a result that holds arrays prints, on one line, and compares, by what it holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from acutance.curves.estimate import Estimate

__all__ = ["ShortRepr"]

_FEW = 3


class ShortRepr:
    """A dataclass of arrays that prints as one line and compares by its fields.

    A class made from it has this representation instead of that of dataclasses, which writes out
    every array: its name, and its `summary`. Unless a class overrides it, this is its
    fields but those that are None, arrays by their shapes.

    Two of one class are equal when all their fields are, arrays element by element and ``nan``
    equal to ``nan``; so a result equals its pickled copy. Like arrays they have no hash. A copy
    holds the fields alone: what was computed from them is computed again when asked for.

    Examples
    --------
    >>> measure_edge(image).mtf  # doctest: +SKIP
    <Mtf: freq_cpp 0 to 1, 101 places>
    """

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        # A dataclass writes itself none of these where the class itself has them.
        for name in ("__repr__", "__eq__", "__hash__"):
            setattr(cls, name, getattr(cls, name))

    def __eq__(self, other: object) -> bool:
        return _equal(self, other) if type(other) is type(self) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.summary()}>"

    def summary(self) -> str:
        """What it is and its main numbers, in one line; nothing slow is computed for it."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        known = {name: value for name, value in own.items() if value is not None}
        return ", ".join(f"{name} {_in_short(value)}" for name, value in known.items())


def _in_short(value: Any) -> str:
    """Numbers, names and a few of them in full; of all else its kind and size."""
    if isinstance(value, str | int | None):
        return repr(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Estimate):
        return str(value)
    if isinstance(value, np.ndarray):
        return f"array of {' x '.join(map(str, value.shape))}"
    if isinstance(value, tuple | list) and len(value) <= _FEW:
        return f"({', '.join(map(_in_short, value))})"
    if isinstance(value, tuple | list | Mapping):
        return f"({len(value)} of them)"
    return f"<{type(value).__name__}>"


def _equal(one: Any, other: Any) -> bool:
    """Whether two values are equal, arrays and whatever holds them included."""
    if one is other:
        return True
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return False
    if is_dataclass(one) and type(one) is type(other):
        names = [field.name for field in fields(one) if field.compare]
        return all(_equal(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_equal(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_equal, one, other))
    return bool(one == other or (one != one and other != other))
