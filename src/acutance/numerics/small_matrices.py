"""Factors, inverses and products of matrices of ten to a hundred rows, for compiled loops.

LAPACK takes three times as long for an inverse of a hundred rows; of matrices of ten, most of the
time is that of the call.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined

__all__ = [
    "add_four_rows",
    "add_product",
    "add_products_of_rows",
    "factorize",
    "forward_substitution",
    "lower_inverse",
    "lower_square",
    "orthonormal_rows",
    "products_of_rows",
    "sparse_product",
    "symmetric_product",
]

_SOME: Final = 512
"""Columns of long rows that are taken at a time: they stay in the processor's cache."""


@compiled
def add_product(found: Floats, left: Floats, right: Floats) -> None:
    """Add to a matrix (n, k) the product of two, (n, m) and (m, k), four rows of each at a time."""
    n, m, count = len(left), len(right), right.shape[1]
    rows, fours = n - n % 4, m - m % 4
    for i in range(0, rows, 4):
        add_four_rows(found[i : i + 4], left[i : i + 4, :fours], right, 0, count)
    for i in range(n):
        for j in range(fours if i < rows else 0, m):
            for k in range(count):
                found[i, k] += left[i, j] * right[j, k]


@compiled
def sparse_product(left: Floats, right: Floats) -> Floats:
    """The product of the first m columns of a matrix, (n, m or more), with another one, (m, k).

    Squares of 4 x 4 zeros are left out.
    """
    n, m, count = len(left), len(right), right.shape[1]
    found, rows, fours = np.zeros((n, count)), n - n % 4, m - m % 4
    for i in range(0, rows, 4):
        for j in range(0, fours, 4):
            if _holds_any(left, i, j):
                add_four_rows(found[i : i + 4], left[i : i + 4, j : j + 4], right[j:], 0, count)
    for i in range(n):
        for j in range(fours if i < rows else 0, m):
            for k in range(count):
                found[i, k] += left[i, j] * right[j, k]
    return found


@inlined
def _until(i: int, n: int) -> int:
    """Where a loop over four rows ends behind their diagonal: eight columns are taken at once."""
    return min(i + 8 - i % 8, n)


@inlined
def _holds_any(matrix: Floats, i: int, j: int) -> bool:
    """Whether the square of 4 x 4 numbers from a row and a column on has one that is not zero."""
    for row in range(i, i + 4):
        for column in range(j, j + 4):
            if matrix[row, column] != 0:
                return True
    return False


@compiled
def symmetric_product(left: Floats, right: Floats) -> Floats:
    """The product of two matrices, (n, m) and (m, n), that is known to be symmetric."""
    n, m = left.shape
    found, rows, fours = np.zeros((n, n)), n - n % 4, m - m % 4
    for i in range(0, rows, 4):
        add_four_rows(found[i : i + 4], left[i : i + 4, :fours], right, 0, _until(i, n))
    for i in range(n):
        for j in range(fours if i < rows else 0, m):
            for k in range(i + 1):
                found[i, k] += left[i, j] * right[j, k]
    for i in range(n):
        for j in range(i):
            found[j, i] = found[i, j]
    return found


@inlined
def add_four_rows(
    found: NDArray[Any], factors: NDArray[Any], rows: NDArray[Any], start: int, count: int
) -> None:
    """Add factors (4, m) times so many columns of rows (m, n), from one on, to the first of found.

    Sixteen factors stay in registers while the columns pass. m is a multiple of four.
    """
    w, x, y, z = found[0], found[1], found[2], found[3]
    for i in range(0, factors.shape[1], 4):
        a, b, c, d = factors[:, i], factors[:, i + 1], factors[:, i + 2], factors[:, i + 3]
        a0, a1, a2, a3 = a[0], a[1], a[2], a[3]
        b0, b1, b2, b3 = b[0], b[1], b[2], b[3]
        c0, c1, c2, c3 = c[0], c[1], c[2], c[3]
        d0, d1, d2, d3 = d[0], d[1], d[2], d[3]
        p, q, r, s = rows[i, start:], rows[i + 1, start:], rows[i + 2, start:], rows[i + 3, start:]
        for k in range(count):
            w[k] += a0 * p[k] + b0 * q[k] + c0 * r[k] + d0 * s[k]
            x[k] += a1 * p[k] + b1 * q[k] + c1 * r[k] + d1 * s[k]
            y[k] += a2 * p[k] + b2 * q[k] + c2 * r[k] + d2 * s[k]
            z[k] += a3 * p[k] + b3 * q[k] + c3 * r[k] + d3 * s[k]


@compiled
def products_of_rows(rows: Floats) -> Floats:
    """``rows @ rows.T`` of long rows, (n, m), n a multiple of four: BLAS takes thrice as long."""
    n, m = rows.shape
    found = np.zeros((n, n))
    for start in range(0, m, _SOME):
        add_products_of_rows(found, rows, rows, start, min(_SOME, m - start))
    for i in range(n):
        for j in range(i):
            found[j, i] = found[i, j]
    return found


