"""Unknowns of a linear model that are integrated out: the others keep what the data say of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.small_matrices import lower_inverse

__all__ = ["IntegratedOut", "integrated_out"]


@dataclass(frozen=True, eq=False)
class IntegratedOut:
    """What is known of the unknowns that are kept, and how the others follow them.

    Attributes
    ----------
    kept, others : slice
        Where they stand among all unknowns.
    information : (n, n) array
        Inverse covariance of the n that are kept.
    projection : (n,) array
        The same times their values.
    start : (k,) array
        Values of the others where those kept are zero.
    follow : (k, n) array
        By how much the others fall when those kept rise.
    covariance : (k, k) array
        Of the others, where those kept are known.
    """

    kept: slice
    others: slice
    information: Floats
    projection: Floats
    start: Floats
    follow: Floats
    covariance: Floats

    def all_unknowns(self, mean: Floats, covariance: Floats) -> tuple[Floats, Floats]:
        """Mean and covariance of all unknowns, from those of the ones that were kept."""
        size = mean.size + self.start.size
        every, whole = np.empty(size), np.empty((size, size))
        every[self.kept], every[self.others] = mean, self.start - self.follow @ mean
        crossed = self.follow @ -covariance
        whole[self.kept, self.kept] = covariance
        whole[self.others, self.kept], whole[self.kept, self.others] = crossed, crossed.T
        whole[self.others, self.others] = self.covariance - crossed @ self.follow.T
        return every, whole


def integrated_out(
    information: Floats, projection: Floats, std: Floats, kept: slice, others: slice
) -> IntegratedOut:
    """Integrate out some unknowns that have independent priors.

    Parameters
    ----------
    information : (m, m) array
        Inverse covariance of all unknowns by the data.
    projection : (m,) array
        The same times their values; of the others with the prior's part, mean over variance.
    std : (k,) array
        Standard deviations of the prior of the others.
    kept, others : slice
    """
    precision = information[others, others].copy()
    precision.reshape(-1)[:: std.size + 1] += std**-2.0
    root = lower_inverse(np.asarray(np.linalg.cholesky(precision), float))
    between, start = root @ information[others, kept], root @ projection[others]
    return IntegratedOut(
        kept, others,
        information[kept, kept] - between.T @ between, projection[kept] - between.T @ start,
        root.T @ start, root.T @ between, root.T @ root,
    )  # fmt: skip
