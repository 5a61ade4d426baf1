"""What measurements are called by which tables group them."""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.archive.columns import Columns

__all__ = ["NO_WORD", "group_words"]

NO_WORD: Final = "–"
"""Of what is not known."""


def group_words(rows: Columns, name: str) -> list[str]:
    """The word of every row for a group: of its date the day, of an image a name of its own.

    Parameters
    ----------
    rows : Columns
        Of measurements.
    name : str
        Of a column, or "date".
    """
    if name == "date":
        days = rows["acquired"].astype("datetime64[D]")
        return [NO_WORD if np.isnat(day) else str(day) for day in days]
    words = [NO_WORD if one is None else str(one) for one in rows[name].tolist()]
    return words if name != "image" else _apart(words, rows["image_id"].tolist())


def _apart(names: list[str], numbers: list[int]) -> list[str]:
    """Names of files, with the number of the image where several have the same."""
    images: dict[str, set[int]] = {}
    for name, number in zip(names, numbers, strict=True):
        images.setdefault(name, set()).add(number)
    return [
        f"{name} (image_id {number})" if len(images[name]) > 1 else name
        for name, number in zip(names, numbers, strict=True)
    ]