@inlined
def add_products_of_rows(
    found: Floats,
    left: NDArray[np.floating[Any]],
    right: NDArray[np.floating[Any]],
    start: int,
    count: int,
) -> None:
    """Add the products of rows, (n, m) each, to a matrix (n, n), below its diagonal alone.

    Of so many columns, from one on. n is a multiple of four: the products of four rows with two
    others stay in registers while the columns pass, in the precision of the rows.
    """
    none = left.dtype.type(0)
    for i in range(0, len(left), 4):
        w, x, y, z = left[i, start:], left[i + 1, start:], left[i + 2, start:], left[i + 3, start:]
        for j in range(0, i + 4, 2):
            a, b = right[j, start:], right[j + 1, start:]
            wa, wb, xa, xb, ya, yb, za, zb = none, none, none, none, none, none, none, none
            for k in range(count):
                wa += w[k] * a[k]
                wb += w[k] * b[k]
                xa += x[k] * a[k]
                xb += x[k] * b[k]
                ya += y[k] * a[k]
                yb += y[k] * b[k]
                za += z[k] * a[k]
                zb += z[k] * b[k]
            found[i, j] += wa
            found[i, j + 1] += wb
            found[i + 1, j] += xa
            found[i + 1, j + 1] += xb
            found[i + 2, j] += ya
            found[i + 2, j + 1] += yb
            found[i + 3, j] += za
            found[i + 3, j + 1] += zb


@compiled
def factorize(matrix: Floats) -> None:
    """Put the lower triangular factor of a symmetric matrix, (n, n), in its place (Cholesky).

    The rows of its transpose are worked out above the diagonal, where they are contiguous.
    """
    n = len(matrix)
    for i in range(n):
        own = matrix[i]
        scale = 1 / np.sqrt(own[i])
        for k in range(i, n):
            own[k] *= scale
        for j in range(i + 1, n):
            factor, row = own[j], matrix[j]
            for k in range(j, n):
                row[k] -= factor * own[k]
    for i in range(n):
        for j in range(i):
            matrix[i, j], matrix[j, i] = matrix[j, i], 0.0


@compiled
def forward_substitution(lower: Floats, right: Floats) -> None:
    """Put the solution of a triangular system, (n, k), in the place of its right side.

    Four rows at a time are freed of those before them, then of one another.
    """
    n, count = len(lower), right.shape[1]
    minus, fours = -lower, n - n % 4
    for i in range(n):
        row, first = right[i], i - i % 4
        if i < fours and i == first:
            add_four_rows(right[i : i + 4], minus[i : i + 4, :i], right, 0, count)
        for j in range(first if i < fours else 0, i):
            for k in range(count):
                row[k] += minus[i, j] * right[j, k]
        scale = 1 / lower[i, i]
        for k in range(count):
            row[k] *= scale


@compiled
def orthonormal_rows(rows: Floats) -> Floats:
    """Independent rows (k, n), each freed of those before it and made one long."""
    found, lower = rows.copy(), symmetric_product(rows, rows.T.copy())
    factorize(lower)
    forward_substitution(lower, found)
    return found


@compiled
def lower_inverse(lower: Floats) -> Floats:
    """The inverse X of a lower triangular matrix L, (n, n): both are zero above the diagonal.

    Row by row ``X_i = (e_i - sum_{k<i} L_ik X_k) / L_ii``: the sums over those before four rows are
    worked out at a time, then those over one another.
    """
    n = len(lower)
    inverse, fours = np.zeros((n, n)), n - n % 4
    for i in range(n):
        row, first = inverse[i], i - i % 4
        if i < fours and i == first:
            for k in range(0, i, 4):
                factors = lower[i : i + 4, k : k + 4]
                add_four_rows(inverse[i : i + 4], factors, inverse[k:], 0, _until(k, n))
        for k in range(first if i < fours else 0, i):
            for j in range(k + 1):
                row[j] += lower[i, k] * inverse[k, j]
        scale = 1 / lower[i, i]
        for j in range(i):
            row[j] *= -scale
        row[i] = scale
    return inverse


@compiled
def lower_square(lower: Floats) -> Floats:
    """The product ``L^T L`` of a lower triangular matrix, (n, n), four of its rows at a time."""
    n = len(lower)
    found, fours = np.zeros((n, n)), n - n % 4
    for i in range(0, fours, 4):
        factors = lower.T[i : i + 4, i:fours]
        add_four_rows(found[i : i + 4], factors, lower[i:], 0, _until(i, n))
    for k in range(fours, n):
        for i in range(k + 1):
            for j in range(i + 1):
                found[i, j] += lower[k, i] * lower[k, j]
    for i in range(n):
        for j in range(i):
            found[j, i] = found[i, j]
    return found
