"""The name in a folder that a misspelt one most resembles."""

from __future__ import annotations

import os
from difflib import get_close_matches
from itertools import islice
from pathlib import Path

__all__ = ["nearest_name"]

_MAX_NAMES = 20_000
"""Names of a folder that are looked at: comparing them takes a second."""
_LIKE = 0.7
"""Share of letters in common, from which on one name may be meant by another."""


def nearest_name(path: str | os.PathLike[str]) -> str | None:
    """The name of a file or folder beside a path that does not exist, which may be meant.

    Parameters
    ----------
    path : path

    Returns
    -------
    str or None
        None if no name resembles it, or there is no such folder.
    """
    wanted = Path(path)
    try:
        with os.scandir(wanted.parent) as found:
            names = [one.name for one in islice(found, _MAX_NAMES)]
    except OSError:
        return None
    # An ending in common makes no two short names alike: "edge.tif" is not meant by "star.tif".
    stem = wanted.stem.casefold()
    alike = [
        name for name in sorted(names)
        if get_close_matches(stem, [Path(name).stem.casefold()], n=1, cutoff=_LIKE)
    ]  # fmt: skip
    by_folded = {name.casefold(): name for name in alike}
    close = get_close_matches(wanted.name.casefold(), by_folded, n=1, cutoff=_LIKE)
    return by_folded[close[0]] if close else None
