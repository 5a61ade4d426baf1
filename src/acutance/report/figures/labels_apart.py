"""Numbers next to points, each on the side where nothing else stands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["labels_apart"]


def labels_apart(
    places: Floats, sides: Sequence[tuple[float, float]], others: Floats | None = None
) -> Floats:
    """Where the label of each point is farthest from all points and from the labels before it.

    Parameters
    ----------
    places : (n, 2) array
        In units of the label's size.
    sides : sequence of (float, float)
        Where a label may stand, from its point; of equally good ones the first is taken.
    others : (k, 2) array, optional
        What is drawn besides.

    Returns
    -------
    (n, 2) array
        Middles of the labels.
    """
    taken = [*places, *(() if others is None else others)]
    chosen = []
    for place in places:
        candidates = [place + np.array(side) for side in sides]
        apart = [min(float(np.hypot(*(one - spot))) for one in taken) for spot in candidates]
        chosen.append(candidates[int(np.argmax(np.round(apart, 6)))])
        taken.append(chosen[-1])
    return np.array(chosen)
