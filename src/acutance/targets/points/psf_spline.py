"""Point spread functions (PSF) as sums of cubic B-splines on two square grids, fine and coarse.

Distances are in units of the width of the first fit, across and along, so that one basis is enough
for every sensor. The fine grid holds the peak, its rings and the lobes of sharpening; the coarse
one goes on to where halos end:

    PSF(u, v) = sum_g sum_jk c_gjk B3(v / h_g - j) B3(u / h_g - k)

Every function has a parity in either direction: its coefficients are those of one quadrant. The
Fourier transform has a closed form, with cosines for even and sines for odd parity:

    OTF(f, g) = sum_g h_g^2 sinc(f h_g)^4 sinc(g h_g)^4 sum_jk c_gjk exp(-2 pi i h_g (j g + k f))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import spline_filter
from scipy.sparse import csr_array

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined

__all__ = [
    "COARSE",
    "FINE",
    "GRIDS",
    "Parity",
    "SplineGrid",
    "add_spline_sum",
    "add_splines",
    "coarse_share",
    "parity_part",
    "whole",
]

Parity = Literal[1, -1]
_BORDER: Final = 3
"""Coefficients at a grid's border that are zero, so that functions end before it does."""
_FOUR: Final = np.arange(4)


@dataclass(frozen=True)
class SplineGrid:
    """A square grid of B-splines, centred on the multiples of a step.

    Parameters
    ----------
    step : float
        Distance of two splines, in widths.
    reach : int
        Number of the last one on either side; those of the border are zero.
    """

    step: float
    reach: int

    @property
    def size(self) -> int:
        """Splines in a row."""
        return 2 * self.reach + 1

    @property
    def centres(self) -> Floats:
        """Where the splines of a row are centred, in widths, (size,)."""
        return np.asarray(self.step * np.arange(-self.reach, self.reach + 1.0))

    def coefficients(self, samples: Floats) -> Floats:
        """Of the spline through samples at the centres, (size, size), 0 at the border."""
        found = np.asarray(spline_filter(samples, order=3, mode="mirror"))
        inner = np.zeros_like(found)
        inner[_BORDER:-_BORDER, _BORDER:-_BORDER] = found[_BORDER:-_BORDER, _BORDER:-_BORDER]
        return inner

    def rows(self, u: Floats, v: Floats, slope: tuple[int, int] = (0, 0)) -> csr_array:
        """What every spline gives at places (u, v) in widths, (n, size * size).

        `slope` is the order of the derivative by u and by v, 0 or 1.
        """
        (first_u, across), (first_v, along) = (
            _rows(at, self.step, self.reach, order) for at, order in zip((u, v), slope, strict=True)
        )
        index = (first_v[:, None] + _FOUR)[:, :, None] * self.size
        index = index + (first_u[:, None] + _FOUR)[:, None, :]
        values = along[:, :, None] * across[:, None, :]
        starts = 16 * np.arange(u.size + 1)
        return csr_array((values.ravel(), index.ravel(), starts), (u.size, self.size**2))

    def waves(self, freq: Floats, parity: Parity) -> Floats:
        """Transform of every spline of a half row with its mirror image, (n, reach + 1).

        That of odd parity is to be multiplied by -i; frequencies are in cycles per width.
        """
        phase = 2 * np.pi * self.step * np.multiply.outer(freq, np.arange(self.reach + 1.0))
        pairs = 2 * (np.cos(phase) if parity > 0 else np.sin(phase))
        pairs[:, 0] *= 0.5
        return np.asarray(pairs * (self.step * np.sinc(freq * self.step) ** 4)[:, None])


@inlined
def _cell(at: float, step: float, reach: int) -> tuple[int, float]:
    """First of the four splines of a row that are not 0 at a place, and the place in its cell."""
    place = min(max(at / step + reach, 1.0), 2.0 * reach - 1.0)
    cell = min(int(place), 2 * reach - 2)
    return cell - 1, place - cell


@inlined
def _four(t: float) -> tuple[float, float, float, float]:
    """Those four splines."""
    rest = 1 - t
    near, far = 4 - 3 * t * t * (2 - t), 4 - 3 * rest * rest * (2 - rest)
    return rest * rest * rest / 6, near / 6, far / 6, t * t * t / 6


@inlined
def _four_slopes(t: float, step: float) -> tuple[float, float, float, float]:
    """Their derivatives by the place."""
    rest, steep = 1 - t, 0.5 / step
    near, far = t * (3 * t - 4), rest * (4 - 3 * rest)
    return -steep * rest * rest, steep * near, steep * far, steep * t * t


