"""Why a target was not measured, in a word or two."""

from __future__ import annotations

from acutance.errors import AcutanceError

__all__ = ["UNREADABLE", "in_words", "words_of"]

UNREADABLE = "unreadable image"
_FAILED = "measurement failed"
_WORDS = {
    "ImageError": UNREADABLE,
    "RegionError": "outside or too small",
    "NoDataError": "no data",
    "TargetError": "no target found",
    "NoEdgeError": "no edge found",
    "FewEdgesError": "few edges",
    "NoBarsError": "no bars found",
    "NoStarError": "no star found",
    "PhaseError": "aligned with the pixel grid",
    "SupportError": "too few rows or plateau",
    "OptionError": "option not usable",
    "ModelError": "target described in contradiction",
}
"""By the names of errors: rows of older archives have these."""


def words_of(error: Exception) -> str:
    """The words of an error: those of its class, or of the nearest class above that has some."""
    if not isinstance(error, AcutanceError):
        return _FAILED
    names = (one.__name__ for one in type(error).__mro__)
    return next((_WORDS[name] for name in names if name in _WORDS), _FAILED)


def in_words(why: str) -> str:
    """A reason that was kept, in words."""
    return _WORDS.get(why, why)
