"""Normal equations: the pixels of a linear model, summed into one small matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.small_matrices import sparse_product, symmetric_product

__all__ = ["Normal"]


@dataclass(frozen=True, eq=False)
class Normal:
    """Weighted sums over the pixels, of a model that is linear in its m coefficients.

    Where some of them are those of a spline, most of the sums are zero: few splines overlap.

    Attributes
    ----------
    gram : (m, m) array
        Sum of w a a^T, with a the row of the design of a pixel.
    projection : (m,) array
        Sum of w a y.
    data : float
        Sum of w y^2.
    count : float
        Number of pixels.
    """

    gram: Floats
    projection: Floats
    data: float
    count: float

    def misfit(self, beta: Floats) -> float:
        """Weighted sum of squares that coefficients (m,) leave: sum of w (y - a beta)^2."""
        return self.data + float(beta @ (self.gram @ beta - 2 * self.projection))

    def combined(self, directions: Floats) -> Normal:
        """The equations if the first p unknowns are combinations (p, r) of r others."""
        p, r = directions.shape
        rest = self.projection.size - p
        half = sparse_product(self.gram, directions)
        gram = np.empty((r + rest, r + rest))
        gram[:r, :r], gram[:r, r:] = symmetric_product(directions.T, half[:p]), half[p:].T
        gram[r:, :r], gram[r:, r:] = half[p:], self.gram[p:, p:]
        projection = np.concatenate([directions.T @ self.projection[:p], self.projection[p:]])
        return Normal(gram, projection, self.data, self.count)

    def exchanged(self, source: Normal, directions: Floats, new: slice, old: slice) -> Normal:
        """The equations ``source.combined(directions)``, where most directions are as they were.

        Parameters
        ----------
        source : Normal
            Of which these equations are combinations too.
        directions : (p, r) array
        new : slice
            Which of the directions are new.
        old : slice
            Which of the unknowns have gone in their place.
        """
        p, columns = directions.shape[0], np.ascontiguousarray(directions[:, new])
        products = sparse_product(source.gram, columns)
        rows = np.hstack([products[:p].T @ directions, products[p:].T])
        gram = np.empty((rows.shape[1],) * 2)
        before, after = slice(old.start), slice(old.stop, None)
        for one, own in ((before, slice(new.start)), (after, slice(new.stop, None))):
            gram[own, : new.start] = self.gram[one, before]
            gram[own, new.stop :] = self.gram[one, after]
        gram[new], gram[:, new] = rows, rows.T
        projection = np.concatenate([
            self.projection[before], columns.T @ source.projection[:p], self.projection[after]
        ])  # fmt: skip
        return Normal(gram, projection, self.data, self.count)