@compiled
def _rows(at: Floats, step: float, reach: int, order: int) -> tuple[NDArray[np.intp], Floats]:
    """`_cell` and `_four` (order 0) or `_four_slopes` (order 1) at many places, (n,) and (n, 4)."""
    first, values = np.empty(at.size, np.intp), np.empty((at.size, 4))
    for i in range(at.size):
        first[i], t = _cell(at[i], step, reach)
        values[i] = _four(t) if order == 0 else _four_slopes(t, step)
    return first, values


@compiled
def add_splines(
    found: Floats,
    pixel: NDArray[np.intp],
    light: Floats,
    u: Floats,
    v: Floats,
    step: float,
    coefficients: Floats,
) -> None:
    """Add the light of r functions at places to their pixels, the first r columns of a matrix.

    Parameters
    ----------
    found : (m, ...) array
    pixel : (n,) int array
        Row of every place.
    light : (n,) array
        Factor of every place.
    u, v : (n,) arrays
        The places, in widths.
    step : float
        Of the grid.
    coefficients : (size * size, r) array
    """
    size = int(np.sqrt(len(coefficients)))
    reach, count = size // 2, coefficients.shape[1]
    end = step * (reach - 1)
    for i in range(u.size):
        if abs(u[i]) < end and abs(v[i]) < end:
            (first_u, t_u), (first_v, t_v) = _cell(u[i], step, reach), _cell(v[i], step, reach)
            a, b, c, d = _four(t_u)
            along = _four(t_v)
            row = found[pixel[i]]
            for j in range(4):
                weight = light[i] * along[j]
                start = (first_v + j) * size + first_u
                e, f, g, h = weight * a, weight * b, weight * c, weight * d
                p, q = coefficients[start], coefficients[start + 1]
                r, s = coefficients[start + 2], coefficients[start + 3]
                for k in range(count):
                    row[k] += e * p[k] + f * q[k] + g * r[k] + h * s[k]


@compiled
def add_spline_sum(found: Floats, u: Floats, v: Floats, step: float, coefficients: Floats) -> None:
    """Add a function at places (u, v) in widths and its derivatives by u and v to (3, n).

    `coefficients` are those of the function, (size, size).
    """
    reach = len(coefficients) // 2
    end = step * (reach - 1)
    for i in range(u.size):
        if abs(u[i]) < end and abs(v[i]) < end:
            (first_u, t_u), (first_v, t_v) = _cell(u[i], step, reach), _cell(v[i], step, reach)
            across, steep_u = _four(t_u), _four_slopes(t_u, step)
            along, steep_v = _four(t_v), _four_slopes(t_v, step)
            for j in range(4):
                row = coefficients[first_v + j]
                level, slope = 0.0, 0.0
                for k in range(4):
                    level += across[k] * row[first_u + k]
                    slope += steep_u[k] * row[first_u + k]
                found[0, i] += along[j] * level
                found[1, i] += along[j] * slope
                found[2, i] += steep_v[j] * level


FINE: Final = SplineGrid(0.2, 28)
COARSE: Final = SplineGrid(0.8, 22)
GRIDS: Final = (FINE, COARSE)
_JOIN: Final = (2.2, 4.2)
"""Radii in widths between which functions pass from the fine grid to the coarse one."""


def coarse_share(radius: Floats) -> Floats:
    """Share of a function that the coarse grid takes, by the distance in widths, 0 to 1."""
    t = np.clip((radius - _JOIN[0]) / (_JOIN[1] - _JOIN[0]), 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))


def parity_part(whole_grid: Floats, across: Parity, along: Parity) -> Floats:
    """The quadrant of the part of given parities of functions on a grid, (..., r + 1, r + 1)."""
    both = whole_grid + across * whole_grid[..., :, ::-1]
    both = 0.25 * (both + along * both[..., ::-1, :])
    reach = whole_grid.shape[-1] // 2
    return np.asarray(both[..., reach:, reach:])


def whole(quadrant: Floats, across: Parity, along: Parity) -> Floats:
    """Functions on a whole grid from their quadrants, (..., 2 r + 1, 2 r + 1)."""
    right = np.concatenate([across * quadrant[..., :, :0:-1], quadrant], axis=-1)
    return np.concatenate([along * right[..., :0:-1, :], right], axis=-2)
