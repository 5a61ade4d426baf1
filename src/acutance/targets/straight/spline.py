"""Line spread functions (LSF) as sums of uniform quadratic B-splines.

Distances are in units of the width of the first fit (``u = s / width_px``), so one basis is enough
for every sensor. With cells of length h on [-U, U], an LSF is ``sum_j c_j B2_j(u)`` and its
integral, the edge spread function (ESF), is a cubic B-spline whose coefficients e are the running
sum of c:

    e_m = h * sum_{j <= m - 3} c_j,      ESF(u) = sum_m e_m B3_m(u)

so that every pixel depends on four coefficients only, and the ESF is exactly 0 and constant outside
the support. The Fourier transform of the LSF, the optical transfer function (OTF), is closed form:

    OTF(f) = h sinc(f h)^3 sum_j c_j exp(-2 pi i f u_j)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = [
    "CELL",
    "CELLS",
    "CENTRES",
    "HALF_SUPPORT",
    "SIZE",
    "SplineRows",
    "combine",
    "cubic_weights",
    "edge_and_line_weights",
    "edge_weights",
    "esf_from_lsf",
    "expand",
    "quasi_interpolant",
    "transform",
    "waves",
]

HALF_SUPPORT: Final = 10.0
"""U: the spline's LSF is zero beyond ten widths, where only the tail remains. Within eight, a halo
of 5 px with 14 % of the light has a twelfth of it outside, and an edge's MTF(.05) was .02 high."""
CELLS: Final = 100
CELL: Final = 2 * HALF_SUPPORT / CELLS
SIZE: Final = CELLS - 2
"""Number of LSF coefficients; the ESF has CELLS + 3."""
CENTRES: Final[Floats] = np.asarray(-HALF_SUPPORT + CELL * (np.arange(SIZE) + 1.5))
"""Where the quadratic B-splines are centred, (SIZE,)."""
_FIRST_CENTRE, _LAST_CENTRE = CENTRES.item(0), CENTRES.item(-1)
_FOUR: Final = np.arange(4)[:, None]


@compiled
def _place(u: float) -> tuple[int, float]:
    """Cell number and place within the cell (0..1) of a distance, clipped to the support."""
    position = min(max((u + HALF_SUPPORT) * (1 / CELL), 0.0), float(CELLS))
    cell = min(int(position), CELLS - 1)
    return cell, position - cell


