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

__all__ = [
    "Combinations",
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

    def likely(self, margin: float) -> Kernels:
        """Kernels whose logarithm of the weight is less than a margin below the largest."""
        best = self.log_weight.max(axis=0)
        return self.seen.kernels.some(best > best.max() - margin)

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
        scaled = list(zip(self.seen.kernels.scales, self.weight, strict=True))
        means = [self.seen.means(scale, np.flatnonzero(own)) for scale, own in scaled]
        return np.concatenate(means), self.weight[self.weight > 0]

    @cached_property
    def mean(self) -> Floats:
        """Mean of the parameters, (q,)."""
        means, weight = self._means
        return np.asarray(weight @ means)

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of the parameters: of the kernels, and of their means, (q, q)."""
        means, weight = self._means
        away = means - self.mean
        covariance = (weight[:, None] * away).T @ away
        kernels = self.seen.kernels
        for scale, own in zip(kernels.scales, self.weight, strict=True):
            shares = np.bincount(kernels.part, own, len(kernels.factors))
            for part in np.flatnonzero(shares > _RARE).tolist():
                covariance += shares[part] * self.seen.covariance(scale, part)
        return np.asarray(covariance)


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
    log_weight = np.stack([seen.log_weight(scale) for scale in kernels.scales])
    return Mixture(seen, log_weight - math.log(len(kernels.scales)))


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
    axes : (p, r, m) array
        The factors' axes as the data see them, orthogonal to each other.
    factors : (p, q, m) array
        The factors along them.
    power : (p, m) array
        Information about each.
    along : (n, m) array
        Products of `off` with the axes of a kernel's part.
    """

    kernels: Kernels
    columns: Floats
    error: Floats
    off: Floats
    axes: Floats
    factors: Floats
    power: Floats
    along: Floats

    @classmethod
    def of(cls, kernels: Kernels, told: Combinations) -> SeenKernels:
        """What the combinations say of the kernels."""
        size = np.sum(told.columns**2, axis=0)
        error = np.sqrt(1 + np.multiply.outer(kernels.floor**2, size))
        off = (told.values - kernels.centres @ told.columns) / error[kernels.part]
        axes = (told.columns.T @ kernels.factors) / error[:, :, None]
        power, turn = np.linalg.eigh(axes.transpose(0, 2, 1) @ axes)
        axes = axes @ turn
        return cls(
            kernels, told.columns, error, off, axes, kernels.factors @ turn,
            np.maximum(power, 0.0), _part_by_part(off, kernels.part, axes),
        )  # fmt: skip

    def log_weight(self, scale: float) -> Floats:
        """Logarithm of the weight of every kernel, (n,)."""
        wider = 1 + scale**2 * self.power
        part = self.kernels.part
        explained = np.einsum("ij,ij->i", self.along**2, (scale**2 / wider)[part])
        misfit = np.einsum("ij,ij->i", self.off, self.off) - explained
        volume = 0.5 * np.log(wider).sum(axis=1) + np.log(self.error).sum(axis=1)
        return np.asarray(self.kernels.log_weight - 0.5 * misfit - volume[part])

    def means(self, scale: float, kept: NDArray[np.intp]) -> Floats:
        """Means of some kernels, (k, q)."""
        part, along = self.kernels.part[kept], self.along[kept]
        shrunk = scale**2 * along / (1 + scale**2 * self.power[part])
        left = self.off[kept] - _part_by_part(shrunk, part, self.axes.transpose(0, 2, 1))
        by_floor = (left / self.error[part]) @ self.columns.T
        by_floor *= self.kernels.floor[part, None] ** 2
        by_factor = _part_by_part(shrunk, part, self.factors.transpose(0, 2, 1))
        return np.asarray(self.kernels.centres[kept] + by_factor + by_floor)

    def covariance(self, scale: float, part: int) -> Floats:
        """Covariance of the kernels of a part, (q, q)."""
        factor, axes = scale * self.factors[part], scale * self.axes[part]
        variance = float(self.kernels.floor[part]) ** 2
        before = factor @ factor.T + variance * np.eye(len(factor))
        common = factor @ axes.T + variance * self.columns / self.error[part]
        reduced = (common @ axes) / np.sqrt(1 + scale**2 * self.power[part])
        return np.asarray(before - common @ common.T + reduced @ reduced.T)


def _part_by_part(rows: Floats, part: NDArray[np.intp], matrices: Floats) -> Floats:
    """Rows (n, a) times the matrix of their part, ascending, of matrices (p, a, b): (n, b)."""
    found = np.empty((len(rows), matrices.shape[2]))
    bounds = np.searchsorted(part, np.arange(len(matrices) + 1)).tolist()
    for own, first, last in zip(matrices, bounds[:-1], bounds[1:], strict=True):
        np.matmul(rows[first:last], own, out=found[first:last])
    return found
