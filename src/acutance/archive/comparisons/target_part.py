"""What is peculiar to a target: it comes again in every image, and does not average out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from acutance.archive.comparisons.degrees import StdPart
from acutance.archive.weighted_means import weighted_mean
from acutance.curves.grid import Floats

__all__ = ["target_part"]


def target_part(
    value: Floats, image: NDArray[np.int64], target: Sequence[str | None]
) -> StdPart | None:
    """The deviation of a mean of n numbers by what differs between their targets.

    It is read from how the means of the targets scatter about those of their images, beyond what
    the scatter of single numbers explains.

    Parameters
    ----------
    value : (n,) array
    image : (n,) int array
    target : sequence of n str or None

    Returns
    -------
    StdPart or None
        None where it cannot be told: one target, or no target seen in several images.
    """
    names, which = np.unique([str(one) for one in target], return_inverse=True)
    _, index = np.unique(image, return_inverse=True)
    count = np.bincount(which)
    off = value - (np.bincount(index, value) / np.bincount(index))[index]
    mean = np.bincount(which, off) / count
    free = value.size - names.size - int(index.max())
    if names.size < 2 or free < 1:
        return None
    single = float(((off - mean[which]) ** 2).sum()) / free
    scatter = weighted_mean(mean, np.sqrt(single / count)).scatter.value
    share = count / count.sum()
    return StdPart(float(scatter * np.sqrt((share**2).sum())), names.size - 1)
