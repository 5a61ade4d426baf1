"""Which spots lie at places that are stated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.points.detect import RejectedSpot, Spot

__all__ = ["match_spots"]

_STATED_TO_PX: Final = 1.5
_CENTROID_PX: Final = 0.25
"""Error of the centroid of a few pixels."""
_NEARBY_PX: Final = 10.0
"""A spot further away than this is not what a place was meant for."""


def match_spots(
    spots: Sequence[Spot], places: Floats
) -> tuple[tuple[Spot, ...], tuple[RejectedSpot, ...]]:
    """The spots whose centroids are nearest to some places, (n, 2), to 1.5 px.

    Returns
    -------
    matched : tuple of Spot
    missing : tuple of RejectedSpot
        The places that have none.
    """
    centres = np.array([(one.row, one.col) for one in spots], float).reshape(-1, 2)
    matched, missing = [], []
    for row, col in places.tolist():
        away = np.hypot(centres[:, 0] - row, centres[:, 1] - col)
        nearest_px = float(away.min(initial=np.inf))
        if nearest_px > _NEARBY_PX:
            fault = "no light stands out of the noise there"
        elif nearest_px > _STATED_TO_PX + _CENTROID_PX:
            fault = (
                f"the nearest light is {nearest_px:.1f} px away, places are needed to "
                f"{_STATED_TO_PX:g} px"
            )
        elif (nearest := spots[int(away.argmin())]) in matched:
            fault = "the source there was named by an earlier place"
        else:
            matched.append(nearest)
            continue
        missing.append(RejectedSpot(row, col, "no source", fault))
    return tuple(matched), tuple(missing)
