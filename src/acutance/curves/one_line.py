"""How a result that holds arrays prints: on one line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from acutance.curves.estimate import Estimate

__all__ = ["OneLine"]

_FEW = 3


class OneLine:
    """A dataclass that prints as one line: its name, and what `in_words` says of it.

    A class made from it has this representation instead of that of dataclasses, which writes out
    every array. Unless it finds better words, it tells its fields, arrays by their shapes.

    Examples
    --------
    >>> measure_edge(image).mtf  # doctest: +SKIP
    <Mtf: freq_cpp 0 to 1, 101 places>
    """

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        # A dataclass writes itself no representation where the class body has one.
        cls.__repr__ = OneLine.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.in_words()}>"

    def in_words(self) -> str:
        """What it is and its main numbers, in one line; nothing slow is computed for it."""
        names = (field.name for field in fields(self))  # type: ignore[arg-type]
        return ", ".join(f"{name} {_in_short(getattr(self, name))}" for name in names)


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
