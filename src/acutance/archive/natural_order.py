"""Names with numbers in the order that readers expect: B2, B8A, B11."""

from __future__ import annotations

import re

__all__ = ["natural_key"]

_DIGITS = re.compile(r"(\d+)")


def natural_key(name: object) -> tuple[tuple[int, str], ...]:
    """A key of sorting: numbers in a name by their value.

    Parameters
    ----------
    name : object
        Its text counts.
    """
    parts = _DIGITS.split(str(name))
    return tuple((int(one), "") if one.isdigit() else (-1, one) for one in parts if one)
