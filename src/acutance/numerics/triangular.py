"""Inverses of triangular matrices of some hundred rows: LAPACK's takes three times as long."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["lower_inverse"]


@compiled
def lower_inverse(lower: Floats) -> Floats:
    """The inverse X of a lower triangular matrix L, (n, n): both are zero above the diagonal.

    Row by row ``X_i = (e_i - sum_{k<i} L_ik X_k) / L_ii``, four of the rows X_k at a time.
    """
    n = lower.shape[0]
    inverse = np.zeros((n, n))
    for i in range(n):
        row = inverse[i]
        fours = i - i % 4
        for k in range(0, fours, 4):
            a, b, c, d = lower[i, k], lower[i, k + 1], lower[i, k + 2], lower[i, k + 3]
            p, q, r, s = inverse[k], inverse[k + 1], inverse[k + 2], inverse[k + 3]
            for j in range(k + 4):
                row[j] -= a * p[j] + b * q[j] + c * r[j] + d * s[j]
        for k in range(fours, i):
            for j in range(k + 1):
                row[j] -= lower[i, k] * inverse[k, j]
        for j in range(i):
            row[j] /= lower[i, i]
        row[i] = 1 / lower[i, i]
    return inverse