@compiled
def cubic_weights(position: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The four cubic B-splines that are not 0 at places of any range of unit cells from 0.

    As `edge_weights`: cell (n,) and weights (4, n).
    """
    cell, weights = np.empty(position.size, np.intp), np.empty((4, position.size))
    for i in range(position.size):
        cell[i] = int(position[i])
        weights[0, i], weights[1, i], weights[2, i], weights[3, i] = _cubics(position[i] - cell[i])
    return cell, weights


@compiled
def _cubics(t: float) -> tuple[float, float, float, float]:
    """The four cubic B-splines at a place of a cell."""
    rest, square = 1.0 - t, t * t
    first, last = rest * rest * rest / 6, square * t / 6
    second = square * (0.5 * t - 1.0) + 2 / 3
    return first, second, 1.0 - first - second - last, last


@compiled
def edge_weights(u: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The four cubic B-splines that are not 0 at each distance.

    Parameters
    ----------
    u : (n,) array
        Distances in widths.

    Returns
    -------
    cell : (n,) int array
        The first of the four ESF coefficients (0 .. CELLS - 1).
    weights : (4, n) array
        ESF(u) = sum_a weights[a] * e[cell + a].
    """
    cell, weights = np.empty(u.size, np.intp), np.empty((4, u.size))
    for i in range(u.size):
        cell[i], t = _place(u[i])
        weights[0, i], weights[1, i], weights[2, i], weights[3, i] = _cubics(t)
    return cell, weights


@compiled
def edge_and_line_weights(u: Floats) -> tuple[NDArray[np.intp], Floats, Floats]:
    """`edge_weights` and their derivative: LSF(u) = sum_a slopes[a] * e[cell + a]."""
    cell, weights, slopes = np.empty(u.size, np.intp), np.empty((4, u.size)), np.empty((4, u.size))
    for i in range(u.size):
        cell[i], t = _place(u[i])
        weights[0, i], weights[1, i], weights[2, i], weights[3, i] = _cubics(t)
        rest = 1.0 - t
        first, second, last = -0.5 * rest * rest, t * (1.5 * t - 2.0), 0.5 * t * t
        slopes[0, i], slopes[1, i] = first / CELL, second / CELL
        slopes[2, i], slopes[3, i] = -(first + second + last) / CELL, last / CELL
    return cell, weights, slopes


def expand(cell: NDArray[np.intp], weights: Floats, further: int = 0) -> Floats:
    """The (n, CELLS + 3 + further) matrix that holds the local `weights` (4, n), else zero."""
    columns = CELLS + 3 + further
    matrix = np.zeros((cell.size, columns))
    first = np.arange(0, matrix.size, columns) + cell
    matrix.reshape(-1)[first + _FOUR] = weights
    return matrix


@dataclass(frozen=True, eq=False)
class SplineRows:
    """``expand(cell, weights, further)`` with `dense` added to its last columns, row by row.

    Attributes
    ----------
    cell, weights : (n,) int and (4, n) arrays
        As `edge_weights` or `line_weights` gives them.
    dense : (n, q) array
    further : int
        How many columns come after those of the spline.
    """

    cell: NDArray[np.intp]
    weights: Floats
    dense: Floats
    further: int

    # numpy then leaves products with its own arrays to the methods below.
    __array_ufunc__: ClassVar[None] = None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the whole matrix."""
        return self.cell.size, CELLS + 3 + self.further

    def __getitem__(self, rows: slice) -> SplineRows:
        return SplineRows(self.cell[rows], self.weights[:, rows], self.dense[rows], self.further)

    def __matmul__(self, matrix: Floats) -> Floats:
        return _times(self.cell, self.weights, self.dense, matrix)

    def blend(self, first: int, weights: tuple[float, float, float, float]) -> Floats:
        """Weighted sum of four rows, from the first one on, (columns,)."""
        return _blend(first, weights, self.cell, self.weights, self.dense, self.shape[1])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        matrix = expand(self.cell, self.weights, self.further)
        matrix[:, -self.dense.shape[1] :] += self.dense
        return np.asarray(matrix, dtype)

    def with_column(self, column: Floats) -> SplineRows:
        """The matrix with one more column, (n,), at its end."""
        dense = np.column_stack([self.dense, column])
        return SplineRows(self.cell, self.weights, dense, self.further + 1)


@compiled
def _times(cell: NDArray[np.intp], weights: Floats, dense: Floats, matrix: Floats) -> Floats:
    """``SplineRows @ matrix`` of a matrix (k, m), (n, m)."""
    n, q = dense.shape
    k, m = matrix.shape
    found = np.empty((n, m))
    for i in range(n):
        p, r, s, t = weights[0, i], weights[1, i], weights[2, i], weights[3, i]
        first = cell[i]
        for j in range(m):
            found[i, j] = (
                p * matrix[first, j] + r * matrix[first + 1, j]
                + s * matrix[first + 2, j] + t * matrix[first + 3, j]
            )  # fmt: skip
        for a in range(q):
            for j in range(m):
                found[i, j] += dense[i, a] * matrix[k - q + a, j]
    return found


@compiled
def _blend(
    first: int,
    factors: tuple[float, float, float, float],
    cell: NDArray[np.intp],
    weights: Floats,
    dense: Floats,
    columns: int,
) -> Floats:
    """Weighted sum of four rows of ``SplineRows``, from the first one on, (columns,)."""
    found, q = np.zeros(columns), dense.shape[1]
    for k in range(4):
        i = first + k
        for a in range(4):
            found[cell[i] + a] += factors[k] * weights[a, i]
        for a in range(q):
            found[columns - q + a] += factors[k] * dense[i, a]
    return found


@compiled
def combine(cell: NDArray[np.intp], weights: Floats, coefficients: Floats) -> Floats:
    """The spline of `coefficients` (CELLS + 3,): ``expand(cell, weights) @ coefficients``."""
    value = np.zeros(cell.size)
    for i in range(cell.size):
        for a in range(4):
            value[i] += weights[a, i] * coefficients[cell[i] + a]
    return value


def esf_from_lsf(coefficients: Floats) -> Floats:
    """ESF coefficients e, (CELLS + 3, ...), of LSF coefficients c, (SIZE, ...)."""
    none = np.zeros_like(coefficients[:3])
    return np.cumsum(np.concatenate((none, CELL * coefficients, none[:2])), axis=0)


def quasi_interpolant(values: Floats) -> Floats:
    """Coefficients of the spline through a smooth function's `values` at the centres.

    One step of the inverse of the B-spline's sampling (1/8, 3/4, 1/8); the error is of fourth
    order in the cell.
    """
    coefficients = np.asarray(1.25 * values)
    coefficients[1:] -= 0.125 * values[:-1]
    coefficients[:-1] -= 0.125 * values[1:]
    return coefficients


def waves(freq: Floats, *places: float) -> NDArray[np.complex128]:
    """Transforms of unit impulses at some places, exp(-2 pi i f u), (places, n)."""
    angle = np.multiply.outer((-2 * np.pi) * np.array(places), freq)
    turned = np.empty(angle.shape, complex)
    turned.real, turned.imag = np.cos(angle), np.sin(angle)
    return turned


@compiled
def transform(
    freq: Floats, about: float = 0.0, scale: float = 1.0, further: int = 0
) -> NDArray[np.complex128]:
    """Fourier transform of the LSF by ESF coefficients, (n, CELLS + 3 + further).

    The OTF is ``transform(freq) @ e`` where e starts with zeros and ends level, as an ESF does.

    Parameters
    ----------
    freq : (n,) array
        Frequencies in cycles per width.
    about : float, optional
        Place, in widths, to which phases refer.
    scale : float, optional
        What to multiply by.
    further : int, optional
        Number of columns to leave room for.
    """
    columns = np.zeros((CELLS + 3 + further, freq.size), np.complex128)
    turn = np.empty(freq.size, np.complex128)
    for i in range(freq.size):
        turn[i] = np.exp(-2j * np.pi * freq[i] * CELL)
        first = np.exp(-2j * np.pi * freq[i] * (_FIRST_CENTRE - about))
        last = np.exp(-2j * np.pi * freq[i] * (_LAST_CENTRE - about))
        smooth = scale * np.sinc(freq[i] * CELL) ** 3
        # Coefficient e_m lifts the LSF's c_(m - 3) and lowers c_(m - 2), one cell further on; the
        # last one only lifts.
        columns[3, i] = smooth * (1 - turn[i]) * first
        columns[2 + SIZE, i] = smooth * last
    for m in range(4, 2 + SIZE):
        for i in range(freq.size):
            columns[m, i] = columns[m - 1, i] * turn[i]
    return columns.T
