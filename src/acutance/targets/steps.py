"""Measurements in steps, which several regions take together.

A fit runs through more code, and compares its pixels with more sensors, than the cache of a
processor holds. Region after region, every step finds that the others have taken its place there;
step after step, it finds what it needs: an edge takes a sixth less time.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence
from itertools import islice
from typing import Final, TypeVar

__all__ = ["Steps", "finished", "stacks", "together"]

_TOGETHER: Final = 8
"""Regions that take every step together: more share no more."""

_Region = TypeVar("_Region")
_Result = TypeVar("_Result")
Steps = Generator[None, None, _Result]
"""A function that yields after every step, and returns its result."""


def finished(steps: Steps[_Result]) -> _Result:
    """The result of the steps, one after the other."""
    return together([steps])[0]


def together(several: Sequence[Steps[_Result]]) -> list[_Result]:
    """The results of several, each of which takes a step before any takes the next one."""
    found: dict[int, _Result] = {}
    while len(found) < len(several):
        for place, steps in enumerate(several):
            if place not in found:
                try:
                    next(steps)
                except StopIteration as end:
                    found[place] = end.value
    return [found[place] for place in range(len(several))]


def stacks(regions: Iterable[_Region], first: int = _TOGETHER) -> Iterator[list[_Region]]:
    """The regions that are measured together: so many at first, then twice as many, up to eight."""
    waiting, size = iter(regions), first
    while some := list(islice(waiting, size)):
        yield some
        size = min(2 * size, _TOGETHER)
