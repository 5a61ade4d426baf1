"""Changes over the level: which levels they can be told of."""

from __future__ import annotations

from acutance.archive.trends.normal_mixture import NormalMixture

__all__ = ["is_told_from_zero"]


def is_told_from_zero(level: NormalMixture) -> bool:
    """Whether the 95 % interval of a level leaves out 0, of which nothing has per cent."""
    low, high = level.interval()
    return low > 0 or high < 0
