"""Measurements in steps, which several regions take together.

A fit runs through more code, and compares its pixels with more sensors, than the cache of a
processor holds. Region after region, every step finds that the others have taken its place there;
step after step, it finds what it needs: an edge takes a sixth less time.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Final, TypeVar

__all__ = ["TOGETHER", "Steps", "finished", "together"]

TOGETHER: Final = 8
"""Regions that take every step together: more share no more."""

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
