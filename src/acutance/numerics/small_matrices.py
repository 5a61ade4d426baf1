"""Factors, inverses and products of matrices of ten to a hundred rows, for compiled loops.

LAPACK takes three times as long for an inverse of a hundred rows; of matrices of ten, most of the
time is that of the call.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["add_product", "factorize", "forward_substitution", "lower_inverse", "lower_square"]


@compiled
def add_product(found: Floats, left: Floats, right: Floats) -> None:
    """Add to a matrix (n, k) the product of two, (n, m) and (m, k), four rows at a time."""
    fours = len(right) - len(right) % 4
    for i in range(len(left)):
        row = found[i]
        for j in range(0, fours, 4):
            a, b, c, d = left[i, j], left[i, j + 1], left[i, j + 2], left[i, j + 3]
            p, q, r, s = right[j], right[j + 1], right[j + 2], right[j + 3]
            for k in range(row.size):
                row[k] += a * p[k] + b * q[k] + c * r[k] + d * s[k]
        for j in range(fours, len(right)):
            for k in range(row.size):
                row[k] += left[i, j] * right[j, k]


@compiled
def factorize(matrix: Floats) -> None:
    """Put the lower triangular factor of a matrix, (n, n), in its place (Cholesky)."""
    for i in range(len(matrix)):
        for j in range(i + 1):
            left = matrix[i, j]
            for k in range(j):
                left -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = np.sqrt(left) if i == j else left / matrix[j, j]
        for j in range(i + 1, len(matrix)):
            matrix[i, j] = 0.0


@compiled
def forward_substitution(lower: Floats, right: Floats) -> None:
    """Put the solution of a triangular system, (n, k), in the place of its right side."""
    for i in range(len(lower)):
        row = right[i]
        for j in range(i):
            for k in range(row.size):
                row[k] -= lower[i, j] * right[j, k]
        for k in range(row.size):
            row[k] /= lower[i, i]


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


@compiled
def lower_square(lower: Floats) -> Floats:
    """The product ``L^T L`` of a lower triangular matrix, (n, n), four of its rows at a time."""
    n = len(lower)
    found, fours = np.zeros((n, n)), n - n % 4
    for k in range(0, fours, 4):
        p, q, r, s = lower[k], lower[k + 1], lower[k + 2], lower[k + 3]
        for i in range(k + 4):
            a, b, c, d, row = p[i], q[i], r[i], s[i], found[i]
            for j in range(i + 1):
                row[j] += a * p[j] + b * q[j] + c * r[j] + d * s[j]
    for k in range(fours, n):
        for i in range(k + 1):
            for j in range(i + 1):
                found[i, j] += lower[k, i] * lower[k, j]
    for i in range(n):
        for j in range(i):
            found[j, i] = found[i, j]
    return found
