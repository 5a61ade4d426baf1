"""The tag of an image that was restored: which filter was applied, and to which bands."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

__all__ = ["BEFORE_TAG", "OF_RESTORED", "RESTORED_TAG", "restoration_of"]

RESTORED_TAG: Final = "ACUTANCE_RESTORATION"
BEFORE_TAG: Final = "ACUTANCE_RESTORATION_BEFORE"
OF_RESTORED: Final = "the MTF is that of the restored product"
"""How the note of every restored product ends, whoever restored it: archives search for it."""

_BANDS: Final = re.compile(r"; bands ([\d,]+);")


def restoration_of(tags: Mapping[str, str], band: int) -> str | None:
    """What was applied to a band, in a line; None where that is nothing.

    Parameters
    ----------
    tags : mapping of str to str
        Of the file.
    band : int
        From 1.
    """
    applied = [tags[name] for name in (RESTORED_TAG, BEFORE_TAG) if tags.get(name)]
    every = [one.strip() for text in applied for one in text.split("|")]
    own = [one for one in every if _is_of_band(one, band)]
    return " | ".join(own) or None


def _is_of_band(applied: str, band: int) -> bool:
    """Whether a filter was applied to a band; to all where the tag lists none."""
    listed = _BANDS.search(applied)
    return listed is None or str(band) in listed[1].split(",")
