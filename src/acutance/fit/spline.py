"""The space the line spread function lives in: uniform quadratic B-splines.

Distances are in units of the blur's width (``u = s / width_px``), so one basis serves every
sensor. With cells of length h on [-U, U], an LSF is ``sum_j c_j B2_j(u)`` and its integral, the
ESF, is a cubic B-spline whose coefficients e are the running sum of c:

    e_m = h * sum_{j <= m - 3} c_j,      ESF(u) = sum_m e_m B3_m(u)

so that every pixel meets four coefficients only, and the ESF is exactly 0 and constant outside
the support. The Fourier transform of the LSF is closed form:

    OTF(f) = h sinc(f h)^3 sum_j c_j exp(-2 pi i f u_j)
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = [
    "CELL",
    "CELLS",
    "CENTRES",
    "HALF_SUPPORT",
    "SIZE",
    "combine",
    "edge_weights",
    "esf_from_lsf",
    "line_weights",
    "quasi_interpolant",
    "spread",
    "transform",
]

HALF_SUPPORT: Final = 8.0
"""U: the spline's LSF is zero beyond eight widths; the tail term takes over there."""
CELLS: Final = 80
CELL: Final = 2 * HALF_SUPPORT / CELLS
SIZE: Final = CELLS - 2
"""Number of LSF coefficients; the ESF has CELLS + 3."""
CENTRES: Final[Floats] = np.asarray(-HALF_SUPPORT + CELL * (np.arange(SIZE) + 1.5))
"""Where the quadratic B-splines are centred, (SIZE,)."""


def _cells(u: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Cell number and place within the cell (0..1) of every distance, clipped to the support."""
    position = np.clip((u + HALF_SUPPORT) * (1 / CELL), 0.0, CELLS)
    cell = np.minimum(position.astype(np.intp), CELLS - 1)
    return cell, position - cell


def edge_weights(u: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The four cubic B-splines every distance meets.

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
    rest = 1.0 - t
    t2, t3 = t * t, t * t * t
    first, last = rest * rest * rest / 6.0, t3 / 6.0
    second = 0.5 * t3 - t2 + 2.0 / 3.0
    return cell, np.stack([first, second, 1.0 - first - second - last, last])


def line_weights(u: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The derivative of `edge_weights`: LSF(u) = sum_a weights[a] * e[cell + a]."""
    cell, t = _cells(u)
    rest = 1.0 - t
    first, last = -0.5 * rest * rest, 0.5 * t * t
    second = t * (1.5 * t - 2.0)
    return cell, np.stack([first, second, -first - second - last, last]) * (1 / CELL)


def spread(cell: NDArray[np.intp], weights: Floats, further: int = 0) -> Floats:
    """The (n, CELLS + 3 + further) matrix that holds the local `weights` (4, n), else zero."""
    columns = CELLS + 3 + further
    matrix = np.zeros((cell.size, columns))
    first = np.arange(0, matrix.size, columns) + cell
    for a in range(4):
        matrix.reshape(-1)[first + a] = weights[a]
    return matrix


def combine(cell: NDArray[np.intp], weights: Floats, coefficients: Floats) -> Floats:
    """The spline of `coefficients` (CELLS + 3,): ``spread(cell, weights) @ coefficients``."""
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


def transform(freq: Floats, further: int = 0) -> NDArray[np.complex128]:
    """Fourier transform of the LSF by ESF coefficients, (n, CELLS + 3 + further).

    The OTF is ``transform(freq) @ e`` where e starts with zeros and ends level, as an ESF does.

    Parameters
    ----------
    freq : (n,) array
        A regular grid of frequencies from 0, in cycles per width.
    further : int, optional
        Number of columns to leave room for.
    """
    n = freq.size
    columns = np.zeros((n, CELLS + 3 + further), complex)
    # Doubling: frequencies m .. 2m - 1 are the first m, turned by m steps.
    turns = columns[:, 3 : 3 + SIZE]
    step = np.exp(-2j * np.pi * freq[1] * CENTRES)
    turns[0] = 1.0
    done = 1
    while done < n:
        more = min(done, n - done)
        np.multiply(turns[:more], turns[done - 1] * step, out=turns[done : done + more])
        done += more
    # Coefficient e_m lifts the LSF's c_(m - 3) and lowers c_(m - 2), one cell further on; the
    # last one only lifts.
    smooth = np.sinc(freq * CELL) ** 3
    turns[:, :-1] *= (smooth * (1 - np.exp(-2j * np.pi * freq * CELL)))[:, None]
    turns[:, -1] *= smooth
    return columns
