"""The name in a folder that a misspelt one most resembles."""

from __future__ import annotations

import os
from difflib import get_close_matches
from functools import partial
from heapq import nlargest
from itertools import islice
from pathlib import Path

__all__ = ["nearest_name"]

_MAX_NAMES = 20_000
"""Names of a folder that are looked at, in a fifth of a second."""
_COMPARED = 200
"""Those that are compared letter by letter, .2 ms each: a batch may lack hundreds of images."""
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
    stem = wanted.stem.casefold()
    likely = nlargest(_COMPARED, sorted(names), key=partial(_letters_at_both_ends, stem))
    # An ending in common makes no two short names alike: "edge.tif" is not meant by "star.tif".
    alike = [
        name for name in likely
        if get_close_matches(stem, [Path(name).stem.casefold()], n=1, cutoff=_LIKE)
    ]  # fmt: skip
    by_folded = {name.casefold(): name for name in alike}
    close = get_close_matches(wanted.name.casefold(), by_folded, n=1, cutoff=_LIKE)
    return by_folded[close[0]] if close else None


def _letters_at_both_ends(stem: str, name: str) -> int:
    """How many letters a name begins and ends with as a stem does: all but those about one slip."""
    other = Path(name).stem.casefold()
    return _letters_in_common(stem, other) + _letters_in_common(stem[::-1], other[::-1])


def _letters_in_common(one: str, other: str) -> int:
    """How many letters two words begin with alike."""
    unlike = (at for at, (a, b) in enumerate(zip(one, other, strict=False)) if a != b)
    return next(unlike, min(len(one), len(other)))
