"""Parameters known before as a mixture of normal kernels, seen linearly: the mixture after.

Before the data the parameters c have the density ``sum_k w_k N(c; c_k, S)``. What the data say of c
is normal: of independent combinations ``K^T c`` the values y, each with an error of one (K K^T is
their information about c, K^T K is diagonal). So the posterior is a mixture in closed form, in
which kernel k has

    weight       w_k N(y; K^T c_k, V),    V = 1 + K^T S K,
    mean         c_k + G (y - K^T c_k),    G = S K V^-1,
    covariance   S - G K^T S

(C. M. Bishop, Pattern Recognition and Machine Learning, 2006, section 2.3.3). Kernels come in parts
of one shape, ``S = s^2 B B^T + f^2``, each at some scales s. In units of the diagonal matrix ``D =
1 + f^2 K^T K`` there is ``V = 1 + s^2 U U^T`` with ``U = D^-1/2 K^T B`` of few columns; along the
axes of ``U^T U`` all scales are solved at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = [
    "Combinations",
    "Further",
    "Kernels",
    "Mixture",
    "SeenKernels",
    "combinations_of",
    "mixture",
]

_NEGLIGIBLE: Final = -9.0
"""Logarithm of the weight relative to the largest, below which a kernel is left out."""
_RARE: Final = 1e-4
"""Probability of a part up to which the covariance of its own kernels is left out."""


class Combinations(NamedTuple):
    """Independent combinations of q parameters that data determine, each with an error of one.

    Attributes
    ----------
    columns : (q, r) array
        Orthogonal to each other.
    values : (r,) array
    """

    columns: Floats
    values: Floats


class Further(NamedTuple):
    """Parameters of unit prior variance beside those of a mixture, each by itself.

    Attributes
    ----------
    slopes : (q, j) array
        How much the projection falls for every unit of the mixture's parameters.
    projection : (j,) array
        Information of the data about each times what they say of it, the mixture's being zero.
    information : (j,) array
        Inverse variance of what the data say, the mixture's parameters being known.
    """

    slopes: Floats
    projection: Floats
    information: Floats

    def precision(self, variance: Floats) -> Floats:
        """Of each parameter after the data; `variance` is of what its projection falls by."""
        # The data never say less than nothing, whatever rounding leaves.
        return np.asarray(1 + np.maximum(self.information - variance, 0.0))

    def gain(self, mean: Floats, precision: Floats) -> Floats:
        """Gain of log evidence by each parameter, `mean` being what its projection falls by."""
        return np.asarray(0.5 * ((self.projection - mean) ** 2 / precision - np.log(precision)))


class Kernels(NamedTuple):
    """Kernels in p parts of one shape each.

    Attributes
    ----------
    centres : (n, q) array
    log_weight : (n,) array
    part : (n,) int array
        Part of every kernel, ascending.
    factors : (p, q, m) array
        Factor of the covariance of every part at unit scale, but for the floor.
    floor : (p,) array
        Standard deviation that the kernels of every part have of every parameter besides.
    name : (p,) array of str
        What every part is called; several may have one name.
    scales : sequence of float
        Every kernel is there once at each scale, with an equal share of its weight.
    """

    centres: Floats
    log_weight: Floats
    part: NDArray[np.intp]
    factors: Floats
    floor: Floats
    name: NDArray[np.str_]
    scales: Sequence[float]

    def some(self, kept: NDArray[np.bool_]) -> Kernels:
        """The kernels that are kept (n,), and their parts."""
        present, part = np.unique(self.part[kept], return_inverse=True)
        return Kernels(
            self.centres[kept], self.log_weight[kept], part, self.factors[present],
            self.floor[present], self.name[present], self.scales,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Mixture:
    """The parameters after the data.

    Attributes
    ----------
    seen : SeenKernels
    log_weight : (s, n) array
        Logarithm of the density of the values with every kernel at every scale, but for a constant
        of the combinations.
    """

    seen: SeenKernels
    log_weight: Floats

    @cached_property
    def log_evidence(self) -> float:
        """Logarithm of the density of the values, but for the same constant."""
        return float(np.logaddexp.reduce(self.log_weight, axis=None))

    @cached_property
    def weight(self) -> Floats:
        """Probability of every kernel at every scale, (s, n); 0 for those that do not matter."""
        relative = self.log_weight - self.log_weight.max()
        weight = np.where(relative > _NEGLIGIBLE, np.exp(relative), 0.0)
        return np.asarray(weight / weight.sum())

    def is_likely(self, margin: float) -> NDArray[np.bool_]:
        """Whether the logarithm of a kernel's weight is within a margin of the largest, (n,)."""
        best = self.log_weight.max(axis=0)
        return np.asarray(best > best.max() - margin)

    @property
    def share(self) -> dict[str, float]:
        """Probability of all parts of a name."""
        kernels, found = self.seen.kernels, dict[str, float]()
        shares = np.bincount(kernels.part, self.weight.sum(axis=0), len(kernels.name))
        for name, share in zip(kernels.name.tolist(), shares.tolist(), strict=True):
            found[name] = found.get(name, 0.0) + share
        return found

    @cached_property
    def _means(self) -> tuple[Floats, Floats]:
        """Means of the kernels that matter, (k, q), and their weights, (k,)."""
        scale, kernel = np.nonzero(self.weight)
        return self.seen.means(scale, kernel), self.weight[scale, kernel]

    @cached_property
    def mean(self) -> Floats:
        """Mean of the parameters, (q,)."""
        means, weight = self._means
        return np.asarray(weight @ means)

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of the parameters: of the kernels, and of their means, (q, q)."""
        means, weight = self._means
        away = np.sqrt(weight)[:, None] * (means - self.mean)
        kernels = self.seen.kernels
        shares: Floats = np.array(
            [np.bincount(kernels.part, own, len(kernels.factors)) for own in self.weight], float
        )
        shares[shares <= _RARE] = 0.0
        return np.asarray(away.T @ away + self.seen.covariance(shares))

    def log_weight_with(self, further: Further, kept: NDArray[np.intp]) -> Floats:
        """As `log_weight`, of kernels (k,) with each of the further parameters, (j, s, k)."""
        gains = self.seen.gains(further, kept)
        return np.asarray(self.log_weight[:, kept] + gains.transpose(2, 0, 1))


def combinations_of(information: Floats, projection: Floats, untold: float) -> Combinations:
    """The combinations of which data have more than an `untold` information.

    Parameters
    ----------
    information : (q, q) array
        Inverse covariance of what the data say.
    projection : (q,) array
        The same times its mean.
    untold : float
        Information below which a combination of parameters is as good as unseen.
    """
    size, axes = np.linalg.eigh(information)
    told = size > untold
    columns = axes[:, told] * np.sqrt(size[told])
    return Combinations(columns, (columns / size[told]).T @ projection)


def mixture(kernels: Kernels, told: Combinations) -> Mixture:
    """The mixture after the data."""
    seen = SeenKernels.of(kernels, told)
    return Mixture(seen, seen.log_weights())


class SeenKernels(NamedTuple):
    """Kernels and data in units of the errors that the floor leaves.

    Attributes
    ----------
    kernels : Kernels
    columns : (q, r) array
        The combinations.
    error : (p, r) array
        Their errors that the floors leave.
    off : (n, r) array
        What the data say, minus what the centres do.
    misfit : (n,) array
        Sum of its squares.
    turn : (p, m, m) array
        Axes of every part along which its factor is seen independently.
    axes : (p, r, m) array
        The factors along them as the data see them.
    power : (p, m) array
        Information about each.
    along : (n, m) array
        Products of `off` with the axes of a kernel's part.
    """

    kernels: Kernels
    columns: Floats
    error: Floats
    off: Floats
    misfit: Floats
    turn: Floats
    axes: Floats
    power: Floats
    along: Floats

    @classmethod
    def of(cls, kernels: Kernels, told: Combinations) -> SeenKernels:
        """What the combinations say of the kernels."""
        size = np.sum(told.columns**2, axis=0)
        error = np.sqrt(1 + np.multiply.outer(kernels.floor**2, size))
        off = kernels.centres @ told.columns
        misfit = _in_errors(off, told.values, error, kernels.part)
        axes = told.columns.T @ kernels.factors
        axes /= error[:, :, None]
        power, turn = np.linalg.eigh(axes.transpose(0, 2, 1) @ axes)
        axes = axes @ turn
        return cls(
            kernels, told.columns, error, off, misfit, turn, axes, np.maximum(power, 0.0),
            _part_by_part(off, kernels.part, axes),
        )  # fmt: skip

    @property
    def shrinkage(self) -> Floats:
        """Variances along the axes after the data, of every scale and part, (s, p, m)."""
        scales = np.square(self.kernels.scales)[:, None, None]
        return np.asarray(scales / (1 + scales * self.power))

    def log_weights(self) -> Floats:
        """Logarithm of the weight of every kernel at every scale, (s, n)."""
        kernels, shrinkage = self.kernels, self.shrinkage
        seen, scales = self.along**2, np.square(kernels.scales)
        explained = np.stack([np.einsum("ij,ij->i", seen, one[kernels.part]) for one in shrinkage])
        volume = 0.5 * np.log(scales[:, None, None] / shrinkage).sum(axis=2)
        volume += np.log(self.error).sum(axis=1) + math.log(scales.size)
        weight = kernels.log_weight - 0.5 * (self.misfit - explained)
        return np.asarray(weight - volume[:, kernels.part])

    def _left(self, parts: NDArray[np.intp]) -> Floats:
        """What the data, seen through the floor, leave of the factors of parts, (k, q, m)."""
        seen = self.axes[parts] / self.error[parts, :, None]
        seen *= self.kernels.floor[parts, None, None] ** 2
        return np.asarray(self.kernels.factors[parts] @ self.turn[parts] - self.columns @ seen)

    def means(self, scale: NDArray[np.intp], kernel: NDArray[np.intp]) -> Floats:
        """Means of some kernels, each at the scale of a number, (k, q)."""
        some, place = np.unique(kernel, return_inverse=True)
        parts, part = np.unique(self.kernels.part[some], return_inverse=True)
        # The floor alone, then the factor with what that leaves of it.
        weight = self.kernels.floor[parts, None] ** 2 / self.error[parts]
        means = (self.off[some] * weight[part]) @ self.columns.T
        means += self.kernels.centres[some]
        means = means[place]
        order = np.argsort(part[place], kind="stable")
        shrunk = self.along[kernel] * self.shrinkage[scale, self.kernels.part[kernel]]
        left = self._left(parts).transpose(0, 2, 1)
        means[order] += _part_by_part(shrunk[order], part[place][order], left)
        return means

    def covariance(self, shares: Floats) -> Floats:
        """Sum of the covariances of every part at every scale times their shares (s, p), (q, q)."""
        parts = np.flatnonzero(shares.any(axis=0))
        variance = np.einsum("sp,spm->pm", shares[:, parts], self.shrinkage[:, parts])
        left = self._left(parts) * np.sqrt(variance)[:, None, :]
        left = left.transpose(1, 0, 2).reshape(len(self.columns), -1)
        floor = shares.sum(axis=0)[parts] * self.kernels.floor[parts] ** 2
        reduced = (floor * self.kernels.floor[parts] ** 2) @ self.error[parts] ** -2.0
        found = left @ left.T - (self.columns * reduced) @ self.columns.T
        found.reshape(-1)[:: len(found) + 1] += floor.sum()
        return np.asarray(found)

    def gains(self, further: Further, kept: NDArray[np.intp]) -> Floats:
        """Gain of log evidence by further parameters, of kernels (k,) at every scale, (s, k, j)."""
        kernels, slopes = self.kernels, further.slopes
        part = kernels.part[kept]
        variance = kernels.floor[:, None, None] ** 2
        seen = (self.columns.T @ slopes) / self.error[:, :, None]
        left = self.turn.transpose(0, 2, 1) @ (kernels.factors.transpose(0, 2, 1) @ slopes)
        left -= variance * (self.axes.transpose(0, 2, 1) @ seen)
        means = kernels.centres[kept] @ slopes
        means += _part_by_part(self.off[kept], part, variance * seen)
        alone = variance[:, 0] * (slopes**2).sum(axis=0) - variance[:, 0] ** 2 * (seen**2).sum(
            axis=1
        )
        shrunk = self.shrinkage[..., None] * left
        precision = further.precision(alone + np.einsum("pmj,spmj->spj", left, shrunk))
        moved = shrunk.transpose(1, 2, 0, 3).reshape(*self.power.shape, -1)
        moved = _part_by_part(self.along[kept], part, moved)
        moved = moved.reshape(len(means), len(precision), slopes.shape[1]).transpose(1, 0, 2)
        return further.gain(means + moved, precision[:, part])


@compiled
def _in_errors(found: Floats, values: Floats, error: Floats, part: NDArray[np.intp]) -> Floats:
    """Put values (r,) less those found, (n, r), in units of the errors of their part, in the place
    of these; the sums of their squares, (n,)."""
    misfit = np.empty(len(found))
    for k in range(len(found)):
        row, unit, square = found[k], error[part[k]], 0.0
        for i in range(row.size):
            row[i] = (values[i] - row[i]) / unit[i]
            square += row[i] ** 2
        misfit[k] = square
    return misfit


def _part_by_part(rows: Floats, part: NDArray[np.intp], matrices: Floats) -> Floats:
    """Rows (n, a) times the matrix of their part, ascending, of matrices (p, a, b): (n, b)."""
    found = np.empty((len(rows), matrices.shape[2]))
    bounds = np.searchsorted(part, np.arange(len(matrices) + 1)).tolist()
    for own, first, last in zip(matrices, bounds[:-1], bounds[1:], strict=True):
        np.matmul(rows[first:last], own, out=found[first:last])
    return found
