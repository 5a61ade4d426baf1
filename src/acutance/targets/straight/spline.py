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
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = [
    "CELL",
    "CELLS",
    "CENTRES",
    "HALF_SUPPORT",
    "SIZE",
    "SplineRows",
    "combine",
    "edge_and_line_weights",
    "edge_weights",
    "esf_from_lsf",
    "expand",
    "quasi_interpolant",
    "transform",
    "waves",
]

HALF_SUPPORT: Final = 8.0
"""U: the spline's LSF is zero beyond eight widths, where only the tail remains."""
CELLS: Final = 80
CELL: Final = 2 * HALF_SUPPORT / CELLS
SIZE: Final = CELLS - 2
"""Number of LSF coefficients; the ESF has CELLS + 3."""
CENTRES: Final[Floats] = np.asarray(-HALF_SUPPORT + CELL * (np.arange(SIZE) + 1.5))
"""Where the quadratic B-splines are centred, (SIZE,)."""
_FOUR: Final = np.arange(4)[:, None]


def _cells(u: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Cell number and place within the cell (0..1) of every distance, clipped to the support."""
    position = (u + HALF_SUPPORT) * (1 / CELL)
    np.minimum(np.maximum(position, 0.0, out=position), CELLS, out=position)
    cell = position.astype(np.intp)
    np.minimum(cell, CELLS - 1, out=cell)
    return cell, position - cell


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
    cell, t = _cells(u)
    return cell, _cubics(t)


def edge_and_line_weights(u: Floats) -> tuple[NDArray[np.intp], Floats, Floats]:
    """`edge_weights` and their derivative: LSF(u) = sum_a slopes[a] * e[cell + a]."""
    cell, t = _cells(u)
    slopes = np.empty((4, t.size))
    rest, scaled = 1.0 - t, t * (1 / CELL)
    np.multiply(rest, (-0.5 / CELL) * rest, out=slopes[0])
    np.multiply(t, 0.5 * scaled, out=slopes[3])
    np.multiply(scaled, 1.5 * t - 2.0, out=slopes[1])
    np.subtract(-slopes[0], slopes[1] + slopes[3], out=slopes[2])
    return cell, _cubics(t), slopes


def _cubics(t: Floats) -> Floats:
    """The four cubic B-splines at places t (0..1) of a cell, (4, n)."""
    weights = np.empty((4, t.size))
    rest, square = 1.0 - t, t * t
    np.multiply(rest * rest, rest * (1 / 6), out=weights[0])
    np.multiply(square, t * (1 / 6), out=weights[3])
    np.add(square * (0.5 * t - 1.0), 2 / 3, out=weights[1])
    np.subtract(1.0 - weights[0], weights[1] + weights[3], out=weights[2])
    return weights


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

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the whole matrix."""
        return self.cell.size, CELLS + 3 + self.further

    def __getitem__(self, rows: slice) -> Floats:
        some = expand(self.cell[rows], self.weights[:, rows], self.further)
        some[:, -self.dense.shape[1] :] += self.dense[rows]
        return some

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        return np.asarray(self[:], dtype)

    def with_column(self, column: Floats) -> SplineRows:
        """The matrix with one more column, (n,), at its end."""
        dense = np.column_stack([self.dense, column])
        return SplineRows(self.cell, self.weights, dense, self.further + 1)


def combine(cell: NDArray[np.intp], weights: Floats, coefficients: Floats) -> Floats:
    """The spline of `coefficients` (CELLS + 3,): ``expand(cell, weights) @ coefficients``."""
    value = weights[0] * coefficients[cell]
    for a in range(1, 4):
        value += weights[a] * coefficients[cell + a]
    return np.asarray(value)


def esf_from_lsf(coefficients: Floats) -> Floats:
    """ESF coefficients e, (CELLS + 3, ...), of LSF coefficients c, (SIZE, ...)."""
    sums = np.zeros((CELLS + 3, *coefficients.shape[1:]))
    np.cumsum(coefficients * CELL, axis=0, out=sums[3 : 3 + SIZE])
    sums[3 + SIZE :] = sums[2 + SIZE]
    return sums


def quasi_interpolant(values: Floats) -> Floats:
    """Coefficients of the spline through a smooth function's `values` at the centres.

    One step of the inverse of the B-spline's sampling (1/8, 3/4, 1/8); the error is of fourth
    order in the cell.
    """
    coefficients = 1.25 * values
    coefficients[1:] -= 0.125 * values[:-1]
    coefficients[:-1] -= 0.125 * values[1:]
    return coefficients


def waves(freq: Floats, *places: float) -> NDArray[np.complex128]:
    """Transforms of unit impulses at some places, exp(-2 pi i f u), (places, n)."""
    angle = np.multiply.outer((-2 * np.pi) * np.array(places), freq)
    turned = np.empty(angle.shape, complex)
    turned.real, turned.imag = np.cos(angle), np.sin(angle)
    return turned


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
    columns = np.zeros((CELLS + 3 + further, freq.size), complex)
    turns = columns[3 : 3 + SIZE]
    turn, first, last = waves(freq, CELL, CENTRES.item(0) - about, CENTRES.item(-1) - about)
    smooth = np.sinc(freq * CELL)
    smooth *= scale * smooth * smooth
    # Coefficient e_m lifts the LSF's c_(m - 3) and lowers c_(m - 2), one cell further on; the
    # last one only lifts.
    np.multiply(smooth * (1 - turn), first, out=turns[0])
    # Doubling: coefficients m .. 2m - 1 are the first m, moved by m cells.
    done = 1
    while done < SIZE:
        more = min(done, SIZE - done)
        np.multiply(turns[:more], turn, out=turns[done : done + more])
        turn, done = turn * turn, done + more
    np.multiply(smooth, last, out=turns[-1])
    return columns.T
