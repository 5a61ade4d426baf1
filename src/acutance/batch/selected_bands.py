"""The bands of an image, and which of them a target is measured in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

__all__ = ["Band", "selected", "without_band"]


class Band(NamedTuple):
    """A band of an image.

    Attributes
    ----------
    number : int
        From 1.
    name : str or None
        As the image or the plan states it.
    """

    number: int
    name: str | None


def selected(
    band: Band, of_plan: Sequence[str | int] | None, of_target: Sequence[str | int] | None
) -> bool:
    """Whether both the plan and the target want a band; None wants all."""
    return _wanted(band, of_plan) and _wanted(band, of_target)


def _wanted(band: Band, wanted: Sequence[str | int] | None) -> bool:
    if wanted is None:
        return True
    name = None if band.name is None else band.name.lower()
    return any(
        one == band.number if isinstance(one, int) else one.lower() in (name, str(band.number))
        for one in wanted
    )


def without_band(wanted: Iterable[str | int], bands: Iterable[Band]) -> tuple[str | int, ...]:
    """Names and numbers that none of the bands has, each once."""
    there = list(bands)
    return tuple(
        one for one in dict.fromkeys(wanted) if not any(_wanted(band, (one,)) for band in there)
    )
